//! The stage `prepare`: copies bodies, joints and contacts of the world to the arrays of one island's solver.

use crate::body::def::BodyKind;
use crate::body::external_work::Work;
use crate::body::{Body, Velocity};
use crate::collide::MAX_POINTS;
use crate::contact::{ContactMemory, slop};
use crate::island::Island;
use crate::joint::{DIRECTIONS, JointPose, JointRows, MAX_LIMITS};
use crate::runner::TaskRunner;
use crate::solver::IslandSolver;
use crate::solver::articulation::soft_row::SoftRow;
use crate::solver::articulation::tree::{Link, NONE};
use crate::solver::body::SolverBody;
use crate::solver::boundary::growth::Roots;
use crate::solver::boundary::tally::Tally;
use crate::solver::contact_rows::{ManifoldRows, ManifoldSource, PlacedShape};
use crate::solver::contacts::{Added, OfStep, placed};
use crate::solver::joint::SolverJoint;
use crate::solver::pass::Coupling;
use crate::solver::piles::touch::Touch;
use crate::solver::tuning::{
    BALLASTED_RATIO, BEYOND_MEASURE, FAST_APPROACH, MAX_EXACT_ROWS, REFRESH_TURN_RESPONSE,
};
use crate::solver::view::{View, lasting_force};
use crate::spatial::{Vec6, ZERO6, join};
use sinew_math::{Sym3, Vec3, min};

/// Number of additional bodies and contacts for which memory is reserved, so that small changes of an island need no allocation.
const SPARE: usize = 32;

impl IslandSolver {
    /// Fills the solver with an island of the world.
    pub fn prepare(&mut self, island: &Island<'_>, view: &View<'_>, runner: &dyn TaskRunner) {
        self.choose_substeps(island, view);
        self.displaced = false;
        self.disturbed = false;
        self.work = Work::default();
        self.tally = Tally::default();
        (self.max_speed, self.max_turn) = (view.def.max_speed, view.def.max_turn);
        self.order_trees(island, view);
        self.make_room(island);
        self.copy_bodies(island, view);
        self.look_for_fields(view);
        self.copy_joints(island, view);
        self.find_joint_masses();
        // The user may have changed motors since the last step, so that they no longer saturate.
        self.release_motors();
        self.refresh_rows();
        self.choose_coupling(island.contacts.len());
        self.form_batches();
        self.note_touches(island, view);
        self.refresh_inertia();
        self.choose_policy();
        self.limits.clear();
        self.manifolds.clear();
        if self.is_in_lanes() {
            self.prepare_contacts(view, runner);
        } else {
            self.copy_contacts(island, view);
        }
        if !self.has_joints() {
            return;
        }
        self.factor_joints();
        self.choose_limits();
        self.refresh_response();
    }

    /// Forms batches of trees in heaps. Loops and pins need the responses of single links, so islands with them have no batches.
    fn form_batches(&mut self) {
        if self.coupling == Coupling::Turns && self.loops.is_empty() && self.pins.joints.is_empty() {
            self.batches.form(&self.links, &self.joints, &self.trees);
            for tree in (0..self.trees.len()).filter(|&tree| self.batches.have(tree)) {
                for link in &mut self.links[self.trees[tree].clone()] {
                    link.push_all_gains(&self.joints);
                }
            }
        } else {
            self.batches.clear(self.links.len());
        }
    }

    /// Reserves memory that only islands with joints need, also for an island without joints: the next island may reuse it.
    fn make_room(&mut self, island: &Island<'_>) {
        let s = &mut self.scratch;
        let lists = [
            &mut s.residuals,
            &mut s.impulses,
            &mut s.dv,
            &mut s.swept,
            &mut self.moved,
            &mut self.accounted,
        ];
        for list in lists {
            list.clear();
            list.reserve(island.bodies.len());
        }
        s.pieces.clear();
        s.pieces.reserve(island.bodies.len());
        s.motor_impulses.clear();
        s.motor_impulses.reserve(DIRECTIONS * island.joints.len());
        for errors in [&mut s.errors, &mut s.errors_left, &mut s.tolerances] {
            errors.clear();
            errors.reserve(island.bodies.len());
        }
        for trees in [&mut s.corrected, &mut s.looked_at] {
            trees.clear();
            trees.reserve(island.bodies.len());
        }
        self.batches.make_room(island.bodies.len());
        self.pins.make_room(island.bodies.len(), island.joints.len());
        s.loads.make_room(island.bodies.len() + SPARE, island.contacts.len() + SPARE);
        self.conjugate.make_room(island.bodies.len(), island.contacts.len());
        s.build.faces.make_room(island.bodies.len() + SPARE);
        self.touches.clear();
        self.touches.reserve(island.contacts.len() + SPARE);
        self.paired.clear();
        self.paired.reserve(island.bodies.len() + SPARE);
        self.starts.clear();
        self.starts.reserve(island.bodies.len() + SPARE);
        self.contacts.clear();
        self.contacts.make_room(island.bodies.len() + SPARE, island.contacts.len() + SPARE);
        self.bounces = false;
        self.bounced_from.clear();
        self.bounced_from.reserve(island.bodies.len() + SPARE);
    }

