//! Characters in a world of Python.

use crate::arrays::{affine, array, floats, poses, push_pose, vec3};
use crate::bake::{event_name, state_name};
use crate::drive::{Drive, body_named};
use crate::errors::{bad, guarded, refused};
use crate::mover::Mover;
use crate::particles::LiveParticles;
use crate::world::World;
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use sinew::anim::LocalTransform;
use sinew::math::{Affine, Transform, Vec3};
use sinew::physics::{BodyHit, BodyId, Strength};
use sinew::ragdoll::{AfterSettling, CharacterDef, Detail, Grab, Grip, Preset};
use std::sync::Arc;

/// Character in a world; it is updated after every step.
#[pyclass(frozen, module = "sinew")]
pub struct LiveCharacter {
    pub world: Py<World>,
    /// Index in the world's list of characters.
    pub index: usize,
    pub def: Arc<CharacterDef>,
}

impl LiveCharacter {
    /// Reads the character; fails with `ValueError` after its removal.
    fn read<T>(&self, py: Python<'_>, read: impl FnOnce(&sinew::ragdoll::Character) -> T) -> PyResult<T> {
        let world = self.world.borrow(py);
        let character = world.characters[self.index].as_ref();
        Ok(read(character.ok_or_else(|| bad("the character was taken out of its world"))?))
    }

    /// Applies an action to the character in its world.
    fn act<T>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut sinew::ragdoll::Character, &mut sinew::physics::World) -> T,
    ) -> PyResult<T> {
        let mut world = self.world.borrow_mut(py);
        let World { world, characters, .. } = &mut *world;
        let character = characters[self.index].as_mut();
        let character = character.ok_or_else(|| bad("the character was taken out of its world"))?;
        refused(|| act(character, world))
    }

    fn joints<'py>(
        &self,
        py: Python<'py>,
        numbers: Vec<f32>,
        width: usize,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        array(py, numbers, &[self.def.rig.joints.len(), width])
    }
}

/// Translations and rotations of joints.
type JointArrays<'py> = (Bound<'py, PyArrayDyn<f32>>, Bound<'py, PyArrayDyn<f32>>);
/// Pose of a character, and translations and rotations of its joints.
type PoseArrays<'py> = (Bound<'py, PyArray1<f32>>, Bound<'py, PyArrayDyn<f32>>, Bound<'py, PyArrayDyn<f32>>);

fn translations_of(pose: &[LocalTransform]) -> Vec<f32> {
    pose.iter().flat_map(|joint| joint.translation.to_array()).collect()
}

fn rotations_of(pose: &[LocalTransform]) -> Vec<f32> {
    pose.iter().map(|joint| joint.rotation).flat_map(|q| [q.x, q.y, q.z, q.w]).collect()
}

/// Reads a pose from seven numbers.
pub fn one_pose(given: &Bound<'_, PyAny>) -> PyResult<Transform> {
    Ok(poses(&floats(given, &[Some(7)], "pose")?, "pose")?[0])
}

#[pymethods]
impl LiveCharacter {
    /// State: animated, limp, preparing, getting up, flinching or powered.
    #[getter]
    fn state(&self, py: Python<'_>) -> PyResult<&'static str> {
        self.read(py, |character| state_name(character.state()))
    }

    /// Events of the last step, and of calls after it.
    #[getter]
    fn events(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.read(py, |character| character.events().iter().map(event_name).collect())
    }

    /// Pose of the character, (7,).
    #[getter]
    fn pose<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let mut numbers = Vec::new();
        self.read(py, |character| push_pose(&mut numbers, &character.world_from_character()))?;
        Ok(PyArray1::from_vec(py, numbers))
    }

