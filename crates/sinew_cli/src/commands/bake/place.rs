//! Position of the character in the world: the user's, else a flat position with free space above.

use super::grounds::grounds;
use sinew::math::{Rotation, Transform, Vec3, max};
use sinew::physics::boxes::Aabb;
use sinew::physics::ray::Ray;
use sinew::physics::{
    BodyDef, BodyHit, BodyKind, BodyKinds, OverlapWith, Probe, QueryFilter, Shape, World, WorldDef,
};

/// Cosine of the steepest walkable slope: 40°.
const WALKABLE: f32 = 0.766;
/// Requirements for a position, in heights of the character.
struct Demand {
    /// Free distance on each side, for falling or for standing.
    room: f32,
    /// Free height over the position.
    over: f32,
    /// Least cosine of the ground's slope.
    level: f32,
    /// Largest unevenness of the ground around.
    even: f32,
}

/// Requirements from best to worst: flat ground (5°) with space to fall, with space to stand, under a low ceiling, and
/// on a slope (20°).
const DEMANDS: [Demand; 4] = [
    Demand { room: 1.0, over: 1.5, level: 0.996, even: 0.02 },
    Demand { room: 0.35, over: 1.5, level: 0.996, even: 0.02 },
    Demand { room: 0.35, over: LEAST_OVER, level: 0.996, even: 0.02 },
    Demand { room: 0.35, over: LEAST_OVER, level: 0.94, even: 0.12 },
];
/// Least free height over a position, in heights of the character.
const LEAST_OVER: f32 = 1.15;
/// Radius of even ground around a position, as a share of the free space.
const AROUND: [f32; 2] = [0.5, 0.95];
/// Height over the ground where the free space starts, in heights of the character: ignores pebbles.
const OVER: f32 = 0.06;

/// Largest number of surfaces in a column.
const MOST_SURFACES: usize = 32;
/// Least distance of two surfaces, metres.
const SURFACE_GAP: f32 = 1e-3;

/// A position and a facing, given or found.
pub struct Place {
    /// Transform from the character to the world.
    pub stands: Transform,
    /// True if the position was searched.
    pub found: bool,
}

/// Returns the given position, or one searched in the world for a character of that `height`, metres; `facing` is in
/// degrees. If there is none, returns a one-line error.
pub fn place(bodies: &[BodyDef], height: f32, at: Option<Vec3>, facing: f32) -> Result<Place, String> {
    let turn = Rotation::from_axis_angle(Vec3::Y, facing.to_radians());
    let ground = Ground::new(bodies);
    let help = "--at X,Y,Z sets its place, --floor Y adds a floor";
    match at {
        Some(at) if ground.is_under(at, height) => {
            Ok(Place { stands: Transform::new(at, turn), found: false })
        }
        Some(at) => {
            let [x, y, z] = at.to_array();
            Err(format!("no ground under the character at {x},{y},{z}; --floor Y adds one"))
        }
        None => match ground.flat_place(height) {
            Some(at) => Ok(Place { stands: Transform::new(at, turn), found: true }),
            None if ground.is_empty() => Err(format!("no ground to stand on; {help}")),
            None => Err(format!(
                "no place level enough to stand on with {:.2} m of room over it, which the character needs; {help}",
                LEAST_OVER * height
            )),
        },
    }
}

/// A world with bodies to stand on.
struct Ground {
    world: World,
    /// Bounds of all finite static bodies.
    bounds: Option<Aabb>,
}

impl Ground {
    fn new(bodies: &[BodyDef]) -> Self {
        let mut world = World::new(WorldDef::default());
        let mut bounds: Option<Aabb> = None;
        for body in bodies {
            let ends = body.shapes.iter().all(|shape| shape.shape != Shape::HalfSpace);
            let id = world.add_body(body);
            if body.kind == BodyKind::Static && ends && !body.shapes.is_empty() {
                let own = world.bounds(id);
                bounds = Some(bounds.map_or(own, |all| all.merge(&own)));
            }
        }
        Self { world, bounds }
    }

    fn is_empty(&self) -> bool {
        let stands = |id| self.world.kind(id) == BodyKind::Static && self.world.shapes(id).next().is_some();
        !self.world.body_ids().any(stands)
    }

