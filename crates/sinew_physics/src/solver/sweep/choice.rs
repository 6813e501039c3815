//! Chooses the substeps, the coupling and the sweep policy of an island.

use super::policy::{JOINTED, TURNS};
use crate::body::def::Quality;
use crate::island::Island;
use crate::solver::IslandSolver;
use crate::solver::articulation::tree::NONE;
use crate::solver::pass::Coupling;
use crate::solver::sweep::policy::{Firmness, SweepPolicy};
use crate::solver::tuning::{
    BOUNCE_SPEED, CALM_TURN, DAMPED_CONTACTS, DAMPED_CONTACTS_JOINTED, DAMPED_CONTACTS_PER_BODY,
    GRADED_RATIO, RESPONSE_CONTACTS, RESPONSE_CONTACTS_PER_LINK, RESPONSE_TREES,
};
use crate::solver::view::{Grading, View};
use sinew_math::{max, min};

impl IslandSolver {
    /// Chooses the number of substeps of an island. `Balanced` takes half of the world's where many contacts damp all motion, nothing spins
    /// fast and masses are similar, otherwise all of them. Islands with particles take all of them at every quality.
    pub(in crate::solver) fn choose_substeps(&mut self, island: &Island<'_>, view: &View<'_>) {
        self.quality = quality_of(island, view);
        self.stretch = stretch_of(island, view);
        (self.h, self.substeps) = view.pace.stretched(self.stretch);
        self.is_settled = true;
    }

    /// Chooses the coupling of contacts and joints: the response of all links for few trees, turns for more.
    pub(in crate::solver) fn choose_coupling(&mut self, contacts: usize) {
        let jointed = self.trees.iter().filter(|tree| tree.len() > 1 || self.links[tree.start].joint != NONE);
        let (trees, links) = jointed.fold((0, 0), |(trees, links), tree| (trees + 1, links + tree.len()));
        self.coupling = match trees {
            0 if self.pins.joints.is_empty() => Coupling::Free,
            _ if trees > RESPONSE_TREES
                || contacts > RESPONSE_CONTACTS + RESPONSE_CONTACTS_PER_LINK * links =>
            {
                Coupling::Turns
            }
            _ => Coupling::Response,
        };
    }

    /// Chooses the sweep policy from the touching pairs.
    pub(in crate::solver) fn choose_policy(&mut self) {
        let of_pile =
            |contacts: usize| SweepPolicy::of_pile(self.support.highest(), self.mass_ratio(), contacts);
        self.policy = match self.coupling {
            Coupling::Free => of_pile(self.touches.len()),
            // Contacts with jointed bodies need the policy of joints; piles beside and under jointed bodies need that
            // of small piles.
            _ if self.paired.contains(&true) => self.policy_with_joints().at_least(of_pile(0)),
            _ => self.policy_with_joints(),
        }
        .of_quality(if self.predicts() { self.quality } else { Quality::Balanced });
    }

    /// False for heaps at `Quality::Fast`, which do not check limits at the predicted poses: these checks take up to a third of the time of a
    /// heap, and without them a tenth of its joints exceed a limit by more than 0.1 rad in the crash (gaps stay below 0.01 mm). Such heaps keep
    /// the sweeps of `Balanced`: half of them save 8 % and leave twice the overlap.
    pub(in crate::solver) fn predicts(&self) -> bool {
        self.quality != Quality::Fast || self.coupling != Coupling::Turns
    }

    fn policy_with_joints(&self) -> SweepPolicy {
        if self.coupling == Coupling::Turns { TURNS } else { JOINTED }
    }

    /// Firmness of a contact between two bodies.
    pub(in crate::solver) fn firmness(&self, [a, b]: [u32; 2]) -> Firmness {
        if self.coupling == Coupling::Free {
            return Firmness::FREE;
        }
        let tree = |body: u32| self.links.get(body as usize).map(|link| link.tree);
        if tree(a).is_some() && tree(a) == tree(b) {
            Firmness::WITHIN_TREE
        } else {
            let moving = |body: u32| (body as usize) < self.links.len();
            match [a, b].map(|body| self.is_jointed(body)) {
                [false, false] => Firmness::FREE,
                [true, false] if moving(b) => Firmness::ON_FREE,
                [false, true] if moving(a) => Firmness::ON_FREE,
                _ => Firmness::JOINTED,
            }
        }
    }

    /// Ratio of the heaviest to the lightest scaled mass of touching bodies without joints.
    pub(in crate::solver) fn mass_ratio(&self) -> f32 {
        let (mut lightest, mut heaviest) = (f32::INFINITY, 0.0);
        for (body, _) in self.bodies.iter().zip(&self.paired).filter(|(_, is_paired)| **is_paired) {
            let mass = body.mass * body.mass_scale;
            lightest = min(lightest, mass);
            heaviest = max(heaviest, mass);
        }
        if heaviest > lightest { heaviest / lightest } else { 1.0 }
    }
}

/// Highest quality requested by a body of the island.
fn quality_of(island: &Island<'_>, view: &View<'_>) -> Quality {
    island.bodies.iter().map(|&body| view.quality(body)).max().unwrap_or_default()
}

/// Ratio of the length of an island's substeps to the world's, a power of two.
pub(in crate::solver) fn stretch_of(island: &Island<'_>, view: &View<'_>) -> f32 {
    let may_halve = view.pace.substeps.is_multiple_of(2);
    match quality_of(island, view) {
        _ if view.pace.grading == Grading::None || !island.groups.is_empty() => 1.0,
        Quality::Exact => 0.5,
        Quality::Balanced if may_halve && is_damped(island, view) => 2.0,
        Quality::Fast if may_halve && is_calm(island, view) => 2.0,
        Quality::Balanced | Quality::Fast => 1.0,
    }
}

/// True if contacts damp the motion of an island so much that it may take longer substeps.
fn is_damped(island: &Island<'_>, view: &View<'_>) -> bool {
    let (contacts, bodies) = (island.contacts.len(), island.bodies.len());
    let many = if island.joints.is_empty() {
        contacts >= DAMPED_CONTACTS
    } else {
        contacts >= DAMPED_CONTACTS_JOINTED
            && contacts as f32 >= DAMPED_CONTACTS_PER_BODY * bodies as f32
            && island.joints.iter().all(|&joint| view.joints.at(joint).drive.is_limp())
    };
    let bounces = |&contact: &u32| {
        let approach = view.contacts[contact as usize].approach;
        approach > BOUNCE_SPEED && view.contacts[contact as usize].material(view.bodies).restitution > 0.0
    };
    many && !island.contacts.iter().any(bounces) && is_calm(island, view)
}

/// True if masses and spins of an island allow longer substeps.
fn is_calm(island: &Island<'_>, view: &View<'_>) -> bool {
    let (mut lightest, mut heaviest, mut spin) = (f32::INFINITY, 0.0, 0.0);
    for &index in island.bodies {
        let body = view.bodies.at(index);
        lightest = min(lightest, body.mass);
        heaviest = max(heaviest, body.mass);
        spin = max(spin, body.velocity.angular.length());
    }
    heaviest <= GRADED_RATIO * lightest && spin * 2.0 * view.pace.h <= CALM_TURN
}
