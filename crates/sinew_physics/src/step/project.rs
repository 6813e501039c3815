//! The stage `project` moves the particle groups of an island, after its bodies have moved and before their contacts
//! are relaxed.

use crate::body::Velocity;
use crate::body::def::BodyKind;
use crate::body::material::Material;
use crate::body::shape::Shape;
use crate::id::BodyId;
use crate::island::Island;
use crate::particles::{AddedMass, Anchor, AttachmentTarget, Obstacle, ObstacleBody, ParticleGroup};
use crate::solver::boundary::groups::TakenGroup;
use crate::solver::{IslandSolver, SolverBody, View};
use crate::spatial::{Vec6, ZERO6, add_scaled, angular, join, linear, wrench};
use crate::step::tuning::{HEAVY_LOAD, JOINT_CHANGE, JOINT_ROUNDS};
use sinew_math::{Sym3, Transform, Vec3, max};

/// Obstacles, anchors and bodies near a particle group, and memory to collect them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surroundings {
    obstacles: Vec<Obstacle>,
    anchors: Vec<Anchor>,
    bodies: Vec<ObstacleBody>,
    seen: Vec<Seen>,
    /// Poses of the island's moving bodies at the start of the substep.
    starts: Vec<Transform>,
    /// Impulses on the bodies of the island, by local index, N·s and N·m·s.
    impulses: Vec<Vec6>,
    /// Number of groups attached to each body of the island, and of those groups that can be solved together.
    hung_on: Vec<u32>,
    joinable: Vec<u32>,
    /// Velocities of the island's moving bodies before the groups' impulses; and those impulses, N·s.
    untouched: Vec<Vec6>,
    pushed: Vec<Vec3>,
}

/// A body near a particle group: its pose, motion and mass, and its local index.
#[derive(Clone, Debug)]
struct Seen {
    /// Pose at the start of the substep.
    start: Transform,
    pose: Transform,
    velocity: Vec6,
    /// Velocity change from the forces of the coming substep, m/s.
    coming: Vec3,
    inverse_mass: f32,
    inverse_inertia: Sym3,
    /// Local index in the island; `None` if the island does not move the body.
    local: Option<usize>,
}

impl Seen {
    fn new(index: u32, starts: &[Transform], solver: &IslandSolver, view: &View<'_>, substep: u32) -> Self {
        if let Some(local) = local_of(solver.moving_bodies(), index) {
            let body = &solver.moving_bodies()[local];
            return Self {
                start: starts[local],
                pose: body.pose,
                velocity: solver.velocities[local],
                coming: body.force * (view.pace.h / body.mass),
                inverse_mass: 1.0 / body.mass,
                inverse_inertia: body.inverse_inertia,
                local: Some(local),
            };
        }
        let body = view.bodies.at(index);
        let velocity = match body.kind {
            BodyKind::Kinematic => body.velocity,
            BodyKind::Static | BodyKind::Dynamic => Velocity::default(),
        };
        // The world moves kinematic bodies only at the end of the step.
        let mut start = body.world_from_principal;
        for _ in 0..substep {
            start = moved(&start, &velocity, view.pace.h);
        }
        Self {
            start,
            pose: moved(&start, &velocity, view.pace.h),
            velocity: join(velocity.linear, velocity.angular),
            coming: Vec3::ZERO,
            inverse_mass: 0.0,
            inverse_inertia: Sym3::ZERO,
            local: None,
        }
    }
}

/// Local index of a body among the moving bodies of an island.
fn local_of(moving: &[SolverBody], index: u32) -> Option<usize> {
    moving.iter().position(|body| body.index == index)
}

fn moved(pose: &Transform, velocity: &Velocity, h: f32) -> Transform {
    if *velocity == Velocity::default() {
        return *pose;
    }
    Transform::new(pose.translation + velocity.linear * h, pose.rotation.integrate(velocity.angular, h))
}

