//! Geometry of a manifold for its rows: points and directions about the centres of its two bodies.

use super::block::{Block, Memory};
use crate::collide::{MAX_POINTS, Manifold};
use sinew_math::{Transform, Vec3, any_orthonormal};

/// Separation of an unused point, metres.
pub(super) const FAR: f32 = 1e6;

/// Cores of the surfaces at each point of a manifold, in the principal frames. The contact point of a ball does not
/// rotate with the ball; that of a box's corner rotates with the box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cores {
    pub points: [[Vec3; MAX_POINTS]; 2],
    /// Radii of the shapes' roundings around the cores at the contact.
    pub rounds: [f32; 2],
    pub normal: Vec3,
    pub count: usize,
}

impl Cores {
    /// Computes the cores of a manifold that was computed at these poses.
    pub fn new(manifold: &Manifold, poses: [Transform; 2], rounds: [f32; 2]) -> Self {
        let mut points = [[Vec3::ZERO; MAX_POINTS]; 2];
        let n = manifold.normal;
        for (i, point) in manifold.points().iter().enumerate() {
            let half = n * (0.5 * point.separation);
            points[0][i] = poses[0].inverse_point(point.position - half - n * rounds[0]);
            points[1][i] = poses[1].inverse_point(point.position + half + n * rounds[1]);
        }
        Self { points, rounds, normal: n, count: manifold.count }
    }
}

/// Surface to which the contact point is fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    OfA,
    Between,
    OfB,
}

impl Side {
    /// Chooses the side of a contact. The contact point moves with a ball, also on a table that moves away under the
    /// ball; otherwise it stays on the fixed body.
    pub fn new(rounds: [f32; 2], moves: [bool; 2]) -> Self {
        match rounds.map(|round| round > 0.0).into() {
            (true, false) => Self::OfA,
            (false, true) => Self::OfB,
            _ if !moves[1] => Self::OfA,
            _ if !moves[0] => Self::OfB,
            _ => Self::Between,
        }
    }

    fn pick(self, on_a: Vec3, on_b: Vec3) -> Vec3 {
        match self {
            Self::OfA => on_a,
            Self::Between => (on_a + on_b) * 0.5,
            Self::OfB => on_b,
        }
    }

    /// Position of the contact point between the surfaces, as a share of the separation: from the midpoint toward B.
    pub fn share(self) -> f32 {
        match self {
            Self::OfA => -0.5,
            Self::Between => 0.0,
            Self::OfB => 0.5,
        }
    }
}

/// Geometry of one manifold with its bodies at given poses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Geometry {
    normal: Vec3,
    tangent: Vec3,
    offset: Vec3,
    arms: [Vec3; MAX_POINTS],
    separation: [f32; MAX_POINTS],
    round: f32,
    center: Vec3,
    lever: f32,
}

impl Geometry {
    /// Computes the geometry from cores at these poses. Friction acts at the weighted centre of the points.
    pub fn new(cores: &Cores, poses: [Transform; 2], moves: [bool; 2], weights: &[f32; MAX_POINTS]) -> Self {
        let n = cores.normal;
        let on = |end: usize, i: usize| poses[end].point(cores.points[end][i]);
        let mut geometry = Self {
            normal: n,
            tangent: any_orthonormal(n),
            offset: poses[0].translation - poses[1].translation,
            arms: [Vec3::ZERO; MAX_POINTS],
            separation: [FAR; MAX_POINTS],
            round: cores.rounds[0] + cores.rounds[1],
            center: Vec3::ZERO,
            lever: 0.0,
        };
        let side = Side::new(cores.rounds, moves);
        for i in 0..cores.count {
            let (core_a, core_b) = (on(0, i), on(1, i));
            geometry.separation[i] = (core_b - core_a).dot(n) - geometry.round;
            let (on_a, on_b) = (core_a + n * cores.rounds[0], core_b - n * cores.rounds[1]);
            let at = side.pick(on_a, on_b) - poses[0].translation;
            geometry.arms[i] = at - n * cores.rounds[0];
            geometry.center += at * weights[i];
        }
        geometry.finish(cores.count, weights, cores.rounds[0]);
        geometry
    }

    /// Computes the lever arm of the twist. Unused points repeat the first point and are too far to touch.
    fn finish(&mut self, count: usize, weights: &[f32; MAX_POINTS], round: f32) {
        let first = self.arms[0];
        self.arms[count..].fill(first);
        if count > 1 {
            let center = self.center - self.normal * round;
            for i in 0..count {
                self.lever += (self.arms[i] - center).length() * weights[i];
            }
        }
    }

    /// Writes the geometry to a lane. The impulses of friction are along the tangents.
    pub fn write<const N: usize, const T: usize>(
        &self,
        block: &mut Block<N, T>,
        memory: &mut Memory<N>,
        lane: usize,
    ) {
        let set3 = |to: &mut [[f32; 8]; 3], v: Vec3| {
            for (row, number) in to.iter_mut().zip(v.to_array()) {
                row[lane] = number;
            }
        };
        set3(&mut block.normal, self.normal);
        set3(&mut block.tangent, self.tangent);
        set3(&mut block.offset, self.offset);
        set3(&mut block.center, self.center);
        for i in 0..N {
            set3(&mut block.arms[i], self.arms[i]);
            memory.start[i][lane] = self.separation[i];
            block.separation[i][lane] = self.separation[i];
        }
        memory.round[lane] = self.round;
        block.lever[lane] = self.lever;
        block.is_stale = true;
    }

    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Returns the two directions of friction.
    pub fn tangents(&self) -> [Vec3; 2] {
        [self.tangent, self.normal.cross(self.tangent)]
    }
}
