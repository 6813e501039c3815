"""Gymnasium environments of a humanoid that has to stay up: `pip install sinew[gym]`.

    import gymnasium
    import sinew.vector_env  # Registers its environments with Gymnasium.

    env = gymnasium.make("sinew/HumanoidStand-v0", render_mode="rgb_array")
    many = gymnasium.make_vec("sinew/HumanoidStand-v0", num_envs=64, vectorization_mode="vector_entry_point")

or without their registry:

    from sinew.vector_env import HumanoidVectorEnv, pd_baseline
    env = HumanoidVectorEnv(64)
    observations, _ = env.reset(seed=1)
    for _ in range(300):
        observations, rewards, terminated, truncated, _ = env.step(pd_baseline(env, observations))
"""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

import sinew
from sinew.picture import draw

__all__ = ["HumanoidEnv", "HumanoidVectorEnv", "pd_baseline"]

Floats = NDArray[np.float32]

# Duration of an action, seconds: two steps of 1/60 s.
_STEPS = 2
# Largest rotation of a joint by an action of 1 from the standing pose, radians.
_REACH = 1.0
# Stiffness of the drives per N·m of muscle torque, 1/rad: an eighth of a radian takes the whole torque, and both ankles
# hold a body upright (weight × height of its centre, about 690 N·m/rad). Ratio of damping to stiffness, seconds.
_STIFFNESS, _DAMPING = 8.0, 0.1
# Smallest height of the pelvis, as a share of its standing height, and smallest cosine of its lean.
_LOW, _LEAN = 0.6, 0.5


def _turned(rotation: Floats, vector: Floats) -> Floats:
    """Rotates vectors by quaternions x y z w."""
    axis, real = rotation[..., :3], rotation[..., 3:]
    across = 2.0 * np.cross(axis, vector)
    turned: Floats = (vector + real * across + np.cross(axis, across)).astype(np.float32)
    return turned


