//! A cloth that falls over obstacles.

use super::rays::PlacedBox;
use sinew::math::{Rotation, Transform, Vec3};
use sinew::physics::{BodyDef, BodyKind, Shape, ShapeDef};

/// A square grid of particles in the plane y = const, and its obstacles.
///
/// Links run along both directions of the grid, along both diagonals of every cell, and over two cells (bending). No
/// self-collision.
#[derive(Clone, Debug, PartialEq)]
pub struct ClothScene {
    /// Number of particles along a side.
    pub side: usize,
    /// Distance between neighbours, metres.
    pub spacing: f32,
    /// World position of the first particle; rows run along +x, the next row is at +z.
    pub corner: Vec3,
    /// Mass of one particle, kg.
    pub particle_mass: f32,
    /// Radius of one particle, metres.
    pub particle_radius: f32,
    /// Damping, 1/s.
    pub damping: f32,
    /// Coefficient of Coulomb friction between cloth and obstacles.
    pub friction: f32,
    /// Obstacles that are boxes.
    pub boxes: Vec<PlacedBox>,
    /// Obstacles that are balls: centre and radius, metres.
    pub spheres: Vec<(Vec3, f32)>,
}

impl ClothScene {
    /// Returns 10,000 particles of 2 g, 4 m by 4 m, pinned by two corners 2.2 m above the floor.
    pub fn new() -> Self {
        let floor = Transform::from_translation(Vec3::new(0.0, -0.5, 0.0));
        let yaw = Rotation::from_axis_angle(Vec3::Y, 30f32.to_radians());
        let block = Transform::new(Vec3::new(1.0, 0.6, 0.6), yaw);
        Self {
            side: 100,
            spacing: 0.04,
            corner: Vec3::new(-1.98, 2.2, -1.98),
            particle_mass: 0.002,
            particle_radius: 0.02,
            damping: 0.05,
            friction: 0.6,
            boxes: vec![
                PlacedBox { half_extents: Vec3::new(50.0, 0.5, 50.0), world_from_box: floor },
                PlacedBox { half_extents: Vec3::splat(0.6), world_from_box: block },
            ],
            spheres: vec![(Vec3::new(-1.0, 0.8, 0.2), 0.8)],
        }
    }

    /// Returns the world position of a particle at the start.
    pub fn position(&self, row: usize, column: usize) -> Vec3 {
        self.corner + Vec3::new(column as f32, 0.0, row as f32) * self.spacing
    }

    /// Returns the index of a particle: row by row.
    pub fn index(&self, row: usize, column: usize) -> usize {
        row * self.side + column
    }

    /// Returns the particles that never move: both corners of the first row.
    pub fn pinned(&self) -> [usize; 2] {
        [self.index(0, 0), self.index(0, self.side - 1)]
    }

    /// Returns the obstacles as static bodies.
    pub fn obstacles(&self) -> Vec<BodyDef> {
        let ball = |&(position, radius): &(Vec3, f32)| BodyDef {
            kind: BodyKind::Static,
            position,
            shapes: vec![ShapeDef::new(Shape::Sphere { radius })],
            ..BodyDef::default()
        };
        let mut bodies: Vec<_> =
            self.boxes.iter().map(PlacedBox::fixed).chain(self.spheres.iter().map(ball)).collect();
        for shape in bodies.iter_mut().flat_map(|body| &mut body.shapes) {
            shape.material.friction = self.friction;
        }
        bodies
    }

    /// Returns the neighbours along the grid: structural links.
    pub fn structural_links(&self) -> Vec<[usize; 2]> {
        let n = self.side;
        let along = (0..n).flat_map(|row| (1..n).map(move |k| (row, k)));
        along
            .flat_map(|(row, k)| {
                [[self.index(row, k - 1), self.index(row, k)], [self.index(k - 1, row), self.index(k, row)]]
            })
            .collect()
    }
}

impl Default for ClothScene {
    fn default() -> Self {
        Self::new()
    }
}
