//! Instructions of a user to a character.

use sinew::anim::{Easing, LoopMode, TrackDef, Transition};
use sinew::math::{ReadError, Reader, Transform, Vec3, Writer, normalize_or, trig};
use sinew::physics::ray::Ray;
use sinew::physics::{BodyKinds, QueryFilter, World};
use sinew::ragdoll::{AfterSettling, Character, Preset, State};

/// Instruction to the character that a user controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act {
    /// Plays a clip in a loop, by its index in the character's motions. A character that is down stands up first.
    Play(u32),
    /// Falls limp, and stays down.
    Limp,
    /// Is driven by its muscles, which follow its clips and keep its balance.
    Powered,
    /// Gets up, and follows its own clips.
    GetUp,
}

/// Time in which a character that is down stands up to play a clip, seconds. Shorter: the character visibly jerks.
/// Longer: the user waits.
const INTO_STANDING: f32 = 0.5;
/// Time in which a clip blends in, seconds.
const FADE: f32 = 0.25;
/// Length of the search for ground below the character, metres.
const GROUND_BELOW: f32 = 1e3;

/// Instructions that a character carries out over several steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Directed {
    /// Clip that plays as soon as the character stands.
    pending: Option<u32>,
    /// Velocity that the user sets, m/s; `None` until the first one, and while a chosen clip plays.
    pub led: Option<Vec3>,
    /// True from the first instruction on.
    pub is_directed: bool,
    /// Work of muscles since the start, J.
    pub work: f32,
}

impl Directed {
    /// Carries out an instruction.
    pub fn act(&mut self, act: Act, character: &mut Character, world: &mut World) {
        self.is_directed = true;
        self.pending = None;
        self.led = None;
        match act {
            Act::Play(clip) => {
                if (clip as usize) < character.def().motions().clips.len() {
                    self.pending = Some(clip);
                    stand(character, world);
                }
            }
            Act::Limp => {
                character.set_after_settling(AfterSettling::StayDown);
                character.set_preset(world, Preset::Limp);
            }
            Act::Powered => {
                character.set_preset(world, Preset::Powered);
            }
            Act::GetUp => {
                character.set_after_settling(AfterSettling::GetUp);
                character.set_preset(world, Preset::Animated);
                character.follow_clips();
            }
        }
    }

    /// Sets the velocity of the character, m/s. A character that is down gets up.
    pub fn steer(&mut self, way: Vec3, character: &mut Character) {
        self.is_directed = true;
        self.pending = None;
        self.led = Some(way);
        if way != Vec3::ZERO {
            character.set_after_settling(AfterSettling::GetUp);
        }
    }

    /// Continues the instructions after a step.
    pub fn go_on(&mut self, character: &mut Character) {
        if let Some(clip) = self.pending
            && character.state() == State::Animated
        {
            self.pending = None;
            play(character, clip as usize);
        }
        if let Some(way) = self.led {
            character.set_move(way);
            if way != Vec3::ZERO {
                character.face(way);
            }
        }
    }

    pub fn save(&self, out: &mut Writer) {
        out.u8(u8::from(self.is_directed));
        out.u32(self.pending.map_or(0, |clip| clip + 1));
        out.u8(u8::from(self.led.is_some()));
        out.vec3(self.led.unwrap_or(Vec3::ZERO));
        out.f32(self.work);
    }

    pub fn load(bytes: &mut Reader<'_>) -> Result<Self, ReadError> {
        let is_directed = bytes.u8()? != 0;
        let pending = bytes.u32()?.checked_sub(1);
        let (is_led, way) = (bytes.u8()? != 0, bytes.vec3()?);
        Ok(Self { pending, led: is_led.then_some(way), is_directed, work: bytes.f32()? })
    }
}

/// Makes a character stand where it lies.
fn stand(character: &mut Character, world: &mut World) {
    if character.state() == State::Animated {
        return;
    }
    let from = character.world_from_character();
    let at = character.bodies().first().map_or(from.translation, |&body| world.center_of_mass(body));
    let down = Ray { origin: at, direction: Vec3::NEG_Y * GROUND_BELOW };
    let ground = world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&down);
    let place = ground.map_or(from.translation, |hit| hit.point);
    let ahead = from.rotation * Vec3::Z;
    let ahead = normalize_or(Vec3::new(ahead.x, 0.0, ahead.z), Vec3::Z);
    let turn = sinew::math::Rotation::from_axis_angle(Vec3::Y, trig::atan2(ahead.x, ahead.z));
    character.return_to_clip(world, Transform::new(place, turn), 0.0, INTO_STANDING);
}

fn play(character: &mut Character, clip: usize) {
    character.follow_clips();
    let def = character.def().clone();
    let track = TrackDef { loop_mode: LoopMode::Loop, ..TrackDef::new(def.clip(clip)) };
    let transition = Transition::Crossfade { seconds: FADE, easing: Easing::Smooth };
    character.animator_mut().transition(def.set(), &track, transition);
}
