"""Fields, particles, movers and explosions of worlds, and settings of characters."""

import numpy as np
import pytest

import sinew

IDENTITY = [0, 0, 0, 0, 0, 0, 1]


@pytest.fixture(scope="module")
def character() -> sinew.Character:
    return sinew.mannequin().character()


class TestFields:
    def test_water_carries_a_raft(self):
        world = sinew.World()
        world.add_field(sinew.Field.water(1.0))
        raft = world.add_body("box", [0.4, 0.1, 0.4], density=300.0, pose=[0, 1, 0, 0, 0, 0, 1])
        world.step(600)
        # Archimedes: 30 % of it is under water.
        assert world.poses([raft])[0, 1] == pytest.approx(1.0 + 0.1 - 0.3 * 0.2, abs=0.005)

    def test_a_field_acts_inside_its_region_only(self):
        world = sinew.World(gravity=[0, 0, 0])
        lift = sinew.Field.gravity([0, 5, 0]).inside("box", [1, 10, 1])
        field = world.add_field(lift)
        inside, outside = (world.add_body("sphere", [0.1], pose=[x, 0, 0, 0, 0, 0, 1]) for x in (0, 5))
        world.step(60)
        velocities = world.velocities([inside, outside])
        assert velocities[0, 1] == pytest.approx(5.0, abs=0.01) and velocities[1, 1] == 0.0
        world.remove_field(field)
        world.step(60)
        assert world.velocities([inside])[0, 1] == pytest.approx(velocities[0, 1])

    def test_fields_act_in_bakes(self, character):
        falls = [character.bake(seconds=2, limp_at=0.2, fields=fields) for fields in ([], [sinew.Field.wind([0, 0, 60])])]
        hips = character.joints.index("hips")
        assert falls[1].positions[-1, hips, 2] > falls[0].positions[-1, hips, 2] + 0.3
        same = character.bake(seconds=2, limp_at=0.2, wind=[0, 0, 60])
        assert same.hash == falls[1].hash

    def test_attraction_and_drag(self):
        world = sinew.World(gravity=[0, 0, 0])
        world.add_field(sinew.Field.attraction([0, 0, 0], 4.0))
        ball = world.add_body("sphere", [0.1], pose=[2, 0, 0, 0, 0, 0, 1])
        world.step(6)
        assert world.velocities([ball])[0, 0] == pytest.approx(-0.1, rel=0.02)  # 4 / 2² m/s² for 0.1 s
        world.add_field(sinew.Field.drag(linear=1e4))
        world.step(60)
        assert abs(world.velocities([ball])[0, 0]) < 0.01

    @pytest.mark.parametrize("wrong", [lambda: sinew.Field.water(density=-1), lambda: sinew.Field.wind([0, np.nan, 0]), lambda: sinew.Field.wind([0, 0, 1]).inside("box", [1, 1, 1], fade="slow")])
    def test_invalid_fields_raise_value_errors(self, wrong):
        with pytest.raises(ValueError):
            wrong()


class TestExplosions:
    def test_a_wall_shelters(self):
        speeds = []
        for sheltered in (False, True):
            world = sinew.World(gravity=[0, 0, 0])
            world.add_body("box", [0.1, 2, 2], body="static", pose=[1, 0, 0, 0, 0, 0, 1])
            ball = world.add_body("sphere", [0.1], pose=[2, 0, 0, 0, 0, 0, 1])
            world.explode([0, 0, 0], 5.0, 1000.0, sheltered=sheltered)
            world.step()
            speeds.append(world.velocities([ball])[0, 0])
        assert speeds[0] > 1.0 and speeds[1] == 0.0


class TestParticles:
    def test_a_rope_holds_a_ball(self):
        world = sinew.World()
        ball = world.add_body("sphere", [0.1], pose=[0, 0, 0, 0, 0, 0, 1])
        rope = world.add_particles(sinew.Particles.rope([0, 1, 0], [0, 0, 0]).attached(0).attached(-1, ball))
        world.step(240)
        assert world.poses([ball])[0, 1] == pytest.approx(0.0, abs=0.02)
        assert rope.positions[0] == pytest.approx([0, 1, 0], abs=1e-4) and rope.triangles.shape == (0, 3)
        rope.remove()
        world.step(30)
        assert world.poses([ball])[0, 1] < -0.5
        with pytest.raises(ValueError, match="removed"):
            rope.push(0, [0, 0, 0])

    def test_cloth_hangs_and_a_soft_ball_lies(self):
        world = sinew.World()
        world.add_floor()
        cloth = world.add_particles(sinew.Particles.cloth([0, 2, 0], [1, 0, 0], [0, 0, 1], columns=8, rows=8, hang=True))
        ball = world.add_particles(sinew.Particles.soft_ball([3, 0.6, 0], 0.3, mass=1.0))
        assert cloth.positions.shape == (81, 3) and cloth.triangles.shape == (128, 3)
        world.step(240)
        assert cloth.positions[:, 1].min() == pytest.approx(1.0, abs=0.1)
        assert 0.0 < ball.positions[:, 1].min() < 0.02 and ball.positions[:, 1].max() > 0.3
        assert np.abs(ball.velocities).max() < 0.5