impl Surroundings {
    /// Reserves memory that only islands with particles need, even for an island without them, because the workspace is
    /// reused.
    pub fn make_room(&mut self, island: &Island<'_>) {
        self.impulses.clear();
        self.impulses.reserve(island.bodies.len());
        self.starts.clear();
        self.starts.reserve(island.bodies.len());
        self.hung_on.clear();
        self.hung_on.reserve(island.bodies.len());
        self.joinable.clear();
        self.joinable.reserve(island.bodies.len());
        self.untouched.clear();
        self.untouched.reserve(island.bodies.len());
        self.pushed.clear();
        self.pushed.reserve(island.bodies.len());
    }

    /// Moves the groups of an island by one substep. The bodies' trees transmit the impulses of springs and contacts.
    pub fn project(
        &mut self,
        groups: &mut [TakenGroup],
        solver: &mut IslandSolver,
        view: &View<'_>,
        substep: u32,
    ) {
        if groups.is_empty() {
            return;
        }
        self.look_at_bodies(groups, solver, view.pace.h);
        self.solve_together(groups, solver, view, substep);
        for taken in groups.iter_mut() {
            self.see(taken, solver, view, substep);
            self.place_obstacles(taken, view);
            let begun = self.is_joined(&taken.group, solver);
            let Self { anchors, obstacles, bodies, .. } = self;
            let (h, gravity) = (view.pace.h, view.def.gravity);
            if !begun {
                taken.group.begin_substep(h, gravity, anchors, obstacles, bodies);
            }
            taken.group.end_substep(h, anchors, obstacles, bodies);
            self.push_bodies(taken, solver);
        }
        if (0..self.hung_on.len()).any(|local| self.is_pushed_apart(local)) {
            groups.iter_mut().for_each(|taken| self.join_held(taken, solver, view, substep));
        }
    }

    /// True if the groups attached to a body are not all solved together.
    fn is_pushed_apart(&self, local: usize) -> bool {
        self.hung_on[local] > 1 && self.joinable[local] < self.hung_on[local]
    }

    /// True if a group is solved together with others attached to the same body.
    fn is_joined(&self, group: &ParticleGroup, solver: &IslandSolver) -> bool {
        let shared = |id: BodyId| {
            local_of(solver.moving_bodies(), id.index).is_some_and(|local| self.joinable[local] > 1)
        };
        group.is_joinable() && group.bodies().any(shared)
    }

    /// Starts the substep of groups attached to one body, as one system. Each group is solved with the inertia and pull
    /// of the others, in turns, until the body's velocity converges. If they share a single body, the contributions do
    /// not depend on the others' velocities, and the first round is exact except for springs that rotate or close
    /// loops.
    ///
    /// If groups were solved alone, each would rotate the whole body about its own corner, and ropes would undo each
    /// other's effect.
    fn solve_together(
        &mut self,
        groups: &mut [TakenGroup],
        solver: &IslandSolver,
        view: &View<'_>,
        substep: u32,
    ) {
        groups.iter_mut().for_each(|taken| taken.group.forget_shares());
        if self.joinable.iter().all(|&count| count < 2) {
            return;
        }
        for round in 0..=JOINT_ROUNDS {
            let mut change = 0.0;
            for k in 0..groups.len() {
                if !self.is_joined(&groups[k].group, solver) {
                    continue;
                }
                let (before, rest) = groups.split_at_mut(k);
                let Some((taken, after)) = rest.split_first_mut() else { continue };
                taken.group.forget_others();
                for other in before.iter().chain(&*after).filter(|other| self.is_joined(&other.group, solver))
                {
                    taken.group.add_shares_of(&other.group);
                }
                self.see(taken, solver, view, substep);
                self.place_obstacles(taken, view);
                let Self { anchors, obstacles, bodies, .. } = self;
                let (h, gravity) = (view.pace.h, view.def.gravity);
                if round == 0 {
                    taken.group.begin_substep(h, gravity, anchors, obstacles, bodies);
                    change = f32::INFINITY;
                } else {
                    change = max(change, taken.group.solve_again(h, obstacles, bodies));
                }
            }
            if change < JOINT_CHANGE {
                break;
            }
        }
    }