    /// Returns the surfaces below a position, the highest first; a mesh may have several.
    fn below(&self, from: Vec3, depth: f32) -> Vec<BodyHit> {
        let (mut surfaces, mut hits) = (Vec::new(), Vec::new());
        let mut origin = from;
        while surfaces.len() < MOST_SURFACES {
            let ray = Ray { origin, direction: Vec3::Y * (from.y - depth - origin.y) };
            hits.clear();
            self.world.query().filter(QueryFilter::of(BodyKinds::STATIC)).all(&ray, &mut hits);
            // The ray may begin within the body of the last surface.
            let Some(hit) = hits.iter().find(|hit| hit.start.is_none()) else { break };
            origin.y = hit.point.y - SURFACE_GAP;
            surfaces.push(*hit);
        }
        surfaces
    }

    /// Returns true if there is ground below a position at any depth.
    fn is_under(&self, at: Vec3, height: f32) -> bool {
        const DEPTH: f32 = 1000.0;
        !self.below(at + Vec3::Y * (0.5 * height), DEPTH).is_empty()
    }

    /// Returns a flat position with free space above, near the centre of the largest walkable ground; if that has
    /// none, on the next one. Main grounds come first, and among them positions that meet more [demands](DEMANDS).
    fn flat_place(&self, height: f32) -> Option<Vec3> {
        let bounds = self.bounds.unwrap_or(Aabb::around(Vec3::ZERO, Vec3::splat(0.5 * height)));
        let grounds = grounds(&bounds, height, |from, depth| self.floors(from, depth, height));
        let place = |is_main: bool, demand: &Demand| {
            let good = move |at: &&Vec3| {
                let hits = self.below(**at + Vec3::Y * (OVER * height), 2.0 * OVER * height);
                hits.first().is_some_and(|hit| self.is_good(hit, height, demand))
            };
            let grounds = grounds.iter().filter(|ground| ground.is_main == is_main);
            grounds.into_iter().find_map(|ground| ground.places.iter().find(good).copied())
        };
        [true, false].into_iter().find_map(|is_main| DEMANDS.iter().find_map(|demand| place(is_main, demand)))
    }

    /// Returns the walkable heights below a position: level enough, with head room.
    fn floors(&self, from: Vec3, depth: f32, height: f32) -> Vec<f32> {
        let hits = self.below(from, depth);
        let has_room = |hit: &&BodyHit| {
            let over = |other: &BodyHit| other.point.y - hit.point.y;
            let is_covered = hits.iter().any(|other| over(other) > 0.0 && over(other) < height);
            let up = Ray { origin: hit.point + Vec3::Y * (OVER * height), direction: Vec3::Y * height };
            let is_walkable = hit.start.is_none() && hit.normal.y > WALKABLE;
            is_walkable && !is_covered && !self.world.query().any(&up)
        };
        hits.iter().filter(has_room).map(|hit| hit.point.y).collect()
    }

    fn is_good(&self, hit: &BodyHit, height: f32, demand: &Demand) -> bool {
        hit.start.is_none()
            && hit.normal.y > demand.level
            && self.is_even(hit.point, height, demand)
            && self.is_free(hit.point, height, demand)
    }

    fn is_even(&self, at: Vec3, height: f32, demand: &Demand) -> bool {
        let diagonal = core::f32::consts::FRAC_1_SQRT_2;
        let ways = [[1.0, 0.0], [diagonal, diagonal], [0.0, 1.0], [-diagonal, diagonal]];
        let around = ways.into_iter().flat_map(|[x, z]| [Vec3::new(x, 0.0, z), Vec3::new(-x, 0.0, -z)]);
        let mut points = around.flat_map(|way| AROUND.map(|share| at + way * (share * demand.room * height)));
        points.all(|point| {
            let reach = max(OVER, demand.even) * height;
            let hits = self.below(point + Vec3::Y * reach, 2.0 * reach);
            hits.first().is_some_and(|hit| (hit.point.y - at.y).abs() < demand.even * height)
        })
    }

    fn is_free(&self, at: Vec3, height: f32, demand: &Demand) -> bool {
        // Rising ground around the position is no obstacle.
        let (room, begins) = (demand.room, max(OVER, demand.even));
        // Rays find most obstacles, and cost far less than a box overlap with a mesh.
        let heart = at + Vec3::Y * (0.5 * height);
        let sides = [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z].map(|way| (heart, way * (room * height)));
        let up = (at + Vec3::Y * (begins * height), Vec3::Y * ((demand.over - begins) * height));
        let ways = sides.into_iter().chain([up]);
        if ways.into_iter().any(|(origin, direction)| self.world.query().any(&Ray { origin, direction })) {
            return false;
        }
        let half_height = 0.5 * (demand.over - begins) * height;
        let half_extents = Vec3::new(room * height, half_height, room * height);
        let center = at + Vec3::Y * (begins * height + half_height);
        !self.world.query().any(&OverlapWith(Probe::at(Shape::Box { half_extents }, center)))
    }
}