    /// Builds the spanning trees. One tree for each connected component keeps the number of loops small, and these are solved exactly. If
    /// there are too many loops for that, all bodies jointed to fixed ones become roots at the same time, so that parallel ropes become
    /// separate trees.
    fn order_trees(&mut self, island: &Island<'_>, view: &View<'_>) {
        self.span(island, view, Roots::InTurn);
        if self.is_entangled(island, view) {
            self.span(island, view, Roots::AtOnce);
        }
    }

    /// Builds spanning trees by breadth-first search: first from bodies jointed to fixed ones (a tree has at most one ground), then from
    /// the remaining body with the smallest index.
    fn span(&mut self, island: &Island<'_>, view: &View<'_>, roots: Roots) {
        let s = &mut self.scratch.build;
        s.seeds.clear();
        s.sizes.clear();
        s.grown = 0;
        s.local.clear();
        s.local.resize(island.bodies.len(), NONE);
        s.used.clear();
        s.used.resize(island.joints.len(), false);
        s.list_adjacent(island, view);
        for (j, &index) in island.joints.iter().enumerate() {
            let joint = view.joints.at(index);
            if let [Some(root), None] | [None, Some(root)] =
                [joint.a, joint.b].map(|body| s.place_of(island, body))
                && s.local[root as usize] == NONE
                && !joint.leaves_all_free()
            {
                s.plant(root, j as u32);
                if roots == Roots::InTurn {
                    s.grow(island, view);
                }
            }
        }
        s.grow(island, view);
        for root in 0..island.bodies.len() as u32 {
            if s.local[root as usize] == NONE {
                s.plant(root, NONE);
                s.grow(island, view);
            }
        }
        self.number_links(island);
    }

    /// Returns true if a tree has more loops than can be solved exactly, or if there are loops between trees.
    fn is_entangled(&mut self, island: &Island<'_>, view: &View<'_>) -> bool {
        let mut loop_rows = core::mem::take(&mut self.scratch.build.loop_rows);
        let s = &self.scratch.build;
        loop_rows.clear();
        loop_rows.resize(self.trees.len(), 0);
        let mut is_entangled = false;
        let tree = |body: u32| {
            let place = s.place_of(island, body)?;
            Some(self.links[s.local[place as usize] as usize].tree as usize)
        };
        for (&index, _) in island.joints.iter().zip(&s.used).filter(|(_, used)| !**used) {
            let joint = view.joints.at(index);
            let tree = match (tree(joint.a), tree(joint.b)) {
                (Some(a), Some(b)) if a != b => {
                    is_entangled = true;
                    break;
                }
                (Some(_), None) | (None, Some(_)) if joint.leaves_all_free() => continue,
                (a, b) => a.or(b).unwrap_or(0),
            };
            loop_rows[tree] += joint.most_rows();
        }
        is_entangled |= loop_rows.iter().any(|&rows| rows > MAX_EXACT_ROWS);
        self.scratch.build.loop_rows = loop_rows;
        is_entangled
    }

    /// Assigns local indices, tree by tree, parents first.
    fn number_links(&mut self, island: &Island<'_>) {
        let s = &mut self.scratch.build;
        s.seeds.sort_unstable_by_key(|seed| (seed.tree, seed.found));
        s.order.clear();
        for (local, seed) in s.seeds.iter().enumerate() {
            s.local[seed.place as usize] = local as u32;
        }
        self.trees.clear();
        for (local, seed) in s.seeds.iter().enumerate() {
            match self.trees.get_mut(seed.tree as usize) {
                Some(tree) => tree.end = local + 1,
                None => self.trees.push(local..local + 1),
            }
            let parent = if seed.parent == NONE { NONE } else { s.local[seed.parent as usize] };
            s.order.push(island.bodies[seed.place as usize]);
            // The factor writes the responses of links, so their memory need not be cleared.
            match self.links.get_mut(local) {
                Some(link) => (link.parent, link.joint, link.tree) = (parent, seed.joint, seed.tree),
                None => self.links.push(Link::new(parent, seed.joint, seed.tree)),
            }
        }
        self.links.truncate(s.seeds.len());
    }

