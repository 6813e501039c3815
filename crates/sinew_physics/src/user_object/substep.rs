//! Access of an object to the world within a substep: queries and actions.

use super::lockstep::{Places, Roused};
use crate::body::def::BodyKind;
use crate::body::shape::MassProperties;
use crate::body::{Body, Velocity};
use crate::context::StepContext;
use crate::id::{BodyId, GroupId};
use crate::particles::ParticleGroup;
use crate::solver::boundary::groups::TakenGroup;
use crate::solver::{IslandSolver, View};
use crate::spatial::{Vec6, ZERO6, angular, join, linear};
use crate::step::islands::Islands;
use crate::step::tasks::Workspace;
use core::ops::{Deref, DerefMut};
use sinew_math::{Transform, Vec3};

/// The world within a step: bodies and particles are where the substeps so far have moved them.
///
/// # Panics
/// Every method that takes an id panics if the id is stale or from another world, and every method that takes a number
/// panics if it is not finite.
pub struct Substep<'a> {
    view: &'a View<'a>,
    workspaces: &'a mut [Workspace],
    taken: &'a mut [TakenGroup],
    places: &'a Places,
    roused: &'a mut Vec<Roused>,
    /// Start time of the step, seconds.
    start: f64,
    /// Number of substeps completed at the current state.
    moved: u32,
}

impl<'a> Substep<'a> {
    pub(super) fn new(
        islands: &'a mut Islands,
        view: &'a View<'a>,
        places: &'a Places,
        roused: &'a mut Vec<Roused>,
        context: &StepContext<'_>,
        moved: u32,
    ) -> Self {
        let (workspaces, taken) = islands.halted();
        Self { view, workspaces, taken, places, roused, start: context.time, moved }
    }

    /// Length of a substep, seconds.
    pub fn h(&self) -> f32 {
        self.view.pace.h
    }

    /// Simulated time of the current state, seconds: the start of the substep for forces, its end for corrections.
    pub fn time(&self) -> f64 {
        self.start + f64::from(self.moved) * f64::from(self.view.pace.h)
    }

    /// The world's gravity, m/s².
    pub fn gravity(&self) -> Vec3 {
        self.view.def.gravity
    }

    /// Iterates over all bodies, by index.
    pub fn body_ids(&self) -> impl Iterator<Item = BodyId> + use<'a> {
        self.view.bodies.ids()
    }

    /// True if the id names an existing body.
    pub fn contains(&self, id: BodyId) -> bool {
        self.view.bodies.get(id).is_some()
    }

    /// Kind of a body: static, kinematic or dynamic.
    pub fn kind(&self, id: BodyId) -> BodyKind {
        self.expect(id).kind
    }

    /// Mass (kg; 0 unless dynamic), centre (metres) and inertia (kg·m²) in the body's frame.
    pub fn mass(&self, id: BodyId) -> MassProperties {
        self.expect(id).mass_properties()
    }

    /// Pose of the body's frame, world.
    pub fn transform(&self, id: BodyId) -> Transform {
        self.principal_frame(id) * self.expect(id).principal_from_body
    }

    /// World position of the centre of mass, metres.
    pub fn center_of_mass(&self, id: BodyId) -> Vec3 {
        self.principal_frame(id).translation
    }

    /// Velocity of the centre of mass (m/s) and angular velocity (rad/s), world; zero for a sleeping body.
    pub fn velocity(&self, id: BodyId) -> Velocity {
        let body = self.expect(id);
        match (self.moving(id), body.kind) {
            (Some((solver, local)), _) => {
                let v = &solver.velocities[local];
                Velocity { linear: linear(v), angular: angular(v) }
            }
            (None, BodyKind::Kinematic) => body.velocity,
            (None, _) => Velocity::default(),
        }
    }

    /// Response of a body at a world point: the speed gained in a direction (of length 1) per impulse in that
    /// direction, 1/kg. It includes the joints of the body, except those that close loops. 0 for static, kinematic and
    /// sleeping bodies.
    ///
    /// The cost is a pass through all connected bodies.
    pub fn response(&mut self, id: BodyId, point: Vec3, direction: Vec3) -> f32 {
        let row = self.at(id, direction, point);
        self.moving_mut(id).map_or(0.0, |(solver, local)| solver.response_along(local, &row))
    }

    /// Returns a particle group.
    pub fn particles(&self, id: GroupId) -> &ParticleGroup {
        &self.taken[self.place(id)].group
    }

    /// Returns a particle group, mutable.
    pub fn particles_mut(&mut self, id: GroupId) -> &mut ParticleGroup {
        let place = self.place(id);
        &mut self.taken[place].group
    }

    fn place(&self, id: GroupId) -> usize {
        let place = self.places.group(id).filter(|&place| place < self.taken.len());
        place.unwrap_or_else(|| panic!("{id:?} is not there"))
    }

    fn expect(&self, id: BodyId) -> &'a Body {
        self.view.bodies.expect(id)
    }

    fn principal_frame(&self, id: BodyId) -> Transform {
        match self.moving(id) {
            Some((solver, local)) => solver.bodies[local].pose,
            None => match self.expect(id) {
                body if body.kind == BodyKind::Kinematic => body.carried(self.view.pace.h, self.moved),
                body => body.world_from_principal,
            },
        }
    }

    /// Returns the solver of a body's island and the body's number there, if the body moves.
    fn moving(&self, id: BodyId) -> Option<(&IslandSolver, usize)> {
        self.expect(id);
        let (island, local) = self.places.body(id)?;
        Some((&self.workspaces[island].solver, local))
    }

    fn moving_mut(&mut self, id: BodyId) -> Option<(&mut IslandSolver, usize)> {
        self.expect(id);
        let (island, local) = self.places.body(id)?;
        Some((&mut self.workspaces[island].solver, local))
    }

    /// Converts a force or an impulse at a world point to one at the centre of mass.
    fn at(&self, id: BodyId, force: Vec3, point: Vec3) -> Vec6 {
        assert!(
            force.is_finite() && point.is_finite(),
            "what is applied to a body must be finite, not {force:?} and {point:?} ({id:?})"
        );
        join(force, (point - self.center_of_mass(id)).cross(force))
    }

    /// Applies an impulse to a moving body by `give`; for a sleeping body, stores it, and the body wakes after the
    /// step.
    fn give(&mut self, id: BodyId, impulse: &Vec6, give: impl FnOnce(&mut IslandSolver, usize, &Vec6)) {
        if let Some((solver, local)) = self.moving_mut(id) {
            give(solver, local, impulse);
        } else {
            let body = self.expect(id);
            let change =
                join(linear(impulse) * body.inverse_mass(), body.inverse_inertia_mul(angular(impulse)));
            self.rouse(id, impulse, &change);
        }
    }

    /// Makes a sleeping body wake after the step, unless the applied force or impulse is zero.
    fn rouse(&mut self, id: BodyId, applied: &Vec6, change: &Vec6) {
        let body = self.expect(id);
        if body.kind == BodyKind::Dynamic && !body.is_awake() && !body.quarantined && *applied != ZERO6 {
            self.roused.push(Roused { index: id.index, change: *change });
        }
    }
}

