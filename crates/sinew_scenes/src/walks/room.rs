//! Reachable positions of a walker: a flood fill over moves within the step height and slope limit, and walks along its
//! paths.

use super::{Terrain, Walker, capsule};
use sinew::math::{Transform, Vec3, min, trig};
use sinew::physics::ray::Ray;
use sinew::physics::{BodyHit, Probe, Shape, ShapeCast};
use std::collections::{BTreeMap, VecDeque};

/// Side of a cell, metres, and number of cells searched in each direction.
const CELL: f32 = 0.1;
const FAR: i32 = 12;
/// Share of the mover's step height and slope limit within which the flood fill moves.
const SHARE: f32 = 0.9;
/// Distances behind an edge, and above and below the edge, at which a tread is searched, metres.
const BEHIND_EDGE: f32 = 0.02;
const OVER_EDGE: f32 = 0.04;
/// Distance at which a position counts as reached, metres, and the largest number of steps for that.
const REACHED: f32 = 0.02;
const PATIENCE: u32 = 60;
/// Speed of the walk, m/s.
const SPEED: f32 = 1.5;

/// Positions that a walker can reach, each with the previous one.
pub struct Room {
    /// Positions of the walker's feet, metres.
    places: Vec<Vec3>,
    before: Vec<usize>,
}

impl Room {
    /// Floods the cells around standing feet. `margin` is the free space around the capsule that counts as room,
    /// metres; it must exceed the mover's own skin.
    pub fn around(on: &Terrain, feet: Vec3, margin: f32) -> Self {
        let mut room = Self { places: vec![feet], before: vec![0] };
        let mut cells = BTreeMap::from([((0, 0), 0)]);
        let mut queue = VecDeque::from([(0, 0)]);
        while let Some((x, z)) = queue.pop_front() {
            let at = cells[&(x, z)];
            for (dx, dz) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                let cell: (i32, i32) = (x + dx, z + dz);
                if cells.contains_key(&cell) || cell.0.abs() > FAR || cell.1.abs() > FAR {
                    continue;
                }
                let way = Vec3::new(dx as f32, 0.0, dz as f32) * CELL;
                if let Some(place) = step(on, room.places[at], way, margin) {
                    cells.insert(cell, room.places.len());
                    queue.push_back(cell);
                    room.places.push(place);
                    room.before.push(at);
                }
            }
        }
        room
    }

    /// Number of positions, at least 1.
    #[expect(clippy::len_without_is_empty, reason = "it always contains the start position")]
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Walks to the position that was found last.
    ///
    /// # Errors
    /// The position that the walker does not reach, and the one before that.
    pub fn walk(&self, walker: &mut dyn Walker) -> Result<(), [Vec3; 2]> {
        let mut path = vec![self.len() - 1];
        while let Some(&at) = path.last().filter(|at| **at != 0) {
            path.push(self.before[at]);
        }
        let mut last = self.places[0];
        for &index in path.iter().rev() {
            let place = self.places[index];
            for steps in 0.. {
                let way = (place - walker.feet()) * Vec3::new(1.0, 0.0, 1.0);
                if way.length() < REACHED {
                    break;
                }
                if steps == PATIENCE {
                    return Err([place, last]);
                }
                walker.step(way * (min(SPEED, way.length() * 60.0) / way.length()));
            }
            last = place;
        }
        Ok(())
    }
}

/// The position of the feet after a move by a cell; `None` without room or walkable ground.
fn step(on: &Terrain, feet: Vec3, way: Vec3, margin: f32) -> Option<Vec3> {
    let def = capsule();
    let cast = |feet: Vec3, translation: Vec3| -> Option<BodyHit> {
        let shape =
            Shape::Capsule { half_height: 0.5 * def.height - def.radius, radius: def.radius + margin };
        let center = feet + Vec3::Y * (0.5 * def.height + margin);
        let probe = Probe { shape, world_from_shape: Transform::from_translation(center) };
        on.world.query().first(&ShapeCast { probe, translation })
    };
    let least = Vec3::Y * 0.002;
    let high = Vec3::Y * (SHARE * def.step_height);
    let up = if cast(feet + least, way).is_none() {
        least
    } else {
        let is_room = cast(feet + least, high).is_none() && cast(feet + least + high, way).is_none();
        is_room.then_some(least + high)?
    };
    let down = -(up + high);
    let hit = cast(feet + up + way, down)?;
    let place = feet + up + way + down * hit.fraction;
    let steepest = trig::cos(SHARE * def.slope_limit);
    // The floor is flat, or the edge of a flat tread.
    let inward = -(hit.normal * Vec3::new(1.0, 0.0, 1.0)).normalize_or_zero();
    let looks = Ray {
        origin: hit.point + inward * BEHIND_EDGE + Vec3::Y * OVER_EDGE,
        direction: Vec3::NEG_Y * (2.0 * OVER_EDGE),
    };
    let tread = || on.world.query().accept(|body, _| body == hit.body).first(&looks);
    // A ray that begins within a solid hits it at fraction 0.
    let is_tread = || tread().is_some_and(|tread| tread.fraction > 0.0 && tread.normal.y > steepest);
    let is_low = hit.point.y - feet.y < high.y;
    (hit.normal.y > steepest || is_low && is_tread()).then_some(place)
}
