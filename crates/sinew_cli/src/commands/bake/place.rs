//! Place of the character in the world: where the user says, else on a flat place with room over it.

use super::grounds::grounds;
use sinew::math::{Rotation, Transform, Vec3};
use sinew::physics::boxes::Aabb;
use sinew::physics::ray::Ray;
use sinew::physics::{
    BodyDef, BodyHit, BodyKind, BodyKinds, OverlapWith, Probe, QueryFilter, Shape, World, WorldDef,
};

/// Cosine of the steepest ground that is walked on: 40°.
const WALKABLE: f32 = 0.766;
/// Room over a place, in heights of the character.
const FREE_HEIGHT: f32 = 1.5;
/// Room to each side, in heights of the character: to fall in, and where there is none to stand in.
const ROOMS: [f32; 2] = [1.0, 0.35];
/// Cosine of the steepest ground that counts as flat: 5°.
const FLAT: f32 = 0.996;
/// The ground of a flat place is this even, in heights of the character.
const EVEN: f32 = 0.02;
/// And this far around, in shares of the room.
const AROUND: [f32; 2] = [0.5, 0.95];
/// Height over the ground at which the room begins, in heights of the character: no pebble is in the way.
const OVER: f32 = 0.06;

/// A place and a way to face, as the user says them or as they were found.
pub struct Place {
    /// World from character.
    pub stands: Transform,
    /// True if the place was sought.
    pub found: bool,
}

/// The place that was said, or one that is sought on the world for a character of that `height`, metres; `facing` is in
/// degrees. What there is no place on is an error in a line.
pub fn place(bodies: &[BodyDef], height: f32, at: Option<Vec3>, facing: f32) -> Result<Place, String> {
    let turn = Rotation::from_axis_angle(Vec3::Y, facing.to_radians());
    let ground = Ground::new(bodies);
    let help = "--at X,Y,Z says where it stands, --floor Y adds a floor";
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
                "no flat place with {:.2} m of room over it, which the character needs; {help}",
                FREE_HEIGHT * height
            )),
        },
    }
}

/// A world to stand on.
struct Ground {
    world: World,
    /// Around all that stands and ends somewhere.
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

    /// Hits of a straight way down, the highest first.
    fn below(&self, from: Vec3, depth: f32) -> Vec<BodyHit> {
        let mut hits = Vec::new();
        let ray = Ray { origin: from, direction: Vec3::Y * -depth };
        self.world.query().filter(QueryFilter::of(BodyKinds::STATIC)).all(&ray, &mut hits);
        hits
    }

    /// True if something stands under a place, however deep.
    fn is_under(&self, at: Vec3, height: f32) -> bool {
        const DEPTH: f32 = 1000.0;
        !self.below(at + Vec3::Y * (0.5 * height), DEPTH).is_empty()
    }

    /// A flat place with room over it on the largest ground that can be walked on, near its middle; where it has none, on the next.
    /// Places with room to fall go before those with room to stand.
    fn flat_place(&self, height: f32) -> Option<Vec3> {
        let bounds = self.bounds.unwrap_or(Aabb::around(Vec3::ZERO, Vec3::splat(0.5 * height)));
        let grounds = grounds(&bounds, height, |from, depth| self.floors(from, depth, height));
        let places = |room: f32| {
            let good = move |at: &&Vec3| {
                let hits = self.below(**at + Vec3::Y * (OVER * height), 2.0 * OVER * height);
                hits.first().is_some_and(|hit| self.is_good(hit, height, room))
            };
            grounds.iter().find_map(|ground| ground.iter().find(good).copied())
        };
        ROOMS.iter().find_map(|&room| places(room))
    }

    /// Heights under a place on which one can stand: level enough, with head room.
    fn floors(&self, from: Vec3, depth: f32, height: f32) -> Vec<f32> {
        let hits = self.below(from, depth);
        let has_room = |hit: &&BodyHit| {
            let up = Ray { origin: hit.point + Vec3::Y * (OVER * height), direction: Vec3::Y * height };
            hit.start.is_none() && hit.normal.y > WALKABLE && !self.world.query().any(&up)
        };
        hits.iter().filter(has_room).map(|hit| hit.point.y).collect()
    }

    fn is_good(&self, hit: &BodyHit, height: f32, room: f32) -> bool {
        hit.start.is_none()
            && hit.normal.y > FLAT
            && self.is_even(hit.point, height, room)
            && self.is_free(hit.point, height, room)
    }

    fn is_even(&self, at: Vec3, height: f32, room: f32) -> bool {
        let diagonal = core::f32::consts::FRAC_1_SQRT_2;
        let ways = [[1.0, 0.0], [diagonal, diagonal], [0.0, 1.0], [-diagonal, diagonal]];
        let around = ways.into_iter().flat_map(|[x, z]| [Vec3::new(x, 0.0, z), Vec3::new(-x, 0.0, -z)]);
        let mut points = around.flat_map(|way| AROUND.map(|share| at + way * (share * room * height)));
        points.all(|point| {
            let hits = self.below(point + Vec3::Y * (OVER * height), 2.0 * OVER * height);
            hits.first().is_some_and(|hit| (hit.point.y - at.y).abs() < EVEN * height)
        })
    }

    fn is_free(&self, at: Vec3, height: f32, room: f32) -> bool {
        // Lines find most of what is in the way, and cost far less than a box that overlaps a mesh.
        let heart = at + Vec3::Y * (0.5 * height);
        let sides = [Vec3::X, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Z].map(|way| (heart, way * (room * height)));
        let up = (at + Vec3::Y * (OVER * height), Vec3::Y * ((FREE_HEIGHT - OVER) * height));
        let ways = sides.into_iter().chain([up]);
        if ways.into_iter().any(|(origin, direction)| self.world.query().any(&Ray { origin, direction })) {
            return false;
        }
        let half_height = 0.5 * (FREE_HEIGHT - OVER) * height;
        let half_extents = Vec3::new(room * height, half_height, room * height);
        let center = at + Vec3::Y * (OVER * height + half_height);
        !self.world.query().any(&OverlapWith(Probe::at(Shape::Box { half_extents }, center)))
    }
}

/// Three numbers, `X,Y,Z`.
pub fn point(text: &str) -> Result<Vec3, String> {
    let numbers = text.split(',').map(metres).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => Err(format!("'{text}' must be three numbers, as in 0,1.5,-2")),
    }
}

/// A height or a coordinate.
pub fn metres(text: &str) -> Result<f32, String> {
    /// Farther from the origin a millimetre is too little to be told, metres.
    const FARTHEST: f32 = 1e4;
    let number: f32 = text.trim().parse().map_err(|_| format!("'{text}' is not a number"))?;
    if number.abs() <= FARTHEST { Ok(number) } else { Err(format!("'{text}' is out of range")) }
}

/// A turn, degrees.
pub fn degrees(text: &str) -> Result<f32, String> {
    let number: f32 = text.trim().parse().map_err(|_| format!("'{text}' is not a number"))?;
    if number.abs() <= 360.0 { Ok(number) } else { Err("must lie between -360 and 360".to_owned()) }
}