class HumanoidVectorEnv(gymnasium.vector.VectorEnv[Floats, Floats, NDArray[Any]]):
    """Standing humanoids, each in its own world, that are pushed.

    An action (joints × 3, in -1..1) is where the drives draw each joint, as a turn away from standing in the joint's own axes: a scaled axis, 1 is
    one radian. The torques are a person's (`Ragdoll.torques`). An observation is the height of the pelvis as a share of that at the beginning, its
    up axis, its velocity and angular velocity, the turns of the joints away from standing, and what those were an action ago. Every action that ends upright
    is rewarded by 1; who lies is terminated, who has stood for `seconds` is truncated. Where an episode has ended, the next action begins a new
    one. `push` is the largest impulse, N·s, that hits the chest at a random moment of each second.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 60 // _STEPS, "autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(
        self,
        num_envs: int,
        *,
        ragdoll: sinew.Ragdoll | None = None,
        seconds: float = 10.0,
        push: float = 40.0,
        threads: int = 0,
        render_mode: str | None = None,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode must be None or 'rgb_array', not {render_mode!r}")
        self.render_mode = render_mode
        self.num_envs = num_envs
        self.ragdoll = sinew.mannequin().build() if ragdoll is None else ragdoll
        self.batch = sinew.BatchWorlds(self.ragdoll, num_envs, threads=threads)
        self.joints = self.batch.joint_count
        self._standing = self.batch.joint_turns()[0]
        self._height = float(self.batch.poses()[0, 0, 1])
        inverse = self.batch.poses()[0, 0, 3:] * np.array([-1, -1, -1, 1], np.float32)
        self._up = _turned(inverse, np.array([0, 1, 0], np.float32))
        self._chest = next((i for i, role in enumerate(self.batch.bodies) if role == "chest"), 0)
        self._length = max(1, round(seconds * 60 / _STEPS))
        self._push = push
        numbers = 10 + 6 * self.joints
        self.single_observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (numbers,), np.float32)
        self.single_action_space = gymnasium.spaces.Box(-1.0, 1.0, (3 * self.joints,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._age = np.zeros(num_envs, np.int64)
        self._ended = np.zeros(num_envs, bool)
        self._before = np.zeros((num_envs, self.joints, 3), np.float32)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats, dict[str, Any]]:
        """Resets all humanoids to standing; the seed determines the pushes."""
        super().reset(seed=seed if not isinstance(seed, list) else seed[0], options=options)
        self.batch.reset()
        self._age[:] = 0
        self._ended[:] = False
        self._before[:] = 0
        return self._observed(), {}

    def step(
        self, actions: Floats
    ) -> tuple[Floats, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Takes two steps of 1/60 s."""
        begins = self._ended.copy()
        if begins.any():
            self.batch.reset(np.flatnonzero(begins))
            self._before[begins] = 0
        turns = np.clip(actions, -1.0, 1.0).reshape(self.num_envs, self.joints, 3) * _REACH
        self._before = self._turns()
        torques = self.ragdoll.torques
        stiffness = _STIFFNESS * torques
        self.batch.drive(
            self._standing + turns, stiffness=stiffness, damping=_DAMPING * stiffness, max_torques=torques
        )
        self.batch.push(self._chest, self._pushes())
        self.batch.step(_STEPS)
        self._age = np.where(begins, 0, self._age + 1)
        observed = self._observed()
        up = observed[:, 2]
        fallen = (observed[:, 0] < _LOW) | (up < _LEAN)
        truncated = ~fallen & (self._age >= self._length)
        self._ended = fallen | truncated
        rewards = np.where(fallen, 0.0, 1.0).astype(np.float32)
        return observed, rewards, fallen, truncated, {}

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """A picture (240, 320, 3) of each humanoid with `rgb_array`, else `None`."""
        if self.render_mode is None:
            return None
        parents, height = self.ragdoll.parents, self.ragdoll.height
        return tuple(draw(poses, parents, height) for poses in self.batch.poses())

    def _pushes(self) -> Floats:
        """Pushes once a second, at a random time, from a random side."""
        hit = self.np_random.random(self.num_envs) < _STEPS / 60
        angle = self.np_random.random(self.num_envs) * 2 * np.pi
        size = self.np_random.random(self.num_envs) * self._push * hit
        return np.stack([size * np.cos(angle), np.zeros_like(size), size * np.sin(angle)], 1).astype(np.float32)

    def _turns(self) -> Floats:
        turns: Floats = self.batch.joint_turns() - self._standing
        return turns

    def _observed(self) -> Floats:
        pelvis, motion = self.batch.poses()[:, 0], self.batch.velocities()[:, 0]
        up = _turned(pelvis[:, 3:], np.broadcast_to(self._up, (self.num_envs, 3)).astype(np.float32))
        turns = self._turns().reshape(self.num_envs, -1)
        parts = [pelvis[:, 1:2] / self._height, up, motion, turns, self._before.reshape(self.num_envs, -1)]
        return np.concatenate(parts, 1).astype(np.float32)


def pd_baseline(env: HumanoidVectorEnv, observations: Floats) -> Floats:
    """Actions of a simple controller: springs and dampers pull every joint to its standing pose. It stands for as long as nothing
    pushes it much, and has no idea of catching itself: that is for a learner to find."""
    return np.zeros((len(observations), 3 * env.joints), np.float32)


class HumanoidEnv(gymnasium.Env[Floats, Floats]):
    """One humanoid of a [`HumanoidVectorEnv`], with the same arguments, actions, observations and rewards."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 60 // _STEPS}

    def __init__(self, **settings: Any) -> None:
        self.env = HumanoidVectorEnv(1, **settings)
        self.render_mode = self.env.render_mode
        self.observation_space = self.env.single_observation_space
        self.action_space = self.env.single_action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats, dict[str, Any]]:
        """Resets to standing; the seed determines the pushes."""
        super().reset(seed=seed)
        observations, info = self.env.reset(seed=seed, options=options)
        return observations[0], info

    def step(self, action: Floats) -> tuple[Floats, float, bool, bool, dict[str, Any]]:
        """Takes two steps of 1/60 s."""
        observations, rewards, terminated, truncated, info = self.env.step(np.asarray(action)[None])
        return observations[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), info

    def render(self) -> NDArray[np.uint8] | None:
        """A picture (240, 320, 3) with `rgb_array`, else `None`."""
        pictures = self.env.render()
        return None if pictures is None else pictures[0]


gymnasium.register(
    id="sinew/HumanoidStand-v0",
    entry_point="sinew.vector_env:HumanoidEnv",
    vector_entry_point="sinew.vector_env:HumanoidVectorEnv",
)
