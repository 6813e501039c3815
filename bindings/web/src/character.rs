//! Characters in a world.

use crate::border::{Failure, Outcome, Shared};
use crate::character_def::{CharacterDef, bone_name};
use crate::definitions::body;
use crate::drive::drive_mode;
use crate::inner::{Inner, Member};
use crate::types::{
    DetailName, DriveOptions, GrabOptions, HoldOptions, PlayOptions, PoseOut, PresetName, QuatLike, StateOut,
    Vec3Like,
};
use crate::values::{Options, pose, rotation, vec3};
use crate::world::World;
use js_sys::Float32Array;
use sinew::anim::{Easing, LoopMode, TrackDef, Transition};
use sinew::math::{Rotation, Transform, Vec3};
use sinew::physics::{BodyHit, BodyId, Strength};
use sinew::ragdoll::{Detail, Grab, Grip, Part, Preset, State};
use wasm_bindgen::prelude::*;

/// A character in a world: it plays clips until it is hit, falls with its bodies, and gets up.
#[wasm_bindgen]
pub struct Character {
    inner: Shared<Inner>,
    place: usize,
    serial: u64,
}

const PRESETS: [(&str, Preset); 4] = [
    ("animated", Preset::Animated),
    ("flinching", Preset::Flinching),
    ("powered", Preset::Powered),
    ("limp", Preset::Limp),
];

const DETAILS: [(&str, Detail); 4] = [
    ("full", Detail::Full),
    ("hitBodies", Detail::HitBodies),
    ("keyed", Detail::Keyed),
    ("frozen", Detail::Frozen),
];

fn place_of(position: Option<Vec3Like>, turn: Option<QuatLike>) -> Outcome<Transform> {
    let position = position.map(|p| vec3(&p, "position")).transpose()?.unwrap_or(Vec3::ZERO);
    let turn = turn.map(|turn| rotation(&turn, "rotation")).transpose()?.unwrap_or(Rotation::IDENTITY);
    Ok(Transform::new(position, turn))
}

#[wasm_bindgen]
impl World {
    /// Adds a character of a kind to the world, standing at a position; it faces +Z without a rotation.
    pub fn spawn(
        &self,
        def: &CharacterDef,
        position: Option<Vec3Like>,
        turn: Option<QuatLike>,
    ) -> Outcome<Character> {
        let place = place_of(position, turn)?;
        let (place, serial) = self.inner.change(|inner| {
            let character = sinew::ragdoll::Character::spawn(&mut inner.world, &def.def, place);
            Ok(inner.settle_character(character))
        })?;
        Ok(Character { inner: self.inner.clone(), place, serial })
    }
}

fn gone() -> Failure {
    Failure::new("this character was removed from its world")
}

/// Returns the body of a character by role or bone.
fn named(character: &sinew::ragdoll::Character, bone: &str) -> Outcome<usize> {
    character.def().body_named(bone).ok_or_else(|| {
        let names: Vec<String> = character.def().ragdoll.bodies.iter().map(bone_name).collect();
        Failure(format!("no body is called '{bone}'; there are {}", names.join(", ")))
    })
}

/// Makes a grip from options that override `usual`.
pub fn grab_of(value: Option<GrabOptions>, usual: Grab) -> Outcome<Grab> {
    let value: JsValue = value.map(JsValue::from).unwrap_or_default();
    let options = Options::of(&value, "options", &["maxForce", "reach", "slip", "speed"])?;
    Ok(Grab {
        max_force: options.number("maxForce")?.unwrap_or(usual.max_force),
        reach: options.number("reach")?.unwrap_or(usual.reach),
        slip: options.bound("slip")?.unwrap_or(usual.slip),
        speed: options.number("speed")?.unwrap_or(usual.speed),
        ..usual
    })
}

