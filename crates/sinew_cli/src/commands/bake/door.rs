//! Finds doors in a world: openings from the ground up with a lintel. Their height implies the size of a character.

use sinew::math::{Vec3, min};
use sinew::physics::boxes::Aabb;
use sinew::physics::ray::Ray;
use sinew::physics::{BodyDef, BodyHit, BodyKind, BodyKinds, QueryFilter, Shape, World, WorldDef};

/// Number of sample positions on each side of the centre.
const PLACES: i32 = 6;
/// Spacing of sample heights, as a share of the room's height.
const LEVELS: u8 = 24;
/// Door heights, as shares of the room's height.
const DOORS: core::ops::Range<f32> = 0.5..0.97;
/// Smallest free depth behind a door, and largest distance of the door's wall, in room heights.
const BEHIND: f32 = 0.3;
const FARTHEST: f32 = 4.0;
/// Largest distance of two wall hits over a door from one plane, as a share of the room's height.
const EVEN: f32 = 0.05;
/// Plausible heights of rooms, metres.
const ROOMS: core::ops::Range<f32> = 0.3..60.0;

/// Returns the median free height of the doors of a world, metres; `None` without doors.
pub fn door(bodies: &[BodyDef]) -> Option<f32> {
    let mut world = World::new(WorldDef::default());
    let mut bounds: Option<Aabb> = None;
    for body in bodies.iter().filter(|body| body.kind == BodyKind::Static) {
        let ends = body.shapes.iter().all(|shape| shape.shape != Shape::HalfSpace);
        let id = world.add_body(body);
        if ends && !body.shapes.is_empty() {
            let own = world.bounds(id);
            bounds = Some(bounds.map_or(own, |all| all.merge(&own)));
        }
    }
    let rays = Rays { world };
    let bounds = bounds?;
    let (middle, half) = (bounds.center(), (bounds.max - bounds.min) * 0.5);
    let mut heights = Vec::new();
    for (i, j) in (-PLACES..=PLACES).flat_map(|i| (-PLACES..=PLACES).map(move |j| (i, j))) {
        let step = Vec3::new(half.x * i as f32, 0.0, half.z * j as f32) * (0.95 / PLACES as f32);
        let top = middle + step + Vec3::Y * (half.y + 1.0);
        for floor in rays.all(top, Vec3::Y * -(2.0 * half.y + 2.0)) {
            heights.extend(rays.doors_around(floor.point));
        }
    }
    heights.sort_by(f32::total_cmp);
    heights.get(heights.len() / 2).copied()
}

struct Rays {
    world: World,
}

impl Rays {
    fn all(&self, origin: Vec3, direction: Vec3) -> Vec<BodyHit> {
        let mut hits = Vec::new();
        self.world
            .query()
            .filter(QueryFilter::of(BodyKinds::STATIC))
            .all(&Ray { origin, direction }, &mut hits);
        hits
    }

    /// Returns the free distance from a position along `direction`, at most its length.
    fn way(&self, origin: Vec3, direction: Vec3) -> f32 {
        let hits = self.all(origin, direction);
        hits.iter().map(|hit| (hit.point - origin).length()).fold(direction.length(), min)
    }

    /// Returns the free heights of the doors visible from a ground position in a room.
    fn doors_around(&self, ground: Vec3) -> Vec<f32> {
        let from = ground + Vec3::Y * 0.01;
        let room = self.way(from, Vec3::Y * ROOMS.end) + 0.01;
        if !ROOMS.contains(&room) || room >= ROOMS.end {
            return Vec::new();
        }
        [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z]
            .into_iter()
            .filter_map(|way| self.door(ground, way, room))
            .collect()
    }

    /// Returns the free height of a door: free rays from the ground up to a lintel, then one wall up to the
    /// ceiling.
    fn door(&self, ground: Vec3, toward: Vec3, room: f32) -> Option<f32> {
        let levels: Vec<f32> = (1..LEVELS).map(|level| room * f32::from(level) / f32::from(LEVELS)).collect();
        let see = |&level: &f32| self.way(ground + Vec3::Y * level, toward * (FARTHEST * room));
        let highest = see(levels.last()?);
        if highest >= FARTHEST * room {
            return None;
        }
        let is_wall = |way: f32| (way - highest).abs() < EVEN * room;
        let is_free = |way: f32| way > highest + BEHIND * room;
        let ways: Vec<f32> = levels.iter().map(see).collect();
        let lintel = ways.iter().position(|&way| is_wall(way))?;
        let is_door = lintel > 0
            && ways[..lintel].iter().all(|&way| is_free(way))
            && ways[lintel..].iter().all(|&way| is_wall(way));
        // The lower edge of the lintel, if a ray finds it between the last free height and the first height at the
        // wall; else half-way between them.
        let inside = ground + Vec3::Y * 0.01 + toward * (highest + 0.02 * room);
        let height = self.way(inside, Vec3::Y * room) + 0.01;
        let between = [levels[lintel.saturating_sub(1)], levels[lintel]];
        let height = if (between[0]..=between[1]).contains(&height) {
            height
        } else {
            0.5 * (between[0] + between[1])
        };
        (is_door && DOORS.contains(&(height / room))).then_some(height)
    }
}