/// Parses three numbers, `X,Y,Z`.
pub fn point(text: &str) -> Result<Vec3, String> {
    let numbers = text.split(',').map(metres).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => Err(format!("'{text}' must be three numbers, as in 0,1.5,-2")),
    }
}

/// Parses a height or a coordinate, metres.
pub fn metres(text: &str) -> Result<f32, String> {
    /// Largest distance from the origin at which f32 resolves a millimetre, metres.
    const FARTHEST: f32 = 1e4;
    let number: f32 = text.trim().parse().map_err(|_| format!("'{text}' is not a number"))?;
    if number.abs() <= FARTHEST { Ok(number) } else { Err(format!("'{text}' is out of range")) }
}

/// Parses a rotation, degrees.
pub fn degrees(text: &str) -> Result<f32, String> {
    let number: f32 = text.trim().parse().map_err(|_| format!("'{text}' is not a number"))?;
    if number.abs() <= 360.0 { Ok(number) } else { Err("must lie between -360 and 360".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::physics::{Mesh, ShapeDef};
    use std::sync::Arc;

    fn slab(half_extents: Vec3, position: Vec3, rotation: Rotation) -> BodyDef {
        let shapes = vec![ShapeDef::new(Shape::Box { half_extents })];
        BodyDef { kind: BodyKind::Static, position, rotation, shapes, ..BodyDef::default() }
    }

    /// A house of one mesh: a roof with a hidden sheet below it, and a floor with less room around than the roof has.
    #[test]
    fn floor_of_a_mesh_comes_before_its_roof() {
        let level = |y: f32| [-4.0, 4.0].map(|x| [-4.0, 4.0].map(|z| Vec3::new(x, y, z))).concat();
        let vertices = [level(3.0), level(2.95), level(0.0)].concat();
        let sides = |first: u32| [[first, first + 1, first + 3], [first, first + 3, first + 2]];
        let triangles = [sides(0), sides(4), sides(8)].concat();
        let mesh = Mesh::new(&vertices, &triangles).expect("the mesh is valid");
        let walls =
            [-1.2, 1.2].map(|x| slab(Vec3::new(0.1, 1.4, 4.0), Vec3::new(x, 1.4, 0.0), Rotation::IDENTITY));
        let house = BodyDef::fixed(Shape::Mesh(Arc::new(mesh)));
        let bodies: Vec<BodyDef> = walls.into_iter().chain([house]).collect();
        let found = place(&bodies, 1.75, None, 0.0).expect("a position must be found");
        assert!(
            found.stands.translation.y.abs() < 0.01,
            "the position must be on the floor: {}",
            found.stands.translation
        );
    }

    /// A room whose ceiling is 1.3 heights above its floor, without ground above it.
    #[test]
    fn room_with_a_low_ceiling_is_accepted() {
        let over = 1.3 * 2.0;
        let comb = (0..40).map(|tooth| {
            let half_height = if tooth % 2 == 0 { 0.5 } else { 1.5 };
            let at = Vec3::new(-3.9 + 0.2 * tooth as f32, over + half_height, 0.0);
            slab(Vec3::new(0.1, half_height, 4.0), at, Rotation::IDENTITY)
        });
        let floor = slab(Vec3::new(4.0, 0.1, 4.0), Vec3::Y * -0.1, Rotation::IDENTITY);
        let bodies: Vec<BodyDef> = comb.chain([floor]).collect();
        let found = place(&bodies, 2.0, None, 0.0).expect("a position must be found");
        assert!(
            found.stands.translation.y.abs() < 0.01,
            "the position must be on the floor: {}",
            found.stands.translation
        );
        assert!(place(&bodies, 2.6, None, 0.0).is_err(), "a character taller than the room must be refused");
    }

    #[test]
    fn slope_is_chosen_without_flatter_ground() {
        let field = |degrees: f32| {
            let turn = Rotation::from_axis_angle(Vec3::X, degrees.to_radians());
            vec![slab(Vec3::new(10.0, 0.5, 10.0), Vec3::ZERO, turn)]
        };
        assert!(place(&field(15.0), 1.8, None, 0.0).is_ok());
        assert!(place(&field(35.0), 1.8, None, 0.0).is_err());
    }
}
