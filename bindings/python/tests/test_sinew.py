"""The installed package: files, worlds, batches, bakes, errors."""

import json
import struct
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import sinew


@pytest.fixture(scope="module")
def mannequin() -> sinew.CharacterFile:
    return sinew.mannequin()


@pytest.fixture(scope="module")
def ragdoll(mannequin: sinew.CharacterFile) -> sinew.Ragdoll:
    return mannequin.build()


def glb_json(data: bytes) -> dict:
    magic, _version, length, size, kind = struct.unpack_from("<4sIII4s", data)
    assert (magic, kind, length) == (b"glTF", b"JSON", len(data))
    return json.loads(data[20 : 20 + size])


def stack(threads: int = 1) -> sinew.World:
    world = sinew.World(threads=threads)
    world.add_floor()
    for i in range(12):
        world.add_body("box", [0.25, 0.25, 0.25], pose=[0.6 * (i % 3), 1 + 0.6 * (i // 3), 0.01 * i, 0, 0, 0, 1])
    return world


class TestFiles:
    def test_a_file_is_loaded_built_and_examined(self, mannequin, ragdoll):
        assert mannequin.roles["head"] == "head" and "walk" in mannequin.clips
        assert ragdoll.roles[0] == "hips" and len(ragdoll) == len(ragdoll.bones) >= 14
        assert ragdoll.parents[0] == -1 and (ragdoll.parents[1:] < np.arange(1, len(ragdoll))).all()
        assert ragdoll.masses.sum() == pytest.approx(ragdoll.total_mass, rel=1e-5)
        assert ragdoll.report["height_m"] == pytest.approx(1.75, abs=0.05)
        assert mannequin.build(mass=60.0).total_mass == pytest.approx(60.0)
        assert [f for f in ragdoll.doctor()["findings"] if f["severity"] == "error"] == []
        tested = ragdoll.drop_test()
        assert tested["verdict"] == "good" and tested["drop"]["joint_gap_max_m"] < 0.005

    def test_the_doctor_finds_faults(self, ragdoll, tmp_path):
        broken = json.loads(ragdoll.to_json())
        broken["bodies"][3]["mass"]["kg"] *= 200
        path = tmp_path / "broken.sinew.json"
        path.write_text(json.dumps(broken))
        findings = sinew.load_ragdoll(path).doctor()["findings"]
        assert findings, "a shank of some hundred kilograms"
        assert all({"code", "severity", "bones", "cause", "evidence", "fix"} <= finding.keys() for finding in findings)

    def test_a_definition_round_trips(self, ragdoll, tmp_path):
        path = tmp_path / "it.sinew.json"
        ragdoll.save(path)
        assert sinew.load_ragdoll(path).to_json() == ragdoll.to_json()

    def test_a_written_file_can_be_loaded_again(self, mannequin, tmp_path):
        path = tmp_path / "fall.glb"
        mannequin.character().bake(seconds=1.0, hits=[(0.2, "chest", (0, 0, 90))], name="push").save(path)
        again = sinew.load(path)
        assert again.clips == [*mannequin.clips, "push"] and again.joints == mannequin.joints

    def test_errors_name_the_file_and_the_place(self, tmp_path):
        with pytest.raises(sinew.FileError, match="no such.glb"):
            sinew.load(tmp_path / "no such.glb")
        broken = tmp_path / "broken.glb"
        broken.write_bytes(b"glTF\x02\x00\x00\x00\xff\x00\x00\x00")
        with pytest.raises(sinew.FileError, match=r"broken\.glb: .* \(.+\)"):
            sinew.load(broken)
        wrong = tmp_path / "wrong.sinew.json"
        wrong.write_text('{"sinew": "ragdoll", "bodies": [{"bone": 7}]}')
        with pytest.raises(sinew.FileError, match=r"wrong\.sinew\.json: "):
            sinew.load_ragdoll(wrong)
        assert issubclass(sinew.FileError, sinew.SinewError)


class TestWorld:
    def test_a_box_falls_and_lies(self):
        world = sinew.World()
        floor = world.add_floor()
        box = world.add_body("box", [0.25, 0.25, 0.25], pose=[0, 3, 0, 0, 0, 0, 1])
        world.step(30)
        height = 3 - 0.5 * 9.81 * world.time**2
        assert world.poses([box])[0, 1] == pytest.approx(height, abs=0.05), "free fall"
        world.step(150)
        assert world.poses([box])[0, 1] == pytest.approx(0.25, abs=0.005)
        contacts = world.contacts()
        assert set(contacts["a"]) | set(contacts["b"]) == {floor, box}
        weight = 0.5**3 * 1000 * 9.81
        assert contacts["impulse"].sum() * 60 == pytest.approx(weight, rel=0.02)
        assert np.abs(contacts["normal"][:, 1]) == pytest.approx(1.0)

    def test_rays_and_overlaps(self):
        world = sinew.World()
        ball = world.add_body("sphere", [0.5], pose=[0, 2, 0, 0, 0, 0, 1])
        hits = world.ray([[0, 5, 0], [3, 5, 0]], [[0, -10, 0], [0, -10, 0]])
        assert hits["body"].tolist() == [ball, 2**64 - 1]
        assert hits["point"][0] == pytest.approx([0, 2.5, 0], abs=1e-5)
        assert hits["fraction"].tolist() == pytest.approx([0.25, 1.0])
        assert world.overlap("box", [1, 1, 1], [0, 3, 0, 0, 0, 0, 1]).tolist() == [ball]
        assert world.overlap("box", [1, 1, 1], [0, 9, 0, 0, 0, 0, 1]).size == 0

    def test_a_driven_hinge_holds_an_arm(self):
        world = sinew.World()
        wall = world.add_body("box", [0.1, 0.1, 0.1], pose=[0, 2, 0, 0, 0, 0, 1], body="static")
        arm = world.add_body("box", [0.5, 0.05, 0.05], pose=[0.5, 2, 0, 0, 0, 0, 1])
        hinge = world.add_joint("hinge", wall, arm, [0, 2, 0], axis=[0, 0, 1])
        world.drive_joint(hinge, [0.5, 0, 0], hertz=8.0)
        world.step(120)
        assert world.joint_turn(hinge)[0] == pytest.approx(0.5, abs=0.02)
        assert world.joint_gap(hinge) < 1e-5
        assert world.poses([arm])[0, 1] == pytest.approx(2 + 0.5 * np.sin(0.5), abs=0.02)

    def test_any_number_of_threads_and_a_saved_state_give_the_same_bits(self):
        one, four = stack(1), stack(4)
        one.step(50), four.step(50)
        state, hash_then = one.save(), one.hash()
        one.step(70), four.step(70)
        assert one.hash() == four.hash()
        end = one.hash()
        one.load(state)
        assert one.hash() == hash_then
        one.step(70)
        assert one.hash() == end
        with pytest.raises(sinew.SinewError):
            one.load(state[:100])
        assert one.hash() == end

    def test_returned_poses_can_be_set_again(self, ragdoll):
        world = sinew.World()
        bodies, joints = world.add_ragdoll(ragdoll, pose=[0, 1, 0, 0, 0, 0, 1])
        assert len(joints) == len(bodies) - 1
        world.step(20)
        poses, velocities = world.poses(bodies), world.velocities(bodies)
        world.step(20)
        assert not np.array_equal(world.poses(bodies), poses)
        world.set_poses(bodies, poses)
        world.set_velocities(bodies, velocities)
        assert world.poses(bodies) == pytest.approx(poses, abs=1e-6)
        assert np.array_equal(world.velocities(bodies), velocities)

    def test_invalid_arguments_raise_value_errors(self, ragdoll):
        world = sinew.World()
        box = world.add_body("box", [1, 1, 1])
        for wrong in (
            lambda: world.poses([77]),
            lambda: world.push(box, [np.nan, 0, 0]),
            lambda: world.push(box, [1, 2]),
            lambda: world.add_body("box", [1, -1, 1]),
            lambda: world.add_body("blob", [1]),
            lambda: world.add_body("half_space", []),
            lambda: world.set_poses([box], [[0, 0, 0, 0, 0, 0, 0]]),
            lambda: world.add_joint("hinge", box, box, [0, 0, 0]),
            lambda: world.ray([[0, 0, 0]], [[0, 0, 1], [0, 1, 0]]),
            lambda: sinew.World(dt=0.0),
            lambda: sinew.BatchWorlds(ragdoll, 0),
            lambda: sinew.BatchWorlds(7, 2),
            lambda: sinew.BatchWorlds(ragdoll, 2).drive(0, stiffness=[1], damping=[1], max_torques=[1]),
            lambda: sinew.BatchWorlds(ragdoll, 2).reset([2]),
        ):
            with pytest.raises(ValueError):
                wrong()
        world.remove_body(box)
        with pytest.raises(ValueError, match="no body"):
            world.poses([box])


class TestBatch:
    def test_batched_and_single_worlds_have_the_same_bits(self, ragdoll):
        count = 12
        rng = np.random.default_rng(3)
        motions = np.zeros((count, 7), np.float32)
        turn = rng.normal(size=(count, 4))
        motions[:, 3:] = turn / np.linalg.norm(turn, axis=1, keepdims=True)
        batch = sinew.BatchWorlds(ragdoll, count, threads=4)
        starts = batch.carried(motions)
        starts[:, :, 1] += rng.uniform(0.3, 0.6, (count, 1)) - starts[:, :, 1].min(axis=1, keepdims=True)
        batch.reset(poses=starts)
        batch.step(90)
        poses, hashes = batch.poses(), batch.hashes()
        assert len(set(hashes.tolist())) == count
        for index in range(count):
            alone = sinew.BatchWorlds(ragdoll, 1, threads=1)
            alone.reset(poses=starts[index : index + 1])
            for _ in range(90):
                alone.step()
            assert alone.hashes()[0] == hashes[index], f"world {index}"
            assert np.array_equal(alone.poses()[0], poses[index])
        assert batch.joint_gaps().max() < 1e-3 and batch.depths().max() < 0.02
        assert (poses[:, :, 1] < 1.0).all(), "they lie"
        batch.reset()
        assert len(set(batch.hashes().tolist())) == 1, "and stand again, all alike"

    def test_one_world_of_a_batch_is_a_world(self, ragdoll):
        batch = sinew.BatchWorlds(ragdoll, 2)
        world = sinew.World(sleeping=False)
        world.add_ragdoll(ragdoll)
        world.add_floor()
        batch.step(40), world.step(40)
        assert batch.hashes()[1] == world.hash()

    def test_the_gil_is_free_while_it_steps(self, ragdoll):
        batch = sinew.BatchWorlds(ragdoll, 64, threads=1)
        batch.step(30)
        counted, running = 0, True

        def count():
            nonlocal counted
            while running:
                counted += 1
                time.sleep(0)

        thread = threading.Thread(target=count)
        thread.start()
        before = counted
        batch.step(200)
        during = counted - before
        running = False
        thread.join()
        assert during > 100, "another thread came on meanwhile"

    def test_drives_hold_a_figure_that_would_fall(self, ragdoll):
        limp, driven = sinew.BatchWorlds(ragdoll, 1), sinew.BatchWorlds(ragdoll, 1)
        stiffness = 8 * ragdoll.torques
        driven.drive(
            driven.joint_turns(), stiffness=stiffness, damping=0.1 * stiffness, max_torques=ragdoll.torques
        )
        limp.step(120), driven.step(120)
        start = ragdoll.bind_poses[0, 1]
        assert limp.poses()[0, 0, 1] < 0.5 * start and driven.poses()[0, 0, 1] > 0.9 * start


class TestBake:
    def test_a_character_walks_falls_and_gets_up(self, mannequin):
        baked = mannequin.character().bake(seconds=9.0, hits=[(1.0, "chest", (0, 0, 110))])
        assert {"animated", "limp", "getting up"} <= set(baked.states)
        frames, joints = len(baked.times), len(mannequin.joints)
        assert frames == 271 and baked.rotations.shape == (frames, joints, 4)
        assert np.linalg.norm(baked.rotations, axis=2) == pytest.approx(1.0, abs=1e-4)
        head = mannequin.joints.index("head")
        limp = baked.states.index("limp")
        assert baked.positions[0, head, 1] > 1.4 and baked.positions[limp + 45, head, 1] < 0.6
        assert baked.quality["nan"] == 0 and baked.verdict in ("good", "usable")

    def test_random_falls_depend_on_the_seed_alone(self, mannequin):
        one, two = mannequin.character(), sinew.mannequin().character()
        for seed in range(3):
            fall, again = one.random_fall(seed, seconds=1.5), two.random_fall(seed, seconds=1.5)
            assert fall.hash == again.hash and fall.glb(mesh=False) == again.glb(mesh=False)
        assert one.random_fall(0).hash != one.random_fall(1).hash
        document = glb_json(fall.glb(mesh=False))
        assert len(document["animations"]) == 1 and not document.get("meshes")

    def test_invalid_arguments_raise_value_errors(self, mannequin):
        character = mannequin.character()
        with pytest.raises(ValueError, match="'wing'"):
            character.bake(hits=[(0.1, "wing", (0, 0, 1))])
        with pytest.raises(ValueError):
            character.bake(seconds=float("nan"))
        with pytest.raises(sinew.FileError, match="nowhere.json"):
            character.bake(world=Path("nowhere.json"))
        with pytest.raises(ValueError, match="no clip is called 'dance'; there are walk, "):
            mannequin.character(clip="dance")
