//! Adds sheets to the world, shows them and removes them.

use super::rig::{Column, GarmentRig, Hanging, Moves};
use super::sheet::{Sheet, cleared};
use crate::def::RagdollDef;
use crate::tuning::{CAUGHT, DRAPINGS};
use sinew_anim::LocalTransform;
use sinew_math::{Affine, ReadError, Reader, Rotation, Transform, Vec3, Writer, max};
use sinew_physics::particles::{AttachmentDef, AttachmentTarget, BackstopDef, GroupDef, SpringDef};
use sinew_physics::{BodyId, GroupId, Shape, World};

/// Garments worn by one character. Default: none.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Worn {
    /// Particles of each sheet; empty while no garment is worn.
    pub groups: Vec<GroupId>,
    /// Local rotation of every bone and every particle's joint, as shown.
    pub turns: Vec<Rotation>,
    /// Local position of every particle's joint, file units.
    pub places: Vec<Vec3>,
}

impl Worn {
    /// Removes the sheets from the world.
    pub fn take_off(&mut self, world: &mut World) {
        self.groups.drain(..).for_each(|group| world.remove_particles(group));
        self.turns.clear();
        self.places.clear();
    }

    /// Returns the positions and velocities of all particles, sheet by sheet.
    pub fn lie(&self, world: &World) -> Vec<(Vec<Vec3>, Vec<Vec3>)> {
        let there = self.groups.iter().filter(|&&id| world.group_ids().any(|known| known == id));
        let lie = |&id: &GroupId| {
            let group = world.particles(id);
            (group.positions().to_vec(), group.velocities().to_vec())
        };
        there.map(lie).collect()
    }

    /// Restores positions and velocities of all particles.
    pub fn lay(&self, world: &mut World, was: &[(Vec<Vec3>, Vec<Vec3>)]) {
        for (&id, (positions, velocities)) in self.groups.iter().zip(was) {
            let group = world.particles_mut(id);
            for (particle, (&position, &velocity)) in positions.iter().zip(velocities).enumerate() {
                group.set_position(particle as u32, position);
                group.set_velocity(particle as u32, velocity);
            }
        }
    }

    /// Moves the sheets with a wearer that was teleported, without changing their shape.
    pub fn carry(&self, world: &mut World, moved: Transform) {
        for &id in &self.groups {
            let group = world.particles_mut(id);
            for particle in 0..group.positions().len() {
                let (position, velocity) = (group.positions()[particle], group.velocities()[particle]);
                group.set_position(particle as u32, moved.point(position));
                group.set_velocity(particle as u32, moved.rotation * velocity);
            }
        }
    }

    /// Writes the simulated and the shown state.
    pub fn save(&self, w: &mut Writer) {
        w.count(self.groups.len());
        self.groups.iter().for_each(|group| w.u64(group.to_bits()));
        w.count(self.turns.len());
        self.turns.iter().for_each(|&turn| w.rotation(turn));
        self.places.iter().for_each(|&place| w.vec3(place));
    }

    /// Restores garments of the same rig.
    ///
    /// # Errors
    /// If they belong to another rig, or the bytes end too early.
    pub fn load(rig: &GarmentRig, r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut worn = Self::default();
        for _ in 0..r.count(8)? {
            worn.groups.push(GroupId::from_bits(r.u64()?));
        }
        for _ in 0..r.count(16)? {
            worn.turns.push(r.rotation()?);
        }
        let fits = |count: usize, whole: usize| count == 0 || count == whole;
        if !fits(worn.groups.len(), rig.sheets.len()) || !fits(worn.turns.len(), rig.joints().len()) {
            return Err(r.error("wears other garments"));
        }
        let places = if worn.turns.is_empty() { 0 } else { rig.moving().len() };
        for _ in 0..places {
            worn.places.push(r.vec3()?);
        }
        let is_finite = worn.turns.iter().all(|turn| turn.is_finite())
            && worn.places.iter().all(|place| place.is_finite());
        if !is_finite {
            return Err(r.error("wears what is nowhere"));
        }
        Ok(worn)
    }
}

/// The wearer: pose and bodies at the same time.
#[derive(Clone, Copy)]
pub(crate) struct Wearer<'a> {
    pub rig: &'a GarmentRig,
    pub ragdoll: &'a RagdollDef,
    /// Local transform of every joint of the rig.
    pub pose: &'a [LocalTransform],
    pub world_from_model: Affine,
    /// Bodies in the world, in the order of the definition.
    pub bodies: &'a [BodyId],
    /// Severed bodies with their ids, by index, ascending.
    pub lost: &'a [(usize, BodyId)],
}