    fn copy_bodies(&mut self, island: &Island<'_>, view: &View<'_>) {
        let s = &mut self.scratch.build;
        for (local, &index) in s.order.iter().enumerate() {
            s.local_of[index as usize] = local as u32;
        }
        s.list_fixed(island, view);
        s.faces.clear();
        self.bodies.clear();
        self.velocities.clear();
        let ordered = s.order.iter().copied();
        for index in ordered.chain(s.fixed.iter().copied()) {
            s.local_of[index as usize] = self.bodies.len() as u32;
            let body = view.bodies.at(index);
            let (force, torque) = lasting_force(body, view);
            self.bodies.push(SolverBody {
                index,
                pose: body.world_from_principal,
                mass: body.mass,
                inertia: body.inertia,
                excess: Vec3::ZERO,
                mass_scale: 1.0,
                inverse_inertia: Sym3::ZERO,
                force,
                torque,
                momentum: Vec3::ZERO,
                linear_damping: body.linear_damping,
                angular_damping: body.angular_damping,
                is_limited: false,
            });
            let still = body.kind == crate::BodyKind::Dynamic && !body.is_active();
            let most = [view.def.max_speed, view.def.max_turn / self.h];
            let velocity = if still { ZERO6 } else { seen_velocity(body, most) };
            self.velocities.push(velocity);
            s.faces.push(body, body.velocity.angular.length() * self.h >= 0.5 * REFRESH_TURN_RESPONSE);
        }
        self.scratch.predicted.clear();
        self.scratch.predicted.reserve(self.bodies.len());
    }

    /// Local index of a world body.
    fn local(&self, body: u32) -> u32 {
        self.scratch.build.local_of[body as usize]
    }

    fn copy_joints(&mut self, island: &Island<'_>, view: &View<'_>) {
        self.joints.clear();
        self.loops.clear();
        self.pins.clear();
        for (place, &index) in island.joints.iter().enumerate() {
            let joint = view.joints.at(index);
            let (a, b) = (self.local(joint.a), self.local(joint.b));
            let geometry = joint.geometry();
            let pose =
                JointPose::new(&geometry, &self.bodies[a as usize].pose, &self.bodies[b as usize].pose);
            self.joints.push(SolverJoint {
                index,
                a,
                b,
                geometry,
                drive: joint.drive,
                pose,
                rows: JointRows::NONE,
                rigid: 0,
                left_open: ZERO6,
                most_rows: joint.most_rows(),
                soft: [SoftRow::default(); DIRECTIONS],
                driven: [SoftRow::default(); DIRECTIONS],
                bent: ZERO6,
                bent_before: ZERO6,
                mass: ZERO6,
                least_mass: ZERO6,
                start_rate: ZERO6,
                saturated: joint.saturated,
                exceeded: [0; DIRECTIONS],
                limits: joint.limits.map(|limit| limit.of_substeps(self.stretch)),
                least_slack: f32::NEG_INFINITY,
                slack_before: f32::NEG_INFINITY,
                limit_impulse: [Vec3::ZERO; MAX_LIMITS],
                force: joint.force,
                impulse: ZERO6,
                warm_impulse: joint.warm_impulse.map(|impulse| impulse * self.stretch),
                reaction: ZERO6,
                accounted: ZERO6,
            });
            let moving = self.links.len() as u32;
            if joint.leaves_all_free() && (a < moving) != (b < moving) {
                self.pins.joints.push(place as u32);
            } else if !self.scratch.build.used[place] {
                self.loops.joints.push(place as u32);
            }
        }
        self.loops.group(&self.joints, &self.links);
        // The parent of a grounded root is the fixed body of its joint.
        for i in 0..self.links.len() {
            let link = &self.links[i];
            if link.parent == NONE && link.joint != NONE {
                let joint = &self.joints[link.joint as usize];
                self.links[i].parent = if joint.a as usize == i { joint.b } else { joint.a };
            }
        }
    }

