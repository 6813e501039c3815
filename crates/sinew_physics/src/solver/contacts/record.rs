//! Packed copies of the contact data that the solver needs, so that the world's list is read once and in its own order.

use super::Contacts;
use super::block::NONE;
use super::color::Edge;
use super::geometry::Side;
use crate::body::material::ContactMaterial;
use crate::collide::{MAX_POINTS, ManifoldPoint};
use crate::contact::{Contact, PointImpulse};
use crate::solver::body::SolverBody;
use crate::solver::contact_rows::Placed;
use crate::solver::sweep::policy::Firmness;
use crate::spatial::Vec6;
use sinew_math::lanes::{Lanes, WIDTH};
use sinew_math::{Transform, Vec3};

/// Row numbers of a record.
pub(super) const SHAPE: usize = 0;
pub(super) const POINTS: usize = 1;
pub(super) const IMPULSES: usize = 3;
pub(super) const FRICTION: usize = 5;

/// One contact, eight numbers in each row:
///
/// - normal, roundings of A and of both, slop, share of the separation, number of points;
/// - two points: position, separation; two more;
/// - impulses of two points: of the last substep, the one before, the step, the lasting load; two more;
/// - friction, twist, coefficients of sliding and static friction, restitution, launch.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Record {
    rows: [Vec6; 6],
}

/// Data that only a few contacts have.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extra {
    /// Velocity and spin of B's surface minus those of A's, m/s and rad/s.
    pub velocity: Vec3,
    pub spin: Vec3,
    /// Rolling resistance: its lever arm, and the impulse of the last substep.
    pub rolling: f32,
    pub impulse: Vec3,
    pub rounds: [f32; 2],
    /// True if other points come into contact as a shape rolls.
    pub rolls: bool,
}

/// A contact of an island.
pub(in crate::solver) struct Added<'a> {
    /// Index in the world's contact array.
    pub index: u32,
    pub contact: &'a Contact,
    /// Local indices of the bodies, and whether contacts move them.
    pub bodies: [u32; 2],
    pub moves: [bool; 2],
    /// Largest number of points that the contact may have within the step.
    pub points: usize,
    pub firmness: Firmness,
    pub slop: f32,
    pub material: &'a ContactMaterial,
    /// Shapes of the contact, if one of them is curved.
    pub curved: Option<[Placed<'a>; 2]>,
}

/// Radii of the roundings at the contact, and whether a shape touches with a rim.
fn rounds(shapes: &[Placed<'_>; 2], poses: [&Transform; 2], normal: Vec3) -> ([f32; 2], bool) {
    let (mut rounds, mut rolls) = ([0.0; 2], false);
    for end in 0..2 {
        if shapes[end].is_curved() {
            let in_principal = poses[end].rotation.inverse() * normal;
            rounds[end] = shapes[end].round(in_principal);
            rolls |= shapes[end].has_rim(in_principal);
        }
    }
    (rounds, rolls)
}

/// Class of the block for a contact of `points` points.
fn class_of(points: usize) -> u32 {
    match points {
        0 | 1 => 0,
        2 => 1,
        _ => 2,
    }
}

impl Record {
    #[inline(always)]
    fn new(added: &Added<'_>, rounds: [f32; 2]) -> Self {
        let Added { contact, material, .. } = added;
        let (manifold, memory) = (&contact.manifold, &contact.memory);
        let n = manifold.normal;
        let share = Side::new(rounds, added.moves).share();
        let round = rounds[0] + rounds[1];
        let ContactMaterial { friction: sliding, static_friction: holding, restitution, launch, .. } =
            **material;
        let f = memory.friction;
        let rows = [
            [n.x, n.y, n.z, rounds[0], round, added.slop, share, manifold.count as f32],
            two_points(&manifold.points[0], &manifold.points[1]),
            two_points(&manifold.points[2], &manifold.points[3]),
            two_impulses(&memory.points[0], &memory.points[1]),
            two_impulses(&memory.points[2], &memory.points[3]),
            [f.x, f.y, f.z, memory.twist, sliding, holding, restitution, launch],
        ];
        Self { rows }
    }

    pub fn slop(&self) -> f32 {
        self.rows[SHAPE][5]
    }
}

#[inline(always)]
fn two_points(p: &ManifoldPoint, q: &ManifoldPoint) -> Vec6 {
    let (a, b) = (p.position, q.position);
    [a.x, a.y, a.z, p.separation, b.x, b.y, b.z, q.separation]
}

#[inline(always)]
fn two_impulses(p: &PointImpulse, q: &PointImpulse) -> Vec6 {
    [p.now, p.before, p.total, p.lasting, q.now, q.before, q.total, q.lasting]
}

/// Loads a row of eight records, field by field.
#[inline(always)]
pub(super) fn fields<L: Lanes>(records: &[Record], places: &[u32; WIDTH], row: usize) -> [L; WIDTH] {
    let [a, b, c, d, e, f, g, h] = *places;
    L::transpose([
        at(records, a, row),
        at(records, b, row),
        at(records, c, row),
        at(records, d, row),
        at(records, e, row),
        at(records, f, row),
        at(records, g, row),
        at(records, h, row),
    ])
}

#[inline(always)]
fn at<L: Lanes>(records: &[Record], place: u32, row: usize) -> L {
    L::load(&records[place as usize].rows[row])
}

impl Contacts {
    /// Sets the starting impulses of an added contact.
    pub fn start_with(&mut self, place: usize, points: &[PointImpulse; MAX_POINTS]) {
        let [p, q, r, s] = points;
        let rows = &mut self.records[place].rows;
        (rows[IMPULSES], rows[IMPULSES + 1]) = (two_impulses(p, q), two_impulses(r, s));
    }

    /// Adds a contact. Contacts between moving bodies come first, then those with fixed bodies.
    #[inline]
    pub fn push(&mut self, added: &Added<'_>, bodies: &[SolverBody]) {
        let Added { contact, material, .. } = added;
        self.tally.manifolds += 1;
        self.tally.points += added.points as u64;
        let (rounds, rolls) = match &added.curved {
            Some(shapes) => {
                let poses = added.bodies.map(|body| &bodies[body as usize].pose);
                rounds(shapes, poses, contact.manifold.normal)
            }
            None => ([0.0; 2], false),
        };
        let runs = material.velocity != Vec3::ZERO || material.spin != Vec3::ZERO;
        self.drives |= material.drives();
        let mut extra = NONE;
        if runs || rolls || material.rolling > 0.0 {
            extra = self.extras.len() as u32;
            let (velocity, spin, rolling) = (material.velocity, material.spin, material.rolling);
            let impulse = contact.memory.rolling;
            self.extras.push(Extra { velocity, spin, rolling, impulse, rounds, rolls });
        }
        self.records.push(Record::new(added, rounds));
        let class = class_of(added.points);
        self.coloring.edges.push(Edge::new(added.index, added.bodies, class, added.firmness, extra));
    }
}