/// Access at the start of a substep: nothing has moved yet.
///
/// Actions on a sleeping body wake it after the step; an impulse then takes effect immediately, a force from the next
/// step on, like gravity. Zero forces and impulses wake nothing. Static and kinematic bodies do not move.
pub struct Forces<'a>(pub(super) Substep<'a>);

impl Forces<'_> {
    /// Applies a force (N) at a world point for this substep.
    pub fn apply_force(&mut self, id: BodyId, force: Vec3, point: Vec3) {
        let force = self.at(id, force, point);
        self.add(id, &force);
    }

    /// Applies a force (N) at the centre of mass for this substep.
    pub fn apply_force_at_center(&mut self, id: BodyId, force: Vec3) {
        self.apply_force(id, force, self.center_of_mass(id));
    }

    /// Applies a torque (N·m) for this substep.
    pub fn apply_torque(&mut self, id: BodyId, torque: Vec3) {
        assert!(torque.is_finite(), "a torque must be finite, not {torque:?} ({id:?})");
        self.add(id, &join(Vec3::ZERO, torque));
    }

    /// Applies an impulse (N·s) at a world point: changes the velocity immediately. Joints respond when the substep is
    /// solved.
    pub fn apply_impulse(&mut self, id: BodyId, impulse: Vec3, point: Vec3) {
        let impulse = self.at(id, impulse, point);
        self.give(id, &impulse, IslandSolver::push_loose);
    }

    fn add(&mut self, id: BodyId, force: &Vec6) {
        if let Some((solver, local)) = self.moving_mut(id) {
            solver.add_force(local, linear(force), angular(force));
        } else {
            self.rouse(id, force, &ZERO6);
        }
    }
}

/// Access at the end of a substep: all bodies have moved, and velocities have not been relaxed yet.
///
/// Actions take effect through the joints immediately, so each call costs a pass through all connected bodies. A
/// sleeping body wakes after the step.
pub struct Corrections<'a>(pub(super) Substep<'a>);

impl Corrections<'_> {
    /// Applies an impulse (N·s) at a world point: changes velocities.
    pub fn apply_impulse(&mut self, id: BodyId, impulse: Vec3, point: Vec3) {
        let impulse = self.at(id, impulse, point);
        self.give(id, &impulse, IslandSolver::push_held);
    }

    /// Applies an impulse (N·s) at a world point that changes velocities, and poses by `h` times the change of
    /// velocity, as if it had acted throughout the substep. An impulse of `−C / (h w)` along the gradient of an error
    /// `C` (metres), with the [`response`](Substep::response) `w`, removes the error (Müller et al., "Detailed Rigid
    /// Body Simulation with Extended Position Based Dynamics", SCA 2020).
    ///
    /// Pose changes should be small: contacts and particles are searched only within the predicted motion.
    pub fn correct(&mut self, id: BodyId, impulse: Vec3, point: Vec3) {
        let impulse = self.at(id, impulse, point);
        self.give(id, &impulse, IslandSolver::correct);
    }

    /// Moves a particle by `by` (metres, world) and changes its velocity as if it had moved within the substep.
    ///
    /// # Panics
    /// If there is no such particle.
    pub fn move_particle(&mut self, id: GroupId, particle: u32, by: Vec3) {
        let h = self.h();
        self.particles_mut(id).correct(particle, by, h);
    }
}

impl<'a> Deref for Forces<'a> {
    type Target = Substep<'a>;
    fn deref(&self) -> &Substep<'a> {
        &self.0
    }
}

impl DerefMut for Forces<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}

impl<'a> Deref for Corrections<'a> {
    type Target = Substep<'a>;
    fn deref(&self) -> &Substep<'a> {
        &self.0
    }
}

impl DerefMut for Corrections<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.0
    }
}
