//! Ground of the walks: static bodies, and queries about them.

use super::capsule;
use crate::cabin::Site;
use sinew::formats::TriangleMesh;
use sinew::math::{Random, Rotation, Transform, Vec3};
use sinew::physics::boxes::Aabb;
use sinew::physics::ray::Ray;
use sinew::physics::{BodyDef, Hull, OverlapWith, PenetrationOf, Probe, Shape, World, WorldDef};

/// Static bodies to walk among.
pub struct Terrain {
    /// All bodies.
    pub bodies: Vec<BodyDef>,
    /// World with these bodies, for queries.
    pub(super) world: World,
    /// Triangles of the bodies' meshes, which are solid from the front only.
    triangles: Vec<[Vec3; 3]>,
    /// Box in which walks begin, world, metres.
    within: Aabb,
}

fn corners(mesh: &TriangleMesh, world_from_mesh: &Transform) -> Vec<[Vec3; 3]> {
    let at = |corner: u32| world_from_mesh.point(mesh.positions[corner as usize]);
    mesh.triangles.iter().map(|triangle| triangle.map(at)).collect()
}

fn level(mesh: &TriangleMesh, world_from_mesh: Transform) -> BodyDef {
    let body = mesh.to_body().expect("the mesh has triangles");
    BodyDef { position: world_from_mesh.translation, rotation: world_from_mesh.rotation, ..body }
}

impl Terrain {
    fn new(bodies: Vec<BodyDef>, triangles: Vec<[Vec3; 3]>, within: [Vec3; 2]) -> Self {
        let [min, max] = within;
        let world = build(&bodies);
        Self { bodies, world, triangles, within: Aabb { min, max } }
    }

    /// The demo's cabin, with its stairs and its porch.
    pub fn cabin() -> Self {
        let bodies = Site::CabinWithStairs.props().into_iter().map(|prop| prop.body).collect();
        Self::new(bodies, Vec::new(), [Vec3::new(-4.0, 0.05, -8.0), Vec3::new(4.0, 3.0, 4.0)])
    }