impl Character {
    fn ask<R>(&self, call: impl FnOnce(&Inner, &Member) -> Outcome<R>) -> Outcome<R> {
        self.inner.read(|inner| {
            let member = inner.characters.get(self.place).and_then(Option::as_ref);
            let member = member.filter(|member| member.serial == self.serial);
            call(inner, member.ok_or_else(gone)?)
        })
    }

    fn change<R>(
        &self,
        call: impl FnOnce(&mut sinew::ragdoll::Character, &mut sinew::physics::World) -> Outcome<R>,
    ) -> Outcome<R> {
        self.inner.change(|inner| {
            let member = inner.characters.get_mut(self.place).and_then(Option::as_mut);
            let member = member.filter(|member| member.serial == self.serial).ok_or_else(gone)?;
            call(&mut member.character, &mut inner.world)
        })
    }
}

#[wasm_bindgen]
impl Character {
    // State

    /// Index of the character in its world, used by events.
    #[wasm_bindgen(getter)]
    pub fn index(&self) -> usize {
        self.place
    }

    /// State, which determines the source of its pose.
    #[wasm_bindgen(getter)]
    pub fn state(&self) -> Outcome<StateOut> {
        self.ask(|_, member| {
            let name = match member.character.state() {
                State::Animated => "animated",
                State::Limp => "limp",
                State::Preparing => "preparing",
                State::GettingUp => "gettingUp",
                State::Flinching => "flinching",
                State::Powered => "powered",
            };
            Ok(JsValue::from(name).unchecked_into())
        })
    }

    /// Pose on the ground, facing +Z. For a limp character, the pose at which it went limp.
    #[wasm_bindgen(getter)]
    pub fn place(&self) -> Outcome<PoseOut> {
        self.ask(|_, member| Ok(pose(member.character.world_from_character()).unchecked_into()))
    }

    /// Pose between the last two steps: ten numbers for each joint of the kind, in the order of its `nodes` (position, rotation x, y, z, w
    /// and scale, relative to the parent and in the file's unit), then the sixteen numbers of the matrix from the file to the world, column
    /// by column. The array is a view of memory: request it again in each frame.
    #[wasm_bindgen(getter)]
    pub fn pose(&self) -> Outcome<Float32Array> {
        self.ask(|_, member| Ok(member.view.of(&member.pose)))
    }

    /// Ids of the character's bodies, in the order of the kind's `bones`.
    pub fn bodies(&self) -> Outcome<Vec<u64>> {
        self.ask(|_, member| Ok(member.character.bodies().iter().map(|body| body.to_bits()).collect()))
    }

    /// Id of a body, by role or bone; `undefined` for a detached body.
    pub fn body(&self, bone: &str) -> Outcome<Option<u64>> {
        self.ask(|_, member| {
            let index = named(&member.character, bone)?;
            Ok(member.character.bodies().get(index).map(|body| body.to_bits()))
        })
    }

    /// Name of one of the character's bodies, for example of a ray hit; `undefined` for other bodies.
    pub fn bone(&self, body: u64) -> Outcome<Option<String>> {
        self.ask(|_, member| {
            let index = member.character.body_index(BodyId::from_bits(body));
            Ok(index.map(|index| bone_name(&member.character.def().ragdoll.bodies[index])))
        })
    }

    // Motion

    /// Sets the character's velocity over the ground, m/s.
    #[wasm_bindgen(js_name = setMove)]
    pub fn set_move(&self, velocity: Vec3Like) -> Outcome {
        let velocity = vec3(&velocity, "velocity")?;
        self.change(|character, _| {
            character.set_move(velocity);
            Ok(())
        })
    }

    /// Makes the character follow its clips again, as at the start.
    #[wasm_bindgen(js_name = followClips)]
    pub fn follow_clips(&self) -> Outcome {
        self.change(|character, _| {
            character.follow_clips();
            Ok(())
        })
    }

    /// Makes the character turn to face a direction.
    pub fn face(&self, direction: Vec3Like) -> Outcome {
        let direction = vec3(&direction, "direction")?;
        self.change(|character, _| {
            character.face(direction);
            Ok(())
        })
    }