    /// Lists the touching pairs, and the loads on bodies without joints. Collects contacts that are solved in lanes.
    fn note_touches(&mut self, island: &Island<'_>, view: &View<'_>) {
        let mut faces = core::mem::take(&mut self.scratch.build.faces);
        let mut contacts = core::mem::take(&mut self.contacts);
        let (in_lanes, moving) = (self.is_in_lanes(), self.links.len());
        self.paired.clear();
        self.paired.resize(moving, false);
        for &index in island.contacts {
            let contact = &view.contacts[index as usize];
            let key = contact.key;
            let bodies = [key.a, key.b].map(|body| self.local(body));
            let moves = bodies.map(|body| (body as usize) < moving);
            if moves == [true; 2] && !self.is_jointed(bodies[0]) && !self.is_jointed(bodies[1]) {
                bodies.into_iter().for_each(|body| self.paired[body as usize] = true);
            }
            let sides = faces.of(view, key, bodies);
            let slop = slop(min(sides[0].smallest_extent, sides[1].smallest_extent));
            self.touches.push(Touch::new(bodies, contact, self.stretch, slop));
            if !in_lanes {
                continue;
            }
            // A contact whose body spins or approaches fast may get more points within the step.
            let is_fast = contact.approach > FAST_APPROACH || sides[0].turns || sides[1].turns;
            let is_curved = sides[0].is_curved || sides[1].is_curved;
            let of_shapes = !key.is_through_particles();
            let added = Added {
                index,
                contact,
                bodies,
                moves,
                points: if is_fast && of_shapes { MAX_POINTS } else { contact.manifold.count },
                firmness: self.firmness(bodies),
                slop,
                material: faces.material(view, index, &sides),
                curved: (is_curved && of_shapes).then(|| placed(view, contact)),
            };
            contacts.push(&added, &self.bodies);
        }
        self.support.count(moving, self.bodies.len(), &self.touches);
        self.is_unequal = self.mass_ratio() >= BALLASTED_RATIO;
        self.guess_loads();
        if in_lanes {
            for (place, (touch, &index)) in self.touches.iter().zip(island.contacts).enumerate() {
                if let Some(points) = touch.started(&view.contacts[index as usize], self.stretch) {
                    contacts.start_with(place, &points);
                }
            }
        }
        (self.contacts, self.scratch.build.faces) = (contacts, faces);
        self.scale_masses();
    }

    /// Prepares the contacts that are solved in lanes.
    fn prepare_contacts(&mut self, view: &View<'_>, runner: &dyn TaskRunner) {
        self.starts.clear();
        self.starts.extend(self.bodies.iter().map(|body| body.pose));
        let (bodies, moving) = (&self.bodies, self.links.len());
        let of_step = OfStep { view, bodies, moving, h: self.h, stretch: self.stretch, runner };
        self.driven = self.contacts.prepare(&of_step);
    }

    fn copy_contacts(&mut self, island: &Island<'_>, view: &View<'_>) {
        self.driven = false;
        for (&index, touch) in island.contacts.iter().zip(&self.touches) {
            let contact = &view.contacts[index as usize];
            let (a, b) = (view.bodies.at(contact.key.a), view.bodies.at(contact.key.b));
            let shape_a = &a.shapes[contact.key.shape_a as usize];
            let shape_b = &b.shapes[contact.key.shape_b as usize];
            let extent = min(shape_a.shape.smallest_extent(), shape_b.shape.smallest_extent());
            let points = touch.started(contact, self.stretch).unwrap_or(contact.memory.points);
            let memory = ContactMemory { points, ..contact.memory };
            let source = ManifoldSource {
                contact: index,
                through_particles: contact.key.is_through_particles(),
                a: self.local(contact.key.a),
                b: self.local(contact.key.b),
                a_moves: a.is_active(),
                b_moves: b.is_active(),
                manifold: &contact.manifold,
                memory: memory.of_substeps(self.stretch),
                material: view.modifiers.material(view.bodies, view.contacts, index),
                slop: slop(extent),
                shapes: [shape_a, shape_b].map(|s| PlacedShape::new(s.shape.clone(), s.principal_from_shape)),
                h: self.h,
            };
            self.driven |= source.material.drives();
            let firmness = self.firmness([source.a, source.b]);
            let mut rows = ManifoldRows::new(&source, &self.bodies);
            rows.set_firmness(firmness);
            self.manifolds.push(rows);
        }
    }
}

/// Velocity of a body as the rows use it, clamped by the largest speed and spin of bodies, m/s and rad/s.
///
/// Rows extrapolate along tangents, and the tangent of a kinematic body with an extreme spin leads to positions that its surface never
/// reaches. A dynamic body that was given an extreme speed keeps a finite approach speed until its forces are integrated and slow it;
/// otherwise its bounce would have no finite speed.
fn seen_velocity(body: &Body, [max_speed, max_spin]: [f32; 2]) -> Vec6 {
    let Velocity { linear, angular } = body.velocity;
    match body.kind {
        BodyKind::Kinematic => join(linear, held_to(angular, max_spin, 1.0)),
        _ => join(held_to(linear, max_speed, BEYOND_MEASURE), held_to(angular, max_spin, BEYOND_MEASURE)),
    }
}

/// Clamps the length of a vector to `beyond` times `most`.
fn held_to(v: Vec3, most: f32, beyond: f32) -> Vec3 {
    // Squares of any `f32` are finite in `f64`.
    let square = [v.x, v.y, v.z].map(f64::from).iter().map(|x| x * x).sum::<f64>();
    let bound = f64::from(most) * f64::from(beyond);
    if square <= bound * bound {
        return v;
    }
    let share = bound / square.sqrt();
    Vec3::from_array([v.x, v.y, v.z].map(|x| (f64::from(x) * share) as f32))
}