    /// Gives a group's attached particles the velocity of their body if other groups are attached to it too, because
    /// those have pushed the body since. Otherwise the particles' inertia would act on the body one substep late, and a
    /// body on two ropes would gain energy.
    fn join_held(
        &mut self,
        taken: &mut TakenGroup,
        solver: &mut IslandSolver,
        view: &View<'_>,
        substep: u32,
    ) {
        self.see(taken, solver, view, substep);
        self.impulses.clear();
        self.impulses.resize(solver.moving_bodies().len(), ZERO6);
        for (k, anchor) in self.anchors.iter().enumerate() {
            let Some(place) = anchor.body.map(|body| body as usize) else { continue };
            if let Some(local) = self.seen[place].local.filter(|&local| self.is_pushed_apart(local)) {
                let impulse = taken.group.join_held(k, anchor, &mut self.bodies[place]);
                let arm = anchor.position - self.bodies[place].center;
                add_scaled(&mut self.impulses[local], &wrench(arm, impulse), 1.0);
            }
        }
        self.push(solver);
    }

    /// Applies the listed impulses to the bodies.
    fn push(&mut self, solver: &mut IslandSolver) {
        for (pushed, impulse) in self.pushed.iter_mut().zip(&self.impulses) {
            *pushed += linear(impulse);
        }
        solver.apply_impulses(&self.impulses);
    }

    /// Records the bodies' velocities before the groups' impulses, and the number of groups per body.
    fn look_at_bodies(&mut self, groups: &mut [TakenGroup], solver: &mut IslandSolver, h: f32) {
        let moving = solver.moving_bodies();
        self.starts.clear();
        self.starts.extend(moving.iter().zip(&solver.velocities).map(|(body, v)| {
            let back = Velocity { linear: -linear(v), angular: -angular(v) };
            moved(&body.pose, &back, h)
        }));
        self.untouched.clear();
        self.untouched.extend_from_slice(&solver.velocities[..moving.len()]);
        self.pushed.clear();
        self.pushed.resize(moving.len(), Vec3::ZERO);
        self.hung_on.clear();
        self.hung_on.resize(moving.len(), 0);
        self.joinable.clear();
        self.joinable.resize(moving.len(), 0);
        for taken in groups.iter().filter(|taken| taken.group.is_joinable()) {
            for local in taken.group.bodies().filter_map(|id| local_of(moving, id.index)) {
                self.joinable[local] += 1;
            }
        }
        let mut bears = false;
        for (id, added) in groups.iter_mut().flat_map(|taken| taken.group.holders()) {
            if let Some(local) = local_of(moving, id.index) {
                self.hung_on[local] += 1;
                bears |= added.mass() > HEAVY_LOAD * moving[local].mass;
            }
        }
        solver.bears_by_springs = bears;
    }

    /// Estimates the added mass of bodies on groups, from their velocity gain until the end of the substep. Groups that
    /// share a body and are not solved together are evaluated one after the other.
    pub fn find_added(&self, groups: &mut [TakenGroup], solver: &IslandSolver) {
        let moving = solver.moving_bodies();
        for (id, added) in groups.iter_mut().flat_map(|taken| taken.group.holders()) {
            let local = local_of(moving, id.index).filter(|&local| !self.is_pushed_apart(local));
            *added = local.map_or_else(AddedMass::default, |local| {
                let gained = linear(&solver.velocities[local]) - linear(&self.untouched[local]);
                AddedMass::of(moving[local].mass, self.pushed[local], gained)
            });
        }
    }