class TestMovers:
    def test_a_mover_walks_up_a_step_and_jumps(self):
        world = sinew.World()
        world.add_floor()
        step = world.add_body("box", [1, 0.1, 2], body="static", pose=[2, 0.1, 0, 0, 0, 0, 1])
        mover = world.add_mover([0, 0, 0])
        mover.walk([1.5, 0, 0])
        world.step(90)
        assert mover.position[1] == pytest.approx(0.2, abs=0.02) and mover.ground == step
        mover.walk([0, 0, 0])
        world.step(30)
        mover.jump(3.0)
        world.step(15)
        assert not mover.grounded and mover.position[1] > 0.5
        mover.remove()
        with pytest.raises(ValueError, match="removed"):
            mover.walk([0, 0, 0])


class TestCharacterSettings:
    def test_toughness_decides_between_a_flinch_and_a_fall(self, character):
        states = {}
        for toughness in (None, 1e6):
            world = sinew.World()
            world.add_floor()
            hero = world.add_character(character.edited(toughness=toughness))
            world.step(30)
            hero.hit("chest", [0, 0, 30])
            world.step(2)
            states[toughness] = hero.state
        assert states == {None: "limp", 1e6: "flinching"}

    def test_motions_are_chosen_by_name(self, character):
        assert character.edited(get_ups=[]).bake(seconds=6, limp_at=0.3).states[-1] != "getting up"
        still = character.edited(clip=None).bake(seconds=1, limp_at=0.9, topple=False)
        assert np.abs(np.diff(still.rotations[:20], axis=0)).max() < 1e-3
        with pytest.raises(ValueError, match="no clip is called 'fly'; there are"):
            character.edited(clip="fly")
        with pytest.raises(ValueError, match="no clip is called 'fly'; there are"):
            sinew.mannequin().character(clip="fly")
        with pytest.raises(TypeError, match="colour"):
            character.edited(colour="red")

    def test_a_child_is_smaller(self, character):
        child = character.scaled(0.5)
        assert child.swept_radius == pytest.approx(0.5 * character.swept_radius, rel=0.02)

    def test_a_dead_character_stays_down(self, character):
        world = sinew.World()
        world.add_floor()
        hero = world.add_character(character)
        hero.set_gets_up(False)
        assert not hero.gets_up
        hero.go_limp()
        world.step(600)
        assert hero.state == "limp"

    def test_poses_between_steps_and_hits_at_points(self, character):
        world = sinew.World()
        world.add_floor()
        hero = world.add_character(character)
        world.step(30)
        pose, translations, rotations = hero.interpolated(1.0)
        assert np.allclose(pose, hero.pose) and np.allclose(rotations, hero.rotations, atol=1e-6)
        assert np.allclose(hero.pose_without_springs()[0], hero.translations) and translations.shape == hero.translations.shape
        assert hero.level_of_detail == "full" and not hero.stumbles and hero.mover is not None and hero.mover.grounded
        assert hero.world_from_model.shape == (3, 4) and hero.lost_joints == [] and hero.garments == []
        found = world.ray([[0, 1.2, 3]], [[0, 0, -5]])
        work = hero.hit_at(int(found["body"][0]), found["point"][0], [0, 0, -200])
        assert work is not None and work > 0 and hero.state == "limp"
        box = world.add_body("box", [0.1, 0.1, 0.1], pose=[5, 1, 0, 0, 0, 0, 1])
        assert hero.hit_at(box, [5, 1, 0], [0, 0, 1]) is None

    def test_bakes_have_settings_of_the_world_and_of_keys(self, character):
        coarse, fine = (character.bake(seconds=2, key_error=bound) for bound in ((0.01, 0.1), (0.0, 0.0)))
        assert coarse.keys[1] < fine.keys[1] and coarse.key_error[0] <= 0.01 and coarse.hash == fine.hash
        assert coarse.steps == 120 and coarse.bodies == len(character.roles)
        assert character.bake(seconds=1, dt=0.01).steps == 100
        exact = character.bake(seconds=2, quality="exact", substeps=8)
        assert exact.hash != coarse.hash
        toppled = character.bake(seconds=2, limp_at=0.2, topple_velocity=[0, 0, -2.0])
        head = character.joints.index("head")
        assert toppled.positions[-1, head, 2] < character.bake(seconds=2, limp_at=0.2).positions[-1, head, 2] - 0.1
