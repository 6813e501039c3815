"""Learns to stay up under pushes with numpy alone: augmented random search (Mania et al. 2018) on a linear policy.

It is not tuned: 20 rounds do not make it better than standing still.
"""

import sys

import gymnasium
import numpy as np
import sinew.vector_env

gymnasium.register_envs(sinew.vector_env)  # Its import has told of them.

WORLDS, STEP, NOISE = 64, 0.02, 0.03
ROUNDS = int(sys.argv[1]) if len(sys.argv) > 1 else 20
env = gymnasium.make_vec(
    "sinew/HumanoidStand-v0", num_envs=WORLDS, vectorization_mode="vector_entry_point", push=90.0, seconds=6.0
)
rng = np.random.default_rng(0)
policy = np.zeros((env.single_action_space.shape[0], env.single_observation_space.shape[0]), np.float32)

for number in range(ROUNDS + 1):
    # Half of the worlds run the policy with a change, the other half with its opposite.
    changes = rng.standard_normal((WORLDS // 2, *policy.shape)).astype(np.float32)
    tried = policy + NOISE * np.concatenate([changes, -changes])
    observations, _ = env.reset(seed=number)
    returns, alive = np.zeros(WORLDS), np.ones(WORLDS, bool)
    while alive.any():
        actions = np.einsum("wao,wo->wa", tried, observations)
        observations, rewards, terminated, truncated, _ = env.step(actions)
        returns += rewards * alive
        alive &= ~(terminated | truncated)
    better, worse = np.split(returns, 2)
    print(f"round {number:3}: up for {returns.mean() / 30:.2f} s on the mean, {returns.max() / 30:.2f} s at most")
    gain = (better - worse) / max(returns.std(), 1e-6)
    policy += STEP / len(changes) * np.einsum("n,nao->ao", gain, changes)