    /// A mesh on a floor.
    ///
    /// # Panics
    /// If the mesh has no triangle with an area.
    pub fn house(mesh: &TriangleMesh) -> Self {
        let [low, high] =
            mesh.positions.iter().fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], &p| {
                [sinew::math::min3(low, p), sinew::math::max3(high, p)]
            });
        let bodies = vec![BodyDef::fixed(Shape::HalfSpace), level(mesh, Transform::IDENTITY)];
        Self::new(bodies, corners(mesh, &Transform::IDENTITY), [Vec3::new(low.x, 0.05, low.z), high])
    }

    /// Stairs among four oblique walls.
    ///
    /// # Panics
    /// If a mesh has no triangle with an area.
    pub fn dungeon(stairs: &TriangleMesh, wall: &TriangleMesh) -> Self {
        let mut bodies = vec![BodyDef::fixed(Shape::HalfSpace), level(stairs, Transform::IDENTITY)];
        let mut triangles = corners(stairs, &Transform::IDENTITY);
        for (turn, x, z) in [(0.0, 0.0, -5.0), (0.0, 3.0, 5.0), (1.6, -4.0, 0.0), (0.7, 4.0, 1.0)] {
            let turned = Rotation::from_axis_angle(Vec3::Y, turn);
            let world_from_wall = Transform::new(Vec3::new(x, 0.0, z), turned);
            triangles.extend(corners(wall, &world_from_wall));
            bodies.push(level(wall, world_from_wall));
        }
        Self::new(bodies, triangles, [Vec3::new(-6.0, 0.05, -6.0), Vec3::new(6.0, 3.0, 6.0)])
    }

    /// Forty randomly rotated solids, half in the floor or in the air, within four walls.
    pub fn clutter(seed: u64) -> Self {
        const HALF: f32 = 6.0;
        let random = &mut Random::new(seed);
        let mut bodies = vec![BodyDef::fixed(Shape::HalfSpace)];
        for (x, z) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let along = |share: f32| if share == 0.0 { HALF + 1.0 } else { 0.5 };
            let half_extents = Vec3::new(along(x), 4.0, along(z));
            let at = Vec3::new(x, 0.0, z) * (HALF + 0.5);
            bodies.push(BodyDef::fixed(Shape::Box { half_extents }).at(at));
        }
        for kind in 0..40 {
            let shape = solid(kind, random);
            let mut place = || random.range(-HALF, HALF);
            let (x, z) = (place(), place());
            let mut def = BodyDef::fixed(shape).at(Vec3::new(x, random.range(0.0, 1.5), z));
            def.rotation = random.rotation();
            bodies.push(def);
        }
        Self::new(bodies, Vec::new(), [Vec3::new(-5.5, 0.05, -5.5), Vec3::new(5.5, 2.5, 5.5)])
    }

    /// A step of `height` metres across +x, with its edge at the origin.
    pub fn tread(height: f32) -> Self {
        let half_extents = Vec3::new(5.0, 0.5 * height, 20.0);
        let tread = BodyDef::fixed(Shape::Box { half_extents }).at(Vec3::new(5.0, 0.5 * height, 0.0));
        let bodies = vec![BodyDef::fixed(Shape::HalfSpace), tread];
        Self::new(bodies, Vec::new(), [Vec3::new(-5.0, 0.05, -5.0), Vec3::new(-1.0, 1.0, 5.0)])
    }

    /// Builds a world of these bodies.
    pub fn build(&self) -> World {
        build(&self.bodies)
    }

    /// Returns a random position for the feet of the walks' capsule, with room around it.
    pub fn free_place(&self, random: &mut Random) -> Vec3 {
        loop {
            let mut between = |axis: usize| random.range(self.within.min[axis], self.within.max[axis]);
            let feet = Vec3::new(between(0), between(1), between(2));
            let is_free = !self.world.query().any(&OverlapWith(probe(feet, 0.02)));
            if is_free && self.is_in_front(probe(feet, 0.0).world_from_shape.translation) {
                return feet;
            }
        }
    }

    /// Largest depth of the capsule in a body, metres; 0 if the capsule is outside of all.
    pub fn depth(&self, feet: Vec3) -> f32 {
        let mut found = Vec::new();
        self.world.query().all(&PenetrationOf(probe(feet, 0.0)), &mut found);
        found.first().map_or(0.0, |deepest| deepest.depth)
    }

    /// Returns true if a body is between the axes of the capsule at two positions.
    pub(super) fn parts(&self, before: Vec3, now: Vec3) -> bool {
        let middle = Vec3::Y * (0.5 * capsule().height);
        let blocked = |over: Vec3| {
            let ray = Ray { origin: before + over, direction: now - before };
            self.world.query().any(&ray)
        };
        blocked(middle) && blocked(middle + Vec3::Y * 0.4)
    }

    /// Returns true if the nearest surface in every direction faces the point.
    fn is_in_front(&self, point: Vec3) -> bool {
        let mut random = Random::new(1);
        let mut direction = || random.rotation() * Vec3::X;
        (0..60).all(|_| {
            let way = direction();
            let meets = |&[a, b, c]: &[Vec3; 3]| {
                let (ab, ac, from) = (b - a, c - a, point - a);
                let across = way.cross(ac);
                let span = ab.dot(across);
                let u = from.dot(across) / span;
                let along = from.cross(ab);
                let (v, t) = (way.dot(along) / span, ac.dot(along) / span);
                (span != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some((t, span > 0.0))
            };
            let hits = self.triangles.iter().filter_map(meets);
            hits.min_by(|a, b| a.0.total_cmp(&b.0)).is_none_or(|(_, in_front)| in_front)
        })
    }
}

fn build(bodies: &[BodyDef]) -> World {
    let mut world = World::new(WorldDef::default());
    for body in bodies {
        world.add_body(body);
    }
    world
}

fn probe(feet: Vec3, margin: f32) -> Probe {
    let def = capsule();
    let shape = Shape::Capsule { half_height: 0.5 * def.height - def.radius, radius: def.radius + margin };
    Probe { shape, world_from_shape: Transform::from_translation(feet + Vec3::Y * (0.5 * def.height)) }
}

/// Returns a solid of random size: by `kind` a box, a cylinder, a capsule or a hull.
fn solid(kind: u32, random: &mut Random) -> Shape {
    let size = random.range(0.1, 1.2);
    let mut length = || size * random.range(0.2, 1.0);
    let (a, b, c) = (length(), length(), length());
    match kind % 4 {
        0 => Shape::Box { half_extents: Vec3::new(a, b, c) },
        1 => Shape::Cylinder { half_height: a, radius: b },
        2 => Shape::Capsule { half_height: a, radius: b },
        _ => {
            let points: Vec<Vec3> = (0..12).map(|_| (random.rotation() * Vec3::X) * size).collect();
            Shape::Hull(Hull::new(&points).expect("random points span a solid").into())
        }
    }
}
