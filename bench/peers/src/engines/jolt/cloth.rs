//! Cloth as a soft body of Jolt.

use super::{body, from_vector, new_world, refused, shapes::shape, step, vector};
use crate::engine::{ClothSimulation, ParticleState, Unsupported};
use crate::scenes::ClothScene;
use oxijolt::{
    BodyId, CollisionLayers, PhysicsWorld, SoftBodyBendType, SoftBodySettings, SoftBodySharedSettings,
    SoftBodyVertex, SoftBodyVertexAttributes, SoftBodyVertexState,
};
use sinew::math::Vec3;
use sinew::physics::Sleeping;

/// Compliance of all links of the cloth, m/N. With the 1e-5 of Jolt's samples, made for particles of 1 kg, this cloth of 2 g
/// particles explodes at its first contact.
const COMPLIANCE: f32 = 5e-3;

/// Builds the scene with 5 iterations, Jolt's default.
pub fn build(scene: &ClothScene) -> Result<Box<dyn ClothSimulation>, Unsupported> {
    let obstacles = scene.obstacles();
    let gravity = Vec3::new(0.0, -9.81, 0.0);
    let mut world = new_world(gravity, obstacles.len() + 1, CollisionLayers::default())?;
    for obstacle in &obstacles {
        world.create_body(&shape(obstacle)?, &body(obstacle, Sleeping::Off)?).map_err(refused)?;
    }
    let settings = SoftBodySettings::default()
        .linear_damping(scene.damping)
        .friction(scene.friction)
        .vertex_radius(scene.particle_radius)
        .allow_sleeping(false);
    let cloth = world.create_soft_body(&links(scene)?, &settings).map_err(refused)?;
    Ok(Box::new(JoltCloth { world, cloth }))
}

/// Returns Jolt's own links for a sheet of triangles: edges, shear along both diagonals, and distances over every edge that two
/// triangles share (58,806 in all).
fn links(scene: &ClothScene) -> Result<SoftBodySharedSettings, Unsupported> {
    let pinned = scene.pinned();
    let places = (0..scene.side).flat_map(|row| (0..scene.side).map(move |column| (row, column)));
    let vertices = places
        .map(|(row, column)| {
            let vertex = SoftBodyVertex::new(vector(scene.position(row, column)));
            let is_pinned = pinned.contains(&scene.index(row, column));
            SoftBodyVertex { inverse_mass: if is_pinned { 0.0 } else { 1.0 / scene.particle_mass }, ..vertex }
        })
        .collect();
    let cells = (1..scene.side).flat_map(|row| (1..scene.side).map(move |column| (row, column)));
    let faces = cells
        .flat_map(|(row, column)| {
            let corner = |r: usize, c: usize| scene.index(row - r, column - c) as u32;
            [[corner(1, 1), corner(0, 1), corner(0, 0)], [corner(1, 1), corner(0, 0), corner(1, 0)]]
        })
        .collect();
    let attributes = SoftBodyVertexAttributes::default()
        .compliance(COMPLIANCE)
        .shear_compliance(COMPLIANCE)
        .bend_compliance(Some(COMPLIANCE));
    SoftBodySharedSettings::builder(vertices, faces)
        .create_constraints(SoftBodyBendType::Distance, attributes)
        .build()
        .map_err(refused)
}

struct JoltCloth {
    world: PhysicsWorld,
    cloth: BodyId,
}

impl ClothSimulation for JoltCloth {
    fn step(&mut self) {
        step(&mut self.world, 1);
    }

    fn particles(&self, out: &mut Vec<ParticleState>) {
        let cloth = self.world.soft_body(self.cloth).expect("the cloth is never removed");
        out.clear();
        out.extend(cloth.vertices().into_iter().map(
            |SoftBodyVertexState { position: p, velocity, .. }| ParticleState {
                position: Vec3::new(p.x, p.y, p.z),
                velocity: from_vector(velocity),
            },
        ));
    }
}