    /// Positions of all joints relative to their parents, (joints, 3), units of the file.
    #[getter]
    fn translations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = self.read(py, |character| translations_of(character.pose()))?;
        self.joints(py, numbers, 3)
    }

    /// Rotations of all joints relative to their parents, (joints, 4), x y z w.
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = self.read(py, |character| rotations_of(character.pose()))?;
        self.joints(py, numbers, 4)
    }

    /// The pose without the motion of springs: translations (joints, 3) and rotations (joints, 4) relative to the parents.
    fn pose_without_springs<'py>(&self, py: Python<'py>) -> PyResult<JointArrays<'py>> {
        let read = |pose: &[LocalTransform]| (translations_of(pose), rotations_of(pose));
        let (places, turns) = self.read(py, |character| read(character.pose_without_springs()))?;
        Ok((self.joints(py, places, 3)?, self.joints(py, turns, 4)?))
    }

    /// The pose `alpha` between the last two steps: of the character (7,), and of the joints relative to their parents, translations
    /// (joints, 3) and rotations (joints, 4).
    fn interpolated<'py>(&self, py: Python<'py>, alpha: f32) -> PyResult<PoseArrays<'py>> {
        let mut pose = Vec::new();
        let place = self.read(py, |character| character.interpolated(alpha, &mut pose))?;
        let mut numbers = Vec::new();
        push_pose(&mut numbers, &place);
        let translations = self.joints(py, translations_of(&pose), 3)?;
        let rotations = self.joints(py, rotations_of(&pose), 4)?;
        Ok((PyArray1::from_vec(py, numbers), translations, rotations))
    }

    /// Matrix from the file's model space to the world, (3, 4).
    #[getter]
    fn world_from_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let matrix = self.read(py, sinew::ragdoll::Character::world_from_model)?;
        affine(py, &matrix)
    }

    /// True if the character is powered and takes steps to catch a push.
    #[getter]
    fn stumbles(&self, py: Python<'_>) -> PyResult<bool> {
        self.read(py, sinew::ragdoll::Character::stumbles)
    }

    /// Level of detail: full, hit_bodies, keyed or frozen.
    #[getter]
    fn level_of_detail(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(match self.read(py, sinew::ragdoll::Character::level_of_detail)? {
            Detail::Full => "full",
            Detail::HitBodies => "hit_bodies",
            Detail::Keyed => "keyed",
            Detail::Frozen => "frozen",
        })
    }

    /// True if the character gets up once it lies still.
    #[getter]
    fn gets_up(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.read(py, sinew::ragdoll::Character::after_settling)? == AfterSettling::GetUp)
    }

    /// Sets whether the character gets up once it lies still.
    fn set_gets_up(&self, py: Python<'_>, gets_up: bool) -> PyResult<()> {
        let after = if gets_up { AfterSettling::GetUp } else { AfterSettling::StayDown };
        self.act(py, |character, _| character.set_after_settling(after))
    }

    /// Mover of the character; None if it has none at present.
    #[getter]
    fn mover(&self, py: Python<'_>) -> PyResult<Option<Mover>> {
        let id = self.read(py, sinew::ragdoll::Character::mover)?;
        Ok(id.map(|id| Mover { world: self.world.clone_ref(py), id }))
    }

    /// Particles of the character's garments.
    #[getter]
    fn garments(&self, py: Python<'_>) -> PyResult<Vec<LiveParticles>> {
        let groups = self.read(py, |character| character.garments().to_vec())?;
        let world = self.world.borrow(py);
        let made = groups.into_iter().map(|group| LiveParticles {
            world: self.world.clone_ref(py),
            group,
            triangles: world.world.particles(group).faces().as_flattened().to_vec(),
        });
        Ok(made.collect())
    }

    /// Joints whose limbs were detached.
    #[getter]
    fn lost_joints(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let lost = self.read(py, sinew::ragdoll::Character::lost_joints)?;
        Ok(lost.into_iter().map(|joint| self.def.rig.joints[joint].name.clone()).collect())
    }

    /// Positions of all joints in the world, (joints, 3), metres.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = self.read(py, |character| {
            let mut model: Vec<Affine> = Vec::new();
            let root = character.world_from_model();
            sinew::anim::local_to_model(&self.def.rig, character.pose(), &root, &mut model);
            model.iter().flat_map(|joint| joint.translation.to_array()).collect()
        })?;
        self.joints(py, numbers, 3)
    }

    /// Matrices of a skin, (joints of the skin, 3, 4): from the mesh's bind pose to the world, interpolated by `alpha` between the last
    /// two steps.
    #[pyo3(signature = (skin=0, *, alpha=1.0))]
    fn skin_matrices<'py>(
        &self,
        py: Python<'py>,
        skin: usize,
        alpha: f32,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        if skin >= self.def.rig.skins.len() {
            return Err(bad(format!("there is no skin {skin}, but {}", self.def.rig.skins.len())));
        }
        let mut palette = Vec::new();
        self.read(py, |character| character.skin_palette(skin, alpha, &mut palette))?;
        let count = palette.len();
        array(py, palette.into_iter().flatten().collect(), &[count, 3, 4])
    }

    /// Ids of the character's bodies in the world, in the order of `Ragdoll.roles`; empty while it has none.
    #[getter]
    fn bodies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let ids = self.read(py, |character| character.bodies().iter().map(|id| id.to_bits()).collect())?;
        Ok(PyArray1::from_vec(py, ids))
    }

    /// Sets the character's velocity over the ground, m/s; with `None` the character follows its clips.
    #[pyo3(signature = (velocity))]
    fn set_move(&self, py: Python<'_>, velocity: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let velocity = velocity.map(|velocity| vec3(velocity, "velocity")).transpose()?;
        self.act(py, |character, _| match velocity {
            Some(velocity) => character.set_move(velocity),
            None => character.follow_clips(),
        })
    }

    /// Makes the character turn to face a direction.
    fn face(&self, py: Python<'_>, direction: &Bound<'_, PyAny>) -> PyResult<()> {
        let direction = vec3(direction, "direction")?;
        self.act(py, |character, _| character.face(direction))
    }

    /// Makes the character jump in the next step, if it is on the ground.
    fn jump(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, |character, world| character.jump(world))
    }

    /// Hits a body, given by role or joint, with an impulse in N·s; returns the work of the impulse, J.
    fn hit(&self, py: Python<'_>, bone: &str, impulse: &Bound<'_, PyAny>) -> PyResult<f32> {
        let (body, impulse) = (body_named(&self.def, bone)?, vec3(impulse, "impulse")?);
        self.act(py, |character, world| character.hit(world, body, impulse))
    }

    /// Hits a body of the character, given by its id in the world, at a point, with an impulse in N·s; returns the work of the impulse, J,
    /// or None if the body does not belong to the character.
    fn hit_at(
        &self,
        py: Python<'_>,
        body: u64,
        point: &Bound<'_, PyAny>,
        impulse: &Bound<'_, PyAny>,
    ) -> PyResult<Option<f32>> {
        let body = self.world.borrow(py).body(body)?;
        let (point, impulse) = (vec3(point, "point")?, vec3(impulse, "impulse")?);
        let hit = BodyHit { body, shape: 0, fraction: 0.0, point, normal: Vec3::Y, start: None };
        self.act(py, |character, world| character.hit_at(world, &hit, impulse))
    }

    /// Makes the character limp.
    fn go_limp(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, |character, world| character.go_limp(world))
    }

    /// Changes the drive of the whole character: animated, flinching, powered or limp.
    fn set_preset(&self, py: Python<'_>, preset: &str) -> PyResult<()> {
        let preset = match preset {
            "animated" => Preset::Animated,
            "flinching" => Preset::Flinching,
            "powered" => Preset::Powered,
            "limp" => Preset::Limp,
            other => {
                return Err(bad(format!("a preset is animated, flinching, powered or limp, not '{other}'")));
            }
        };
        self.act(py, |character, world| character.set_preset(world, preset))
    }

    /// Changes the drive of a part immediately; the drive's time is ignored.
    fn set_drive(&self, py: Python<'_>, drive: &Drive) -> PyResult<()> {
        let part = drive.part(&self.def)?;
        self.act(py, |character, world| character.set_drive(world, part, drive.mode, drive.half_life))
    }

    /// Blends the character back to its looped clip at `phase` seconds, at a pose, within `seconds`.
    #[pyo3(signature = (pose, *, phase=0.0, seconds=0.5))]
    fn return_to_clip(
        &self,
        py: Python<'_>,
        pose: &Bound<'_, PyAny>,
        phase: f32,
        seconds: f32,
    ) -> PyResult<()> {
        let place = one_pose(pose)?;
        self.act(py, |character, world| character.return_to_clip(world, place, phase, seconds))
    }

    /// Teleports the character.
    fn teleport(&self, py: Python<'_>, pose: &Bound<'_, PyAny>) -> PyResult<()> {
        let place = one_pose(pose)?;
        self.act(py, |character, world| character.teleport(world, place))
    }

    /// Moves a limp character out of static shapes; returns false if it is in none.
    fn clear(&self, py: Python<'_>) -> PyResult<bool> {
        self.act(py, |character, world| character.clear(world))
    }

    /// Makes a bone hold a dynamic body of the world; `pose` is the body's pose in the bone's frame. Returns the joint's id.
    #[pyo3(signature = (bone, body, *, pose=None, drops=false, max_force=f32::INFINITY, max_torque=f32::INFINITY))]
    fn hold(
        &self,
        py: Python<'_>,
        bone: &str,
        body: u64,
        pose: Option<&Bound<'_, PyAny>>,
        drops: bool,
        max_force: f32,
        max_torque: f32,
    ) -> PyResult<u64> {
        body_named(&self.def, bone)?;
        let body = self.world.borrow(py).body(body)?;
        let bone_from_held = pose.map(one_pose).transpose()?.unwrap_or(Transform::IDENTITY);
        let grip =
            Grip { bone_from_held, drops, strength: Strength { force: max_force, torque: max_torque } };
        Ok(self.act(py, |character, world| character.hold(world, bone, body, &grip))?.to_bits())
    }

    /// Makes a bone grab a body within reach, also one of another character; returns the joint's id, or None if the body is out of
    /// reach.
    #[pyo3(signature = (bone, body, *, max_force=1300.0, reach=0.25, slip=0.4, speed=1.0, to=None, drops=true))]
    fn grab(
        &self,
        py: Python<'_>,
        bone: &str,
        body: u64,
        max_force: f32,
        reach: f32,
        slip: f32,
        speed: f32,
        to: Option<&Bound<'_, PyAny>>,
        drops: bool,
    ) -> PyResult<Option<u64>> {
        body_named(&self.def, bone)?;
        let body = self.world.borrow(py).body(body)?;
        let to = to.map(|to| vec3(to, "to")).transpose()?;
        let grab = Grab { max_force, reach, slip, to, speed, drops };
        let joint = self.act(py, |character, world| character.grab(world, bone, body, &grab))?;
        Ok(joint.map(|joint| joint.to_bits()))
    }

    /// Releases a held body; returns false if the character does not hold it.
    fn release(&self, py: Python<'_>, body: u64) -> PyResult<bool> {
        self.act(py, |character, world| character.release(world, BodyId::from_bits(body)))
    }

    /// Ids of the bodies that the character holds.
    #[getter]
    fn held<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let ids = self.read(py, |character| character.held().map(BodyId::to_bits).collect())?;
        Ok(PyArray1::from_vec(py, ids))
    }

    /// Detaches a limb with all its descendants; returns the ids of its bodies, which stay in the world. None if it was already
    /// detached.
    fn detach<'py>(&self, py: Python<'py>, bone: &str) -> PyResult<Option<Bound<'py, PyArray1<u64>>>> {
        body_named(&self.def, bone)?;
        let limb = self.act(py, |character, world| character.detach(world, bone))?;
        Ok(limb.map(|limb| PyArray1::from_vec(py, limb.bodies().iter().map(|id| id.to_bits()).collect())))
    }

    /// Sets the level of detail: full, hit bodies, keyed or frozen.
    #[pyo3(signature = (detail))]
    fn set_level_of_detail(&self, py: Python<'_>, detail: &str) -> PyResult<()> {
        let detail = match detail {
            "full" => Detail::Full,
            "hit_bodies" => Detail::HitBodies,
            "keyed" => Detail::Keyed,
            "frozen" => Detail::Frozen,
            other => {
                return Err(bad(format!("a detail is full, hit_bodies, keyed or frozen, not '{other}'")));
            }
        };
        self.act(py, |character, world| character.set_level_of_detail(world, detail))
    }

    /// Resets the character's springs to rest.
    fn reset_springs(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, |character, _| character.reset_springs())
    }

    /// Resets the character's garments to rest.
    fn reset_garments(&self, py: Python<'_>) -> PyResult<()> {
        self.act(py, |character, world| character.reset_garments(world))
    }

    /// Removes the character from the world.
    fn despawn(&self, py: Python<'_>) -> PyResult<()> {
        let mut world = self.world.borrow_mut(py);
        let World { world, characters, .. } = &mut *world;
        let character = characters[self.index].take();
        let character = character.ok_or_else(|| bad("the character was taken out of its world"))?;
        guarded(|| character.despawn(world))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let at: Vec3 = self.read(py, |character| character.world_from_character().translation)?;
        Ok(format!("LiveCharacter({}, at {:.2} {:.2} {:.2})", self.state(py)?, at.x, at.y, at.z))
    }
}