    /// Makes the character jump in the next step, if it is on the ground.
    pub fn jump(&self) -> Outcome {
        self.change(|character, world| {
            character.jump(world);
            Ok(())
        })
    }

    /// Teleports the character.
    pub fn teleport(&self, position: Vec3Like, turn: Option<QuatLike>) -> Outcome {
        let place = place_of(Some(position), turn)?;
        self.change(|character, world| {
            character.teleport(world, place);
            Ok(())
        })
    }

    /// Plays one of the kind's clips instead of the current clip.
    pub fn play(&self, clip: &str, options: Option<PlayOptions>) -> Outcome {
        let value: JsValue = options.map(JsValue::from).unwrap_or_default();
        let options = Options::of(&value, "options", &["fade", "speed", "loop"])?;
        let seconds = options.number("fade")?.unwrap_or(0.25);
        let speed = options.number("speed")?.unwrap_or(1.0);
        let loops = options.flag("loop")?.unwrap_or(true);
        self.change(|character, _| {
            let def = character.def().clone();
            let clips = &def.motions().clips;
            let index = clips.iter().position(|other| other.name == clip).ok_or_else(|| {
                let names: Vec<&str> = clips.iter().map(|clip| clip.name.as_str()).collect();
                Failure(format!("no clip is called '{clip}'; there are {}", names.join(", ")))
            })?;
            let loop_mode = if loops { LoopMode::Loop } else { LoopMode::Once };
            let track = TrackDef { speed, loop_mode, ..TrackDef::new(def.clip(index)) };
            let transition = Transition::Crossfade { seconds, easing: Easing::Smooth };
            character.animator_mut().transition(def.set(), &track, transition);
            Ok(())
        })
    }

    // Hits and drives

    /// Hits a body, given by role or bone, with an impulse, N·s. The character falls, or flinches if the hit is weak.
    pub fn hit(&self, bone: &str, impulse: Vec3Like) -> Outcome {
        let impulse = vec3(&impulse, "impulse")?;
        self.change(|character, world| {
            let body = named(character, bone)?;
            character.hit(world, body, impulse);
            Ok(())
        })
    }

    /// Hits a body at a point in the world, for example of a ray hit; returns false if the body is not the character's.
    #[wasm_bindgen(js_name = hitAt)]
    pub fn hit_at(&self, body: u64, point: Vec3Like, impulse: Vec3Like) -> Outcome<bool> {
        let (point, impulse) = (vec3(&point, "point")?, vec3(&impulse, "impulse")?);
        self.change(|character, world| {
            let body = BodyId::from_bits(body);
            let hit = BodyHit { body, shape: 0, fraction: 0.0, point, normal: Vec3::Y, start: None };
            Ok(character.hit_at(world, &hit, impulse).is_some())
        })
    }

    /// Makes the character limp at its present pose and velocity.
    #[wasm_bindgen(js_name = goLimp)]
    pub fn go_limp(&self) -> Outcome {
        self.change(|character, world| {
            character.go_limp(world);
            Ok(())
        })
    }

    /// Changes the drive of the whole character: clips, muscles toward its clips, or none.
    #[wasm_bindgen(js_name = setPreset)]
    pub fn set_preset(&self, preset: PresetName) -> Outcome {
        let name = preset.as_string().unwrap_or_default();
        let found = PRESETS.iter().find(|(other, _)| *other == name);
        let (_, preset) = found.ok_or_else(|| {
            Failure(format!("a preset is {}, not '{name}'", PRESETS.map(|(name, _)| name).join(", ")))
        })?;
        self.change(|character, world| {
            character.set_preset(world, *preset);
            Ok(())
        })
    }

