//! Random worlds of every kind of shape.

use sinew_math::{Random, Rotation, Transform, Vec3};
use sinew_physics::{
    BodyDef, BodyId, BodyKind, BodyKinds, Filter, QueryFilter, Sensing, Sensors, Shape, ShapeDef, ShapeId,
    World, WorldDef,
};

/// Number of kinds of bounded shapes.
pub const KINDS: usize = 7;

/// Returns a bounded shape of a kind, about 1 m across, around its origin.
pub fn shape(kind: usize, random: &mut Random) -> Shape {
    let mut size = || random.range(0.15, 0.8);
    match kind {
        0 => Shape::Box { half_extents: Vec3::new(size(), size(), size()) },
        1 => Shape::Sphere { radius: size() },
        2 => Shape::Capsule { half_height: size(), radius: 0.5 * size() },
        3 => Shape::Capsule { half_height: 0.0, radius: size() },
        4 => {
            Shape::TaperedCapsule { half_height: 0.4, radius_bottom: 0.8 * size(), radius_top: 0.8 * size() }
        }
        5 => Shape::Cylinder { half_height: size(), radius: size() },
        _ => Shape::Cone { half_height: size(), radius: size() },
    }
}

pub fn frame(spread: f32, random: &mut Random) -> Transform {
    Transform::new(random.in_cube() * spread, random.rotation())
}

/// Returns a body of up to three shapes of all kinds, with filters and sensors.
pub fn body(spread: f32, random: &mut Random) -> BodyDef {
    let at = frame(spread, random);
    let count = 1 + random.index(3);
    let shapes = (0..count).map(|_| {
        let kind = random.index(KINDS);
        ShapeDef {
            body_from_shape: frame(0.5, random),
            filter: Filter { layers: 1 << random.index(3), mask: 1 | random.bits() as u32, group: 0 },
            sensing: if random.index(4) == 0 { Sensing::Sensor } else { Sensing::Solid },
            ..ShapeDef::new(shape(kind, random))
        }
    });
    let shapes = shapes.collect();
    let kind = [BodyKind::Static, BodyKind::Kinematic, BodyKind::Dynamic][random.index(3)];
    BodyDef { kind, position: at.translation, rotation: at.rotation, shapes, ..BodyDef::default() }
}

/// A world, and the definitions of its bodies.
pub struct Populated {
    pub world: World,
    pub bodies: Vec<(BodyId, BodyDef)>,
}

impl Populated {
    /// Returns a world with this many bodies in a cube of side `2 spread` above a slope. Some of them have been removed
    /// and replaced.
    pub fn new(bodies: usize, spread: f32, random: &mut Random) -> Self {
        let mut populated = Self { world: World::new(WorldDef::default()), bodies: Vec::new() };
        populated.add(BodyDef {
            kind: BodyKind::Static,
            position: Vec3::Y * -spread,
            rotation: Rotation::from_scaled_axis(random.in_cube() * 0.3),
            shapes: vec![ShapeDef::new(Shape::HalfSpace)],
            ..BodyDef::default()
        });
        for _ in 0..bodies {
            populated.add(body(spread, random));
            if random.index(6) == 0 {
                populated.remove(random);
            }
        }
        populated
    }

    pub fn add(&mut self, def: BodyDef) -> BodyId {
        let id = self.world.add_body(&def);
        self.bodies.push((id, def));
        id
    }

    /// Removes a random body.
    pub fn remove(&mut self, random: &mut Random) {
        let (id, _) = self.bodies.swap_remove(random.index(self.bodies.len()));
        self.world.remove_body(id);
    }

    /// Iterates over every shape that passes the filter, with its current pose.
    pub fn shapes(&self, filter: &QueryFilter<'_>) -> impl Iterator<Item = (ShapeId, Shape, Transform)> {
        self.bodies.iter().flat_map(move |(id, def)| {
            let passes = move |def: &BodyDef, shape: usize| {
                let ShapeDef { filter: own, sensing, .. } = def.shapes[shape];
                let met = filter.meets.layers & own.mask != 0 && own.layers & filter.meets.mask != 0;
                filter.kinds.contains(def.kind)
                    && (sensing == Sensing::Solid || filter.sensors == Sensors::Included)
                    && met
                    && !filter.except.contains(id)
            };
            let numbered = self.world.shapes(*id).enumerate();
            numbered.filter(move |(shape, _)| passes(def, *shape)).map(move |(number, (shape, frame))| {
                (ShapeId { body: *id, shape: number as u32 }, shape, frame)
            })
        })
    }
}

/// Returns a filter that passes about half of the shapes.
pub fn filter<'a>(except: &'a [BodyId], random: &mut Random) -> QueryFilter<'a> {
    let kinds = [BodyKinds::ALL, BodyKinds::STATIC | BodyKinds::DYNAMIC, BodyKinds::KINEMATIC];
    QueryFilter {
        meets: Filter { layers: 1 + random.index(7) as u32, mask: 1 + random.index(7) as u32, group: 0 },
        kinds: kinds[random.index(3)],
        sensors: [Sensors::Ignored, Sensors::Included][random.index(2)],
        except,
    }
}
