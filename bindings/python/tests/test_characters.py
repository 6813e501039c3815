"""Characters from bytes and arrays, with corrections, in bakes with all actions, and in a world."""

import numpy as np
import pytest

import sinew
from sinew.types import ClipArrays, MeshArrays

IDENTITY = [0, 0, 0, 0, 0, 0, 1]


@pytest.fixture(scope="module")
def file() -> sinew.CharacterFile:
    return sinew.mannequin()


@pytest.fixture(scope="module")
def character(file: sinew.CharacterFile) -> sinew.Character:
    return file.character()


def figure(scale: float = 1.0) -> dict[str, object]:
    """A character of boxes: joints, parents, rest pose, one mesh."""
    at = {
        "hips": (None, (0, 1.0, 0)),
        "spine": ("hips", (0, 0.2, 0)),
        "chest": ("spine", (0, 0.2, 0)),
        "neck": ("chest", (0, 0.2, 0)),
        "head": ("neck", (0, 0.1, 0)),
    }
    for side, sign in (("left", 1), ("right", -1)):
        at[side + "UpperArm"] = ("chest", (sign * 0.2, 0.15, 0))
        at[side + "LowerArm"] = (side + "UpperArm", (sign * 0.28, 0, 0))
        at[side + "Hand"] = (side + "LowerArm", (sign * 0.25, 0, 0))
        at[side + "UpperLeg"] = ("hips", (sign * 0.1, -0.05, 0))
        at[side + "LowerLeg"] = (side + "UpperLeg", (0, -0.45, 0))
        at[side + "Foot"] = (side + "LowerLeg", (0, -0.42, 0))
    names = list(at)
    parents = [-1 if at[n][0] is None else names.index(str(at[n][0])) for n in names]
    local = np.array([at[n][1] for n in names], np.float32) * scale
    place = np.zeros_like(local)
    for i, parent in enumerate(parents):
        place[i] = local[i] + (place[parent] if parent >= 0 else 0)
    sides = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]
    positions, triangles, joints = [], [], []
    for i, name in enumerate(names):
        ends = [place[j] for j, parent in enumerate(parents) if parent == i] or [place[i] + scale * np.array([0, 0.15 if name == "head" else -0.05, 0.1])]
        low = np.minimum(place[i], np.min(ends, axis=0)) - 0.05 * scale
        high = np.maximum(place[i], np.max(ends, axis=0)) + 0.05 * scale
        first = len(positions)
        positions += [[(low, high)[x][0], (low, high)[y][1], (low, high)[z][2]] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        triangles += [[first + c for c in side] for side in sides]
        joints += [[i, 0, 0, 0]] * 8
    mesh: MeshArrays = {
        "positions": np.array(positions),
        "triangles": np.array(triangles),
        "joints": np.array(joints),
        "weights": np.tile([1.0, 0, 0, 0], (len(joints), 1)),
    }
    rotations = np.tile([0, 0, 0, 1.0], (len(names), 1))
    return {"joints": names, "parents": parents, "translations": local, "rotations": rotations, "meshes": [mesh]}


def wave(parts: dict[str, object], frames: int = 60) -> ClipArrays:
    """A clip that moves along +X and raises an arm."""
    names, local = parts["joints"], np.asarray(parts["translations"])
    assert isinstance(names, list)
    translations = np.tile(local, (frames, 1, 1))
    translations[:, 0, 0] += np.linspace(0, 1, frames)
    rotations = np.zeros((frames, len(names), 4))
    rotations[..., 3] = 1
    angle = np.linspace(0, 1.2, frames) / 2
    arm = names.index("leftUpperArm")
    rotations[:, arm, 2], rotations[:, arm, 3] = np.sin(angle), np.cos(angle)
    return {"times": np.arange(frames) / 30, "translations": translations, "rotations": rotations}


class TestLoading:
    def test_bytes_load_like_the_file(self, file, character):
        again = sinew.load_bytes(file.glb(), name="mannequin")
        assert again.joints == file.joints and again.clips == file.clips
        assert again.character().bake(seconds=2).hash == character.bake(seconds=2).hash
        with pytest.raises(sinew.FileError, match="junk: "):
            sinew.load_bytes(b"glTF nothing", name="junk")

    def test_arrays_make_a_character_and_its_file_is_the_same(self):
        parts = figure()
        made = sinew.load_arrays(**parts, clips={"wave": wave(parts)}, unit=1.0)
        assert set(made.roles) >= {"hips", "head", "leftHand", "rightFoot"} and made.clips == ["wave"]
        ragdoll = made.build()
        assert len(ragdoll) >= 15 and ragdoll.doctor()["findings"] == [] or ragdoll.drop_test()["verdict"] == "good"
        one = made.character(ragdoll, clip="wave").bake(seconds=2)
        two = sinew.load_bytes(made.glb(), name="character", unit=1.0)
        assert two.character(two.build(), clip="wave").bake(seconds=2).hash == one.hash

    def test_an_exact_clip_keeps_its_place(self):
        parts = figure()
        clip = wave(parts)
        made = sinew.load_arrays(**parts, clips={"wave": clip}, unit=1.0)
        character = made.character(clip="wave", exact=True)
        baked = character.bake(seconds=1.5, limp_at=1.4, pose=character.place_in_file)
        hips = character.joints.index("hips")
        wanted = np.asarray(clip["translations"])[:40, 0]
        assert baked.translations[:40, hips] == pytest.approx(wanted, abs=1e-3)
        assert baked.positions[:40, hips] == pytest.approx(wanted, abs=1e-3)

    def test_settings_are_arguments(self, file):
        assert sinew.load_bytes(file.glb(), mass=50.0).build().total_mass == pytest.approx(50.0)
        assert sinew.load_bytes(file.glb(), height=2.0).build().height == pytest.approx(2.0, abs=0.01)
        without = sinew.load_bytes(file.glb(), bodies={"leftHand": False}).build()
        assert "leftHand" not in without.roles and "rightHand" in without.roles
        heavy = sinew.load_bytes(file.glb(), settings={"bones": {"head": {"mass": 9.0}}}).build()
        assert heavy.masses[heavy.roles.index("head")] == pytest.approx(9.0)
        for wrong in ({"roles": {"head": "wing"}}, {"unit": 1.0, "height": 2.0}, {"mass": -1.0}, {"settings": {"colour": 7}}):
            with pytest.raises(ValueError):
                sinew.load_bytes(file.glb(), **wrong)
        with pytest.raises(sinew.FileError, match="nowhere"):
            sinew.load_bytes(file.glb(), ignore=["nowhere"])

    def test_invalid_arrays_raise_value_errors(self):
        for wrong in (
            {"parents": [5] * 17},
            {"rotations": np.zeros((17, 4))},
            {"translations": np.full((17, 3), np.nan)},
            {"meshes": [{"positions": [[0, 0, 0]], "triangles": [[0, 0, 9]], "joints": [[0, 0, 0, 0]], "weights": [[1, 0, 0, 0]]}]},
            {"clips": {"c": {"times": [0, 0]}}},
            {"joints": []},
        ):
            with pytest.raises(ValueError):
                sinew.load_arrays(**{**figure(), **wrong})


class TestEditing:
    def test_bodies_and_limits_change_in_a_copy(self, file):
        ragdoll = file.build()
        other = ragdoll.edited("leftUpperArm", mass=5.0, swing_y=(-0.2, 0.3), twist=(-0.1, 0.1), scale=1.5)
        assert other.masses[other.roles.index("leftUpperArm")] == pytest.approx(5.0)
        assert other.to_json() != ragdoll.to_json() and file.build().to_json() == ragdoll.to_json()
        assert sinew.Ragdoll.from_json(other.to_json()).to_json() == other.to_json()
        ball = ragdoll.edited("head", shape="sphere", size=[0.12])
        assert '"sphere"' in ball.to_json()
        for wrong in ({"mass": -1.0}, {"swing_y": (0.2, 0.1)}, {"shape": "sphere"}, {"shape": "blob", "size": [1]}):
            with pytest.raises(ValueError):
                ragdoll.edited("head", **wrong)
        with pytest.raises(ValueError, match="wing"):
            ragdoll.edited("wing", mass=1.0)

    def test_cured_repairs_findings(self, file):
        broken = file.build().edited("leftLowerLeg", mass=900.0)
        cured, report = broken.cured()
        assert any(finding["fixed"] for finding in report["findings"])
        assert cured.masses.max() < 100
        text, notes = cured.to_mjcf("him")
        assert text.startswith("<mujoco") and isinstance(notes, list)


class TestBakes:
    def test_colliders_stand_move_and_hold(self, character):
        hips = character.joints.index("hips")
        wall = sinew.Collider("box", [2, 1, 0.1], pose=[0, 1, 2.5, 0, 0, 0, 1])
        vertices = [[-9, 0, -9], [9, 0, -9], [9, 0, 9], [-9, 0, 9]]
        ground = sinew.Collider.mesh(vertices, [[0, 2, 1], [0, 3, 2]])
        still = character.bake(seconds=4, limp_at=0.1, world=[ground, wall])
        times, poses = [0, 1.5, 3.5], [[0, 1, 4, 0, 0, 0, 1], [0, 1, 4, 0, 0, 0, 1], [0, 1, -2, 0, 0, 0, 1]]
        plough = sinew.Collider("box", [2, 1, 0.2]).keyed(times, poses)
        moved = character.bake(seconds=4, limp_at=0.1, world=[ground, plough])
        assert still.positions[-1, hips, 1] < 0.5 and still.positions[-1, hips, 2] > -0.5
        assert moved.positions[-1, hips, 2] < still.positions[-1, hips, 2] - 0.5
        assert moved.hash == character.bake(seconds=4, limp_at=0.1, world=[ground, plough]).hash
        with pytest.raises(ValueError, match="half-space"):
            sinew.Collider.floor().keyed(times, poses)

    def test_wind_blows(self, character):
        hips = character.joints.index("hips")
        calm, windy = (character.bake(seconds=3, limp_at=0.1, wind=wind) for wind in (None, (60, 0, 0)))
        assert windy.positions[-1, hips, 0] > calm.positions[-1, hips, 0] + 0.1

    def test_drives_change_over_time(self, character):
        hand = character.joints.index("leftHand")
        drives = [
            sinew.Drive("limp", time=0.5, bone="leftUpperArm", below=True),
            sinew.Drive("keyed", time=2.0, bone="leftUpperArm", below=True),
        ]
        own = character.bake(seconds=4, limp_at=99.0, topple=False)
        driven = character.bake(seconds=4, drives=drives, topple=False)
        away = np.linalg.norm(driven.positions[:, hand] - own.positions[:, hand], axis=1)
        assert away[:14].max() < 0.02 and away[15:60].max() > 0.05 and away[-10:].max() < 0.02
        assert "powered" in driven.states

    def test_a_character_returns_to_its_clip(self):
        parts = figure()
        made = sinew.load_arrays(**parts, clips={"wave": wave(parts, 180)}, unit=1.0)
        character = made.character(clip="wave", exact=True)
        place = character.place_in_file
        own = character.bake(seconds=5.5, limp_at=99.0, pose=place, topple=False)
        back = character.bake(seconds=5.5, limp_at=1.0, return_at=4.0, return_seconds=0.6, pose=place, topple=False)
        away = np.linalg.norm(back.positions - own.positions, axis=2).max(axis=1)
        assert away[:30].max() < 1e-4 and away[60:90].max() > 0.3 and away[121:].max() < 1e-3
        steps = np.linalg.norm(np.diff(back.positions, axis=0), axis=2).max(axis=1)
        assert steps[100:130].max() < 0.35

    def test_characters_of_one_bake_meet(self, character):
        near = [0, 0, 0.7, 0, 1, 0, 0]
        one = sinew.Actor(character, hits=[(0.3, "chest", (0, 0, 250))])
        two = sinew.Actor(character, limp_at=1.2, pose=near)
        met = sinew.bake([one, two], seconds=3)
        apart = sinew.bake([one, sinew.Actor(character, limp_at=1.2, pose=[50, 0, 0, 0, 0, 0, 1])], seconds=3)
        assert len(met) == 2 and met[0].hash != apart[0].hash
        assert not np.array_equal(met[0].positions, apart[0].positions)

    def test_progress_is_reported_and_cancels(self, character):
        told: list[float] = []
        character.bake(seconds=60, progress=told.append)
        assert told == sorted(told) and (not told or 0 < told[0] <= told[-1] <= 1)
        with pytest.raises(sinew.Cancelled):
            character.bake(seconds=600, progress=lambda share: False)
        with pytest.raises(ZeroDivisionError):
            character.bake(seconds=600, progress=lambda share: bool(1 / 0))

    def test_invalid_arguments_raise_value_errors(self, character):
        for wrong in (
            lambda: sinew.Drive("floating"),
            lambda: sinew.Drive("powered", strength=2.0),
            lambda: character.bake(drives=[sinew.Drive("limp", bone="wing")]),
            lambda: character.bake(world=[7]),
            lambda: character.bake(return_at=float("nan")),
            lambda: sinew.Collider.mesh([[0, 0, 0]], [[0, 1, 2]]),
            lambda: sinew.Collider("box", [0, 1, 1]),
        ):
            with pytest.raises(ValueError):
                wrong()


class TestLive:
    def world(self) -> sinew.World:
        world = sinew.World()
        world.add_floor()
        return world

    def test_a_character_walks_is_hit_and_gets_up(self, character):
        world = self.world()
        hero = world.add_character(character, pose=IDENTITY)
        hero.set_move([0, 0, 1.2])
        world.step(120)
        assert hero.state == "animated" and hero.pose[2] > 1.0
        hero.hit("chest", [0, 0, 200])
        states = set()
        for _ in range(900):
            world.step()
            states.add(hero.state)
        assert {"limp", "getting up", "animated"} <= states
        assert hero.positions.shape == (len(character.joints), 3)
        assert hero.skin_matrices().shape[1:] == (3, 4)

    def test_drives_presets_and_return(self, character):
        world = self.world()
        hero = world.add_character(character)
        hero.set_preset("powered")
        world.step(30)
        assert hero.state == "powered"
        hero.set_drive(sinew.Drive("limp", bone="rightUpperArm", below=True, half_life=0.05))
        world.step(30)
        hero.go_limp()
        world.step(60)
        assert hero.state == "limp" and len(hero.bodies) == len(character.roles)
        hero.return_to_clip(IDENTITY, seconds=0.5)
        world.step(40)
        assert hero.state == "animated" and np.abs(hero.pose[:3]).max() < 0.1
        with pytest.raises(ValueError):
            hero.set_preset("asleep")
        with pytest.raises(ValueError, match="wing"):
            hero.hit("wing", [0, 0, 1])

    def test_a_character_holds_lets_go_and_loses_a_limb(self, character):
        world = self.world()
        hero = world.add_character(character)
        world.step()
        ball = world.add_body("sphere", [0.05], pose=[0, 3, 0, 0, 0, 0, 1])
        hero.hold("rightHand", ball)
        world.step(10)
        assert hero.held.tolist() == [ball]
        assert hero.release(ball) and not hero.release(ball)
        limb = hero.detach("leftLowerArm")
        assert limb is not None and len(limb) == 2 and hero.detach("leftHand") is None
        world.step(30)
        hero.despawn()
        with pytest.raises(ValueError, match="taken out"):
            hero.state

    def test_a_saved_world_brings_its_characters_back(self, character):
        world = self.world()
        hero = world.add_character(character)
        world.add_wind([3, 0, 0], gust_speed=1.0)
        world.add_collider(sinew.Collider("box", [0.2, 0.2, 0.2]).keyed([0, 2], [[3, 1, 0, 0, 0, 0, 1], [-3, 1, 0, 0, 0, 0, 1]]))
        world.step(20)
        hero.go_limp()
        world.step(20)
        state, hash_then = world.save(), world.hash()
        world.step(100)
        end, pose = world.hash(), hero.positions
        world.load(state)
        assert world.hash() == hash_then
        world.step(100)
        assert world.hash() == end and np.array_equal(hero.positions, pose)
        with pytest.raises(sinew.SinewError):
            world.load(state[:-40])

    def test_a_live_fall_has_the_bits_of_the_bake(self, character):
        """While animated, a bake adds no bodies to the world; a character without detail adds none either."""
        world = self.world()
        hero = world.add_character(character)
        hero.set_level_of_detail("keyed")
        twin = self.world()
        other = twin.add_character(character)
        other.set_level_of_detail("keyed")
        for each, it in ((world, hero), (twin, other)):
            each.step(30)
            it.go_limp()
            each.step(90)
        assert world.hash() == twin.hash() and np.array_equal(hero.positions, other.positions)


class TestFormats:
    def test_usd_opens_with_the_same_joints_limits_and_motion(self, file, character, tmp_path):
        pxr = pytest.importorskip("pxr")
        from pxr import Usd, UsdGeom, UsdPhysics, UsdSkel

        assert pxr
        ragdoll = file.build()
        baked = character.bake(seconds=2, limp_at=0.5, pose=[1, 0, 2, 0, 0.38268343, 0, 0.92387953])
        text, notes = baked.usda()
        assert any("friction" in note for note in notes)
        path = tmp_path / "fall.usda"
        path.write_text(text)
        stage = Usd.Stage.Open(str(path))
        assert UsdGeom.GetStageMetersPerUnit(stage) == 1 and stage.GetEndTimeCode() == 60
        cache, root = UsdSkel.Cache(), UsdSkel.Root(stage.GetPrimAtPath("/Character"))
        cache.Populate(root, Usd.PrimDefaultPredicate)
        skeleton = cache.GetSkelQuery(UsdSkel.Skeleton(stage.GetPrimAtPath("/Character/Skeleton")))
        place = UsdGeom.Xformable(root.GetPrim()).ComputeLocalToWorldTransform(30)
        there = [(m * place).ExtractTranslation() for m in skeleton.ComputeJointSkelTransforms(30)]
        assert np.array(there) == pytest.approx(baked.positions[30], abs=3e-4)
        bodies = [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
        masses = [UsdPhysics.MassAPI(prim).GetMassAttr().Get() for prim in bodies]
        assert masses == pytest.approx(ragdoll.masses, rel=1e-6)
        joints = [prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Joint)]
        assert len(joints) == len(ragdoll) - 1
        import json

        for prim, body in zip(joints, json.loads(ragdoll.to_json())["bodies"][1:]):
            targets = UsdPhysics.Joint(prim).GetBody0Rel().GetTargets() + UsdPhysics.Joint(prim).GetBody1Rel().GetTargets()
            assert [target.name for target in targets] == [body["joint"]["parent"], body["bone"]]
            limits = body["joint"].get("limits_deg", {})
            for axis, key in (("rotX", "twist"), ("rotY", "swing_y"), ("rotZ", "swing_z")):
                if key in limits and body["joint"]["type"] != "universal":
                    limit = UsdPhysics.LimitAPI(prim, axis)
                    assert [limit.GetLowAttr().Get(), limit.GetHighAttr().Get()] == pytest.approx(limits[key], abs=1e-3)

    def test_usd_is_written_as_text_and_as_binary(self, character, tmp_path):
        pytest.importorskip("pxr")
        from pxr import Usd

        from sinew import usd

        baked = character.bake(seconds=1)
        stages = []
        for name in ("fall.usda", "fall.usdc"):
            assert any("friction" in note for note in usd.save(baked, tmp_path / name))
            stages.append(Usd.Stage.Open(str(tmp_path / name)))
        assert (tmp_path / "fall.usdc").read_bytes()[:8] == b"PXR-USDC"
        text, binary = ([prim.GetPath() for prim in stage.Traverse()] for stage in stages)
        assert text == binary and len(text) > 50
        with pytest.raises(ValueError, match="ends with .usda or .usdc"):
            usd.save(baked, tmp_path / "fall.usdz")

    def test_a_urdf_is_a_model(self, tmp_path):
        path = tmp_path / "arm.urdf"
        path.write_text(
            '<robot name="arm"><link name="world"/><link name="arm"><inertial><mass value="1"/>'
            '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            '<joint name="j" type="continuous"><parent link="world"/><child link="arm"/></joint></robot>'
        )
        model = sinew.load_model(path)
        assert model.name == "arm" and model.joints == ["j"] and model.bodies == ["world", "arm"]
        path.write_text("<robot name='arm'><link/></robot>")
        with pytest.raises(sinew.FileError, match=r"arm\.urdf: .*name.* missing \(line 1 column"):
            sinew.load_model(path)