    /// Changes the drive of a body, or with `below` also of all its descendants; half of the change is made within `half_life` seconds.
    /// Without a bone, changes the drive of the whole character.
    #[wasm_bindgen(js_name = setDrive)]
    pub fn set_drive(
        &self,
        bone: Option<String>,
        mode: DriveOptions,
        below: Option<bool>,
        half_life: Option<f32>,
    ) -> Outcome {
        let mode = drive_mode(&mode)?;
        self.change(|character, world| {
            let part = match &bone {
                None => Part::All,
                Some(bone) => {
                    named(character, bone)?;
                    if below == Some(true) { Part::From(bone) } else { Part::Named(bone) }
                }
            };
            character.set_drive(world, part, mode, half_life.unwrap_or(0.1));
            Ok(())
        })
    }

    // Holding and grabbing

    /// Makes a body, given by role or bone, hold a dynamic body of the world, which is moved there.
    pub fn hold(&self, bone: &str, held: u64, options: Option<HoldOptions>) -> Outcome {
        let value: JsValue = options.map(JsValue::from).unwrap_or_default();
        let known = ["position", "rotation", "drops", "breakForce", "breakTorque"];
        let options = Options::of(&value, "options", &known)?;
        let grip = Grip {
            bone_from_held: Transform::new(
                options.vec3("position")?.unwrap_or(Vec3::ZERO),
                options.rotation("rotation")?.unwrap_or(Rotation::IDENTITY),
            ),
            strength: Strength {
                force: options.bound("breakForce")?.unwrap_or(f32::INFINITY),
                torque: options.bound("breakTorque")?.unwrap_or(f32::INFINITY),
            },
            drops: options.flag("drops")?.unwrap_or(false),
        };
        self.change(|character, world| {
            let held = body(world, held)?;
            named(character, bone)?;
            character.hold(world, bone, held, &grip);
            Ok(())
        })
    }

    /// Makes a body grab another body at its present pose, for example another character's limb, and drag it; returns false if the other
    /// body is out of reach.
    pub fn grab(&self, bone: &str, held: u64, options: Option<GrabOptions>) -> Outcome<bool> {
        let grab = grab_of(options, Grab::HAND)?;
        self.change(|character, world| {
            let held = body(world, held)?;
            named(character, bone)?;
            Ok(character.grab(world, bone, held, &grab).is_some())
        })
    }

    /// Releases a held body; returns false if the character does not hold it.
    pub fn release(&self, held: u64) -> Outcome<bool> {
        self.change(|character, world| Ok(character.release(world, BodyId::from_bits(held))))
    }

    /// Ids of the bodies that the character holds.
    pub fn held(&self) -> Outcome<Vec<u64>> {
        self.ask(|_, member| Ok(member.character.held().map(|body| body.to_bits()).collect()))
    }

    // Springs, garments and detail

    /// Resets the character's springs and garments to rest, for example after a camera cut.
    #[wasm_bindgen(js_name = resetSprings)]
    pub fn reset_springs(&self) -> Outcome {
        self.change(|character, world| {
            character.reset_springs();
            character.reset_garments(world);
            Ok(())
        })
    }

    /// Sets the level of detail: immediately if clips move the character, else as soon as they do.
    #[wasm_bindgen(js_name = setDetail)]
    pub fn set_detail(&self, detail: DetailName) -> Outcome {
        let name = detail.as_string().unwrap_or_default();
        let found = DETAILS.iter().find(|(other, _)| *other == name);
        let (_, detail) = found.ok_or_else(|| {
            Failure(format!("a detail is {}, not '{name}'", DETAILS.map(|(name, _)| name).join(", ")))
        })?;
        self.change(|character, world| {
            character.set_level_of_detail(world, *detail);
            Ok(())
        })
    }

    /// Removes the character from the world.
    pub fn remove(&self) -> Outcome {
        self.inner.change(|inner| {
            let is_it = inner.characters.get(self.place).and_then(Option::as_ref);
            is_it.filter(|member| member.serial == self.serial).ok_or_else(gone)?;
            if let Some(member) = inner.characters[self.place].take() {
                member.character.despawn(&mut inner.world);
            }
            Ok(())
        })
    }
}
