"""The environment: its interface, its seeds, and the reward of a controller."""

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from sinew.vector_env import HumanoidVectorEnv, pd_baseline  # noqa: E402


def standing(policy, push: float, count: int = 16, actions: int = 240) -> float:
    """Share that stays up for 8 s."""
    env = HumanoidVectorEnv(count, seconds=100.0, push=push)
    observations, _ = env.reset(seed=5)
    up = np.ones(count, bool)
    for _ in range(actions):
        observations, _, terminated, *_ = env.step(policy(env, observations))
        up &= ~terminated
    return float(up.mean())


def test_the_environment_passes_gymnasiums_checks():
    env = HumanoidVectorEnv(3, seconds=0.5)
    observations, info = env.reset(seed=1)
    assert isinstance(env, gymnasium.vector.VectorEnv) and info == {}
    assert env.observation_space.contains(observations)
    still = np.zeros(env.action_space.shape, np.float32)
    assert env.action_space.contains(still)
    assert observations[:, 0] == pytest.approx(1.0) and observations[:, 2] == pytest.approx(1.0)
    for step in range(15):
        observations, rewards, terminated, truncated, _ = env.step(still)
        assert env.observation_space.contains(observations) and rewards.shape == (3,)
        assert truncated.all() == (step == 14) and not terminated.any()
    observations, rewards, terminated, truncated, _ = env.step(still)
    assert observations[:, 0] == pytest.approx(1.0, abs=0.01), "the next action begins a new episode"
    assert not truncated.any()


def test_the_seed_decides_everything():
    ends = []
    for seed, threads in [(1, 1), (1, 2), (2, 2)]:
        env = HumanoidVectorEnv(4, threads=threads)
        observations, _ = env.reset(seed=seed)
        for _ in range(90):
            observations, *_ = env.step(pd_baseline(env, observations))
        ends.append(observations)
    assert np.array_equal(ends[0], ends[1]) and not np.array_equal(ends[0], ends[2])


def test_the_baseline_stands_longer_than_noise():
    rng = np.random.default_rng(0)
    noise = standing(lambda env, _: rng.uniform(-1, 1, env.action_space.shape).astype(np.float32), push=0.0)
    calm, pushed = standing(pd_baseline, push=0.0), standing(pd_baseline, push=100.0)
    print(f"still up after 8 s: noise {noise}, baseline {calm}, pushed by up to 100 N·s {pushed}")
    assert (noise, calm) == (0.0, 1.0) and pushed < 0.5


def test_gymnasium_makes_it_by_name():
    from gymnasium.utils.env_checker import check_env

    env = gymnasium.make("sinew/HumanoidStand-v0", render_mode="rgb_array")
    check_env(env.unwrapped, skip_render_check=True)
    env.reset(seed=3)
    picture = env.render()
    assert picture.shape == (240, 320, 3) and picture.dtype == np.uint8
    standing = (picture < 180).any(axis=2).any(axis=1)
    assert 130 < standing.sum() < 240, "it stands upright in the picture"
    many = gymnasium.make_vec("sinew/HumanoidStand-v0", num_envs=5, vectorization_mode="vector_entry_point")
    observations, _ = many.reset(seed=3)
    assert observations.shape[0] == 5 and many.unwrapped.render() is None
    with pytest.raises(ValueError, match="render_mode"):
        HumanoidVectorEnv(1, render_mode="human")


def test_one_environment_equals_the_first_of_many():
    from sinew.vector_env import HumanoidEnv

    one, many = HumanoidEnv(push=60.0), HumanoidVectorEnv(1, push=60.0)
    a, _ = one.reset(seed=7)
    b, _ = many.reset(seed=7)
    for _ in range(30):
        a, *_ = one.step(np.zeros(one.action_space.shape, np.float32))
        b, *_ = many.step(np.zeros(many.action_space.shape, np.float32))
    assert np.array_equal(a, b[0])
