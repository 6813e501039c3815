//! Balance while getting up: the centre of mass over hands, knees and feet.

use crate::bake::Baked;
use crate::character::{CharacterDef, State};
use crate::skin::surface::Surface;
use crate::tuning::{BEARS_NEAR, LEANS};
use sinew_anim::{LocalTransform, local_to_model};
use sinew_math::{Affine, Transform, Vec3, max, min, trig};

/// Number of horizontal directions in which the support is measured.
const DIRECTIONS: usize = 16;

/// Returns the longest time in a get-up during which the centre of mass is more than [`LEANS`] of the height outside
/// the support, seconds; `None` if no frame gets up, or the character has no skin. The support is the horizontal convex
/// hull of the skin within [`BEARS_NEAR`] of the height above the lowest point.
pub(super) fn unbalanced(def: &CharacterDef, baked: &Baked) -> Option<f32> {
    let meter = Balance::new(def)?;
    let (mut longest, mut run) = (None, 0.0);
    let mut last = 0.0;
    for frame in &baked.frames {
        if frame.state == State::GettingUp {
            let leans = meter.lean(def, &frame.pose) > LEANS * def.ragdoll.height;
            run = if leans { run + (frame.time - last) } else { 0.0 };
            longest = Some(max(longest.unwrap_or(0.0), run));
        }
        last = frame.time;
    }
    longest
}

struct Balance {
    skin: Surface,
    directions: [Vec3; DIRECTIONS],
}

impl Balance {
    fn new(def: &CharacterDef) -> Option<Self> {
        let skin = Surface::of(&def.rig, &def.ragdoll);
        let directions = core::array::from_fn(|index| {
            let (sine, cosine) = trig::sin_cos(core::f32::consts::TAU * index as f32 / DIRECTIONS as f32);
            Vec3::new(cosine, 0.0, sine)
        });
        (!skin.sample.is_empty()).then_some(Self { skin, directions })
    }

    /// Returns the horizontal distance by which the centre of mass is outside the support, metres; 0 or negative if it
    /// is above the support.
    fn lean(&self, def: &CharacterDef, pose: &[LocalTransform]) -> f32 {
        let (mut model, mut palette, mut bodies) = (Vec::new(), Vec::new(), Vec::new());
        local_to_model(&def.rig, pose, &Affine::IDENTITY, &mut model);
        let to_character = def.mapping().character_from_model();
        def.mapping().bodies_from_model(&model, Transform::IDENTITY, &mut bodies);
        let (mut moment, mut mass) = (Vec3::ZERO, 0.0);
        for (body, place) in def.ragdoll.bodies.iter().zip(&bodies) {
            moment += place.point(body.mass.center) * body.mass.mass;
            mass += body.mass.mass;
        }
        let center = moment / mass;
        let mut skin = self.skin.places(&model, &mut palette);
        for place in &mut skin {
            *place = to_character.point(*place);
        }
        let lowest = skin.iter().fold(f32::INFINITY, |lowest, place| min(lowest, place.y));
        skin.retain(|place| place.y <= lowest + BEARS_NEAR * def.ragdoll.height);
        self.directions.iter().fold(f32::NEG_INFINITY, |lean, &direction| {
            let reach = skin.iter().fold(f32::NEG_INFINITY, |reach, place| max(reach, place.dot(direction)));
            max(lean, center.dot(direction) - reach)
        })
    }
}