impl Wearer<'_> {
    /// Adds a group of particles to the world for each sheet, at the pose's positions moved out of the bodies.
    pub fn put_on(&self, world: &mut World) -> Vec<GroupId> {
        let nodes = self.nodes();
        let mut groups = Vec::with_capacity(self.rig.sheets.len());
        for index in 0..self.rig.sheets.len() {
            let places = self.places(index, &nodes);
            groups.push(self.put_on_sheet(world, &self.rig.sheets[index], &places));
        }
        groups
    }

    /// Returns true if these groups exist in the world and have the sheets' particles: a snapshot may come from another
    /// world.
    fn fits(&self, world: &World, groups: &[GroupId]) -> bool {
        let is_there = |&id: &GroupId| world.group_ids().any(|known| known == id);
        let fits = |(sheet, &id): (&Sheet, &GroupId)| {
            is_there(&id) && world.particles(id).positions().len() == sheet.strand.len()
        };
        groups.len() == self.rig.sheets.len() && self.rig.sheets.iter().zip(groups).all(fits)
    }

    /// Returns the world positions of a sheet's particles in the pose, with the nodes at `nodes`.
    fn places(&self, sheet: usize, nodes: &[Affine]) -> Vec<Vec3> {
        let way = |column: &Column| {
            let mut way: Vec<Vec3> = column.nodes.iter().map(|&node| nodes[node].translation).collect();
            let last = column.nodes[column.nodes.len() - 1];
            way.extend(column.tip.map(|tip| nodes[last].point(tip)));
            way
        };
        match (&self.rig.sheets[sheet].grid, &self.rig.hung[sheet]) {
            (Some(grid), Hanging::Columns(columns)) => {
                let ways: Vec<Vec<Vec3>> = columns.iter().map(way).collect();
                let mut places = Vec::new();
                grid.places(&ways, &mut places);
                places
            }
            (_, Hanging::Columns(_)) => Vec::new(),
            (_, Hanging::Particles(particles)) => {
                particles.iter().map(|&node| nodes[node].translation).collect()
            }
        }
    }

    /// Moves lines back to the pose if bodies have caught one of their threads, which is then far too long. A clip that
    /// folds the body onto its skirt may leave a part of the skirt on the wrong side.
    pub fn mend(&self, world: &mut World, groups: &[GroupId]) {
        if !self.fits(world, groups) {
            return;
        }
        for (index, (sheet, &id)) in self.rig.sheets.iter().zip(groups).enumerate() {
            let at = world.particles(id).positions();
            let is_caught = |thread: &&SpringDef| {
                let length = (at[thread.b as usize] - at[thread.a as usize]).length();
                length > CAUGHT * max(thread.rest_length, 0.5 * sheet.spacing)
            };
            let caught = sheet.group.springs.iter().filter(is_caught);
            let mut strands: Vec<usize> =
                caught.flat_map(|thread| [thread.a, thread.b]).map(|at| sheet.strand[at as usize]).collect();
            strands.sort_unstable();
            strands.dedup();
            if strands.is_empty() {
                continue;
            }
            let places = self.places(index, &self.nodes());
            let shapes = self.shapes(world, sheet);
            let is_free = |particle: &usize| !sheet.is_held[*particle];
            let hangs = |particle: &usize| strands.binary_search(&sheet.strand[*particle]).is_ok();
            for particle in (0..sheet.strand.len()).filter(is_free).filter(hangs) {
                let radius = sheet.group.particles[particle].radius;
                let place = cleared(places[particle], radius, &shapes.iter().copied());
                let velocity = self.carried(world, sheet.held_by[particle], place);
                let group = world.particles_mut(id);
                group.set_position(particle as u32, place);
                group.set_velocity(particle as u32, velocity);
            }
        }
    }

    /// Returns the shapes of the wearer that a sheet collides with, at their world poses.
    fn shapes(&self, world: &World, sheet: &Sheet) -> Vec<(&Shape, Transform)> {
        let bodies = self.ragdoll.bodies.iter().zip(self.bodies).enumerate();
        let met = bodies.filter(|(body, _)| !sheet.passed.contains(body) && self.has(*body));
        met.map(|(_, (body, &id))| (&body.shape, world.transform(id))).collect()
    }

    /// Returns true if a body still belongs to the wearer.
    fn has(&self, body: usize) -> bool {
        self.lost.iter().all(|&(lost, _)| lost != body)
    }

    /// Returns the nearest attached ancestor of a severed body; the body itself if it is attached.
    fn left_of(&self, body: usize) -> usize {
        let mut at = body;
        while !self.has(at) {
            at = self.ragdoll.joints[at - 1].parent;
        }
        at
    }

    /// Returns the world pose of a body; for a severed body, its pose at rest.
    fn frame(&self, world: &World, body: usize) -> Transform {
        let left = self.left_of(body);
        let bind = |body: usize| self.ragdoll.bodies[body].character_from_body;
        let frame = world.transform(self.bodies[left]);
        if left == body { frame } else { frame * (bind(left).inverse() * bind(body)) }
    }

    /// Returns the velocity of a body of the wearer at a point.
    fn carried(&self, world: &World, body: usize, point: Vec3) -> Vec3 {
        let body = self.bodies[self.left_of(body)];
        let velocity = world.velocity(body);
        velocity.linear + velocity.angular.cross(point - world.center_of_mass(body))
    }

    fn put_on_sheet(&self, world: &mut World, sheet: &Sheet, places: &[Vec3]) -> GroupId {
        let mut group = sheet.group.clone();
        let bind = |body: usize| self.ragdoll.bodies[body].character_from_body;
        for (index, particle) in group.particles.iter_mut().enumerate() {
            let body = sheet.held_by[index];
            let frame = self.frame(world, body);
            if sheet.is_held[index] && self.has(body) {
                // Use the bind-pose offset, independent of the clip: joints of bodies do not stretch.
                let point = bind(body).inverse_point(particle.position);
                let target = AttachmentTarget::Body { body: self.bodies[body], point };
                group.attachments.push(AttachmentDef { particle: index as u32, target });
                particle.position = frame.point(point);
            } else {
                let turn = frame.rotation * bind(body).rotation.inverse();
                particle.position = places[index] + turn * sheet.moved_out[index];
            }
        }
        let is_left = |particle: u32| self.has(sheet.held_by[particle as usize]);
        group.tethers.retain(|tether| is_left(tether.to));
        let backings = sheet.backings.iter().filter(|backing| self.has(backing.body));
        group.backstops.extend(backings.map(|backing| BackstopDef {
            particle: backing.particle as u32,
            body: self.bodies[backing.body],
            center: backing.center,
            radius: backing.radius,
        }));
        let passed = sheet.passed.iter().filter(|&&body| self.has(body));
        group.passes = passed.map(|&body| self.bodies[body]).collect();
        self.drape(world, sheet, &mut group);
        for (index, particle) in group.particles.iter_mut().enumerate() {
            let body = sheet.held_by[index];
            particle.velocity = self.carried(world, body, particle.position);
        }
        world.add_particles(&group)
    }

    /// Moves a held sheet out of the bodies and restores its lengths.
    fn drape(&self, world: &World, sheet: &Sheet, group: &mut GroupDef) {
        let shapes = self.shapes(world, sheet);
        let is_held = |particle: usize| sheet.is_held[particle];
        for _ in 0..DRAPINGS {
            for spring in &group.springs {
                let ends = [spring.a, spring.b].map(|at| at as usize);
                let [a, b] = ends.map(|at| group.particles[at].position);
                let length = (b - a).length();
                if length > spring.rest_length {
                    let free = ends.map(|at| if is_held(at) { 0.0 } else { 1.0 });
                    let by = (b - a) * ((1.0 - spring.rest_length / length) / (free[0] + free[1]));
                    group.particles[ends[0]].position += by * free[0];
                    group.particles[ends[1]].position -= by * free[1];
                }
            }
            for (_, particle) in group.particles.iter_mut().enumerate().filter(|(at, _)| !is_held(*at)) {
                particle.position = cleared(particle.position, particle.radius, &shapes.iter().copied());
            }
        }
    }

    /// Computes the local rotations of the following joints, in the order of [`GarmentRig::joints`], and the local
    /// positions of those that are particles, from the sheets in the world. If the sheets do not exist in this world,
    /// the garments are no longer worn and the next step adds them again.
    pub fn turns(&self, world: &World, worn: &mut Worn) {
        let Worn { groups, turns, places } = worn;
        turns.clear();
        places.clear();
        if !self.fits(world, groups) {
            groups.clear();
            return;
        }
        let mut rotations: Vec<Rotation> = Vec::with_capacity(self.rig.nodes.len());
        let mut frames: Vec<Affine> = Vec::with_capacity(self.rig.nodes.len());
        let root = self.world_from_model.to_rigid().rotation;
        for node in &self.rig.nodes {
            let above = node.parent.map_or(root, |parent| rotations[parent]);
            let above_frame = node.parent.map_or(self.world_from_model, |parent| frames[parent]);
            let mut local = self.pose[node.joint];
            let rest = local.rotation;
            match node.moves {
                Moves::Nothing => {}
                Moves::Bone(bone) => {
                    let bone = &self.rig.bones[bone];
                    let positions = world.particles(groups[bone.sheet]).positions();
                    if let Some(frame) = bone.frame(&self.rig.sheets[bone.sheet], positions) {
                        local.rotation =
                            (above.inverse() * frame * bone.frame_from_bone).normalize().toward(rest);
                    }
                    turns.push(local.rotation);
                }
                Moves::Particle(grain) => {
                    let grain = &self.rig.grains[grain];
                    let positions = world.particles(groups[grain.sheet]).positions();
                    let (place, turn) = grain.drawn(positions);
                    if let Some(frame) = turn {
                        local.rotation =
                            (above.inverse() * frame * grain.frame_from_bone).normalize().toward(rest);
                    }
                    // No such position exists under a joint that a clip scales to zero.
                    let at = above_frame.inverse().point(place);
                    if at.is_finite() {
                        local.translation = at;
                    }
                    turns.push(local.rotation);
                    places.push(local.translation);
                }
            }
            rotations.push(above * local.rotation);
            frames.push(above_frame * local.to_affine());
        }
    }

    /// Returns the world transforms of the nodes.
    fn nodes(&self) -> Vec<Affine> {
        let mut nodes: Vec<Affine> = Vec::with_capacity(self.rig.nodes.len());
        for node in &self.rig.nodes {
            let above = node.parent.map_or(self.world_from_model, |parent| nodes[parent]);
            nodes.push(above * self.pose[node.joint].to_affine());
        }
        nodes
    }
}