    /// Collects bodies and anchors of a group at the present poses.
    fn see(
        &mut self,
        TakenGroup { group, near, .. }: &TakenGroup,
        solver: &IslandSolver,
        view: &View<'_>,
        substep: u32,
    ) {
        self.seen.clear();
        let see = |&index: &u32| Seen::new(index, &self.starts, solver, view, substep);
        self.seen.extend(near.bodies.iter().map(see));
        let seen = &self.seen;
        self.bodies.clear();
        self.bodies.extend(seen.iter().map(|body| ObstacleBody {
            center: body.pose.translation,
            linear_velocity: linear(&body.velocity),
            angular_velocity: angular(&body.velocity),
            inverse_mass: body.inverse_mass,
            inverse_inertia: body.inverse_inertia,
        }));
        self.anchors.clear();
        for attachment in group.attachments() {
            self.anchors.push(match attachment.target {
                AttachmentTarget::World(position) => Anchor { position, ..Anchor::default() },
                AttachmentTarget::Body { body, point } => {
                    let place = near.bodies.binary_search(&body.index).unwrap_or(0);
                    let principal_from_body = view.bodies.at(body.index).principal_from_body;
                    let seen = &seen[place];
                    let position = seen.pose.point(principal_from_body.point(point));
                    let velocity = self.bodies[place].velocity_at(position);
                    Anchor { position, velocity, gained: seen.coming, body: Some(place as u32) }
                }
            });
        }
    }

    /// Collects obstacles of a group: shapes of bodies, then its backstops.
    fn place_obstacles(&mut self, TakenGroup { group, near, .. }: &TakenGroup, view: &View<'_>) {
        let seen = &self.seen;
        self.obstacles.clear();
        for &(place, shape) in &near.shapes {
            let body = view.bodies.at(near.bodies[place as usize]);
            let s = &body.shapes[shape as usize];
            self.obstacles.push(Obstacle {
                shape: s.shape.clone(),
                previous: seen[place as usize].start * s.principal_from_shape,
                world_from_shape: seen[place as usize].pose * s.principal_from_shape,
                body: place,
                material: body.surface(shape as usize).material,
            });
        }
        for backstop in group.backstops() {
            let place = near.bodies.binary_search(&backstop.body.index).unwrap_or(0);
            let center = view.bodies.at(backstop.body.index).principal_from_body.point(backstop.center);
            let at = |pose: &Transform| Transform::from_translation(pose.point(center));
            self.obstacles.push(Obstacle {
                shape: Shape::Sphere { radius: backstop.radius },
                previous: at(&seen[place].start),
                world_from_shape: at(&seen[place].pose),
                body: place as u32,
                material: Material::DEFAULT,
            });
        }
    }

    /// Applies the impulses of a group to the island's bodies.
    fn push_bodies(&mut self, TakenGroup { group, near, .. }: &TakenGroup, solver: &mut IslandSolver) {
        let seen = &self.seen;
        self.impulses.clear();
        self.impulses.resize(solver.moving_bodies().len(), ZERO6);
        let mut given = 0.0;
        let mut push = |place: usize, point: Vec3, impulse: Vec3| {
            let Seen { pose, velocity, local, .. } = &seen[place];
            let arm = point - pose.translation;
            match *local {
                Some(local) => add_scaled(&mut self.impulses[local], &wrench(arm, impulse), 1.0),
                // A kinematic body does work; a static one has no velocity.
                None => given -= impulse.dot(linear(velocity) + angular(velocity).cross(arm)),
            }
        };
        for hit in group.body_impulses() {
            push(hit.body as usize, hit.point, hit.impulse);
        }
        for (k, attachment) in group.attachments().iter().enumerate() {
            if let AttachmentTarget::Body { body, .. } = attachment.target {
                let place = near.bodies.binary_search(&body.index).unwrap_or(0);
                push(place, self.anchors[k].position, group.attachment_impulses()[k]);
            }
        }
        solver.work.kinematic += given;
        self.push(solver);
    }
}
