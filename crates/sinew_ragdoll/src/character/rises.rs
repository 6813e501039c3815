//! Ground under the parts of a character in a transition, where the ground differs from the floor of the clips: stairs,
//! crates, slopes. If only the clips' floor counted, hands and knees would pass through a step beside the body.

use super::clearance::{Clearance, Depths, PARTS, Passage, spread};
use super::figure::Figure;
use super::legs::follow;
use super::{CharacterDef, ground};
use crate::character::tuning::{LEAST_TREAD, PART_QUICKNESS, PART_SEARCH, PROBES_APART};
use sinew_anim::{LocalTransform, local_to_model};
use sinew_math::{Affine, Vec3, max};
use sinew_physics::{BodyId, World};

/// Largest number of points of a part below which the ground is searched.
const MOST_PROBES: usize = 4;

/// World in which the ground is searched.
#[derive(Clone, Copy)]
pub(super) struct Grounds<'a> {
    pub world: &'a World,
    /// Bodies of the character, if it is in the world.
    pub own: Option<&'a [BodyId]>,
}

impl Grounds<'_> {
    /// Returns two sets of depths of a pose's parts: in the floor of the character's transform, and in the ground below
    /// each part.
    pub fn depths(
        self,
        def: &CharacterDef,
        figure: &Figure,
        pose: &[LocalTransform],
        model: &mut Vec<Affine>,
    ) -> [Depths; 2] {
        local_to_model(&def.rig, pose, &def.mapping().character_from_model(), model);
        let clearance = def.clearance();
        let mut both = [[f32::NEG_INFINITY; PARTS]; 2];
        let mut palette = Vec::new();
        for part in 0..PARTS {
            let points = clearance.low_points(part, model, PROBES_APART * def.ragdoll.height, &mut palette);
            let Some(lowest) = points.first() else { continue };
            let ground =
                points.iter().map(|&point| self.depth(def, figure.place.point(point)).unwrap_or(-point.y));
            both[0][part] = -lowest.y;
            both[1][part] = ground.reduce(max).unwrap_or(-lowest.y);
        }
        both
    }

    /// Returns the depth of a point in the ground below it.
    fn depth(self, def: &CharacterDef, point: Vec3) -> Option<f32> {
        let above = PART_SEARCH * def.ragdoll.height;
        let least = LEAST_TREAD * def.ragdoll.total_mass;
        Some(ground::firm_below(self.world, point, above, self.own, least)? - point.y)
    }
}

impl Passage {
    /// Advances the heights of the ground under the parts of a pose by a step.
    pub fn follow_ground(
        &mut self,
        def: &CharacterDef,
        figure: &Figure,
        grounds: Grounds<'_>,
        model: &mut Vec<Affine>,
    ) {
        let [floor, ground] = grounds.depths(def, figure, &figure.pose, model);
        let dt = grounds.world.def().dt();
        for part in (0..PARTS).filter(|&part| floor[part] > f32::NEG_INFINITY) {
            let rise = ground[part] - floor[part];
            if self.age == 0.0 {
                (self.rises[part], self.rise_rates[part]) = (rise, 0.0);
            } else {
                follow(&mut self.rises[part], &mut self.rise_rates[part], rise, PART_QUICKNESS, dt);
            }
        }
    }
}

impl Clearance {
    /// Returns the lowest points of a part that are at least `apart` metres from each other, the lowest one first;
    /// `model` and the points are in the same space.
    fn low_points(&self, part: usize, model: &[Affine], apart: f32, palette: &mut Vec<Affine>) -> Vec<Vec3> {
        spread(self.places(part, model, palette), apart, MOST_PROBES, |place| -place.y)
    }
}
