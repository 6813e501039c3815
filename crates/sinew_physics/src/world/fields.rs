//! World methods for fields: creation, changes, queries.

use crate::body::def::BodyKind;
use crate::body::force::Wrench;
use crate::field::{
    Attractor, FieldDef, FieldFunction, FieldKind, Fields, Load, MutualGravity, Region, Target, attractor,
};
use crate::id::{BodyId, FieldId, GroupId};
use crate::world::World;
use sinew_math::Vec3;

impl World {
    /// Adds a field; all bodies and particle groups that it reaches wake.
    ///
    /// # Panics
    /// If [`FieldDef::check`] rejects the definition, or a user function is not registered.
    pub fn add_field(&mut self, def: &FieldDef) -> FieldId {
        self.check_field(def);
        self.keep_region(def);
        self.wake_reached(def);
        self.fields.insert(def.clone())
    }

    /// Replaces the definition of a field; all bodies and particle groups that the old or new field reaches wake.
    ///
    /// # Panics
    /// If [`FieldDef::check`] rejects the definition, or a user function is not registered.
    #[track_caller]
    pub fn set_field(&mut self, id: FieldId, def: &FieldDef) {
        self.check_field(def);
        self.keep_region(def);
        let before = self.field(id).clone();
        self.wake_reached(&before);
        self.wake_reached(def);
        *self.fields.expect_mut(id) = def.clone();
    }

    /// Removes a field; all bodies and particle groups that it reached wake.
    #[track_caller]
    pub fn remove_field(&mut self, id: FieldId) {
        let before = self.fields.take(id);
        self.wake_reached(&before);
    }

    /// Returns the current definition of a field.
    #[track_caller]
    pub fn field(&self, id: FieldId) -> &FieldDef {
        self.fields.expect(id)
    }

    /// Iterates over all fields, by index.
    pub fn field_ids(&self) -> impl Iterator<Item = FieldId> {
        self.fields.ids()
    }

    /// True if the id names an existing field.
    pub fn contains_field(&self, id: FieldId) -> bool {
        self.fields.get(id).is_some()
    }

    /// Registers a function for [`FieldKind::Custom`] under a number of the user's choice, replacing an earlier
    /// function.
    ///
    /// A snapshot contains the number and the parameters, not the code. Before a world loads a snapshot, the functions
    /// in the snapshot must be registered in the world, otherwise loading fails. Register the same function under the
    /// same number, or the future differs.
    pub fn register_field(&mut self, number: u32, function: FieldFunction) {
        self.functions.set(number, function);
    }

    /// Force (N) and torque about the centre of mass (N·m) that a field currently applies to a body, world axes. For a
    /// kinematic body they are those that the field would apply to a dynamic one, without mutual attraction; for a
    /// static body 0.
    #[track_caller]
    pub fn field_force(&self, id: FieldId, body: BodyId) -> Wrench {
        let (field, it) = (self.field(id), self.expect(body));
        if it.kind == BodyKind::Static {
            return Wrench::default();
        }
        if let FieldKind::Mutual(law) = &field.kind {
            let acts = it.kind == BodyKind::Dynamic;
            let force = if acts { self.attraction_of_all(field, law, body) } else { Vec3::ZERO };
            return Wrench { force, torque: Vec3::ZERO };
        }
        let mut load = Load::default();
        let target = Target { mass: it.weighs(), ..Target::of_body(it) };
        field.act(&target, &self.fields_now(), &mut load);
        load.wrench
    }

    /// Force that a field currently applies to a particle, N.
    ///
    /// # Panics
    /// If the particle does not exist.
    #[track_caller]
    pub fn field_force_on_particle(&self, id: FieldId, group: GroupId, particle: u32) -> Vec3 {
        let field = self.field(id);
        let target = Target::of_particle(self.particles(group), particle as usize);
        if let FieldKind::Mutual(law) = &field.kind {
            let own = attractor(field, &target);
            return self.attractors(field).map(|other| law.force(&own, &other)).sum();
        }
        let mut load = Load::default();
        field.act(&target, &self.fields_now(), &mut load);
        load.wrench.force
    }

    /// Velocity of the air at a position, m/s, world: the sum of all winds, each scaled by its region; 0 without winds.
    /// For effects outside the simulation.
    pub fn air_velocity(&self, point: Vec3) -> Vec3 {
        let nanoseconds = self.fields_now().nanoseconds;
        self.fields.iter().fold(Vec3::ZERO, |sum, (_, field)| match &field.kind {
            FieldKind::Wind(wind) => sum + wind.at(point, nanoseconds) * field.region.weight(point),
            _ => sum,
        })
    }

    /// Potential energy of all bodies and particles in a field, J: in uniform and point gravity, attraction, and
    /// displaced water. Other fields have none: drag dissipates, and a user function may not be conservative. Fields in
    /// a region have none either.
    #[track_caller]
    pub fn field_energy(&self, id: FieldId) -> f32 {
        let field = self.field(id);
        if let (FieldKind::Mutual(law), Region::Everywhere) = (&field.kind, &field.region) {
            return self.energy_of_pairs(field, law);
        }
        self.targets().fold(0.0, |sum, target| sum + field.energy(&target, self.def.gravity))
    }

    fn energy_of_pairs(&self, field: &FieldDef, law: &MutualGravity) -> f32 {
        let mut sum = 0.0;
        for (i, a) in self.attractors(field).enumerate() {
            for b in self.attractors(field).skip(i + 1) {
                sum += law.energy(&a, &b);
            }
        }
        sum
    }

    /// Attraction on `body` by all others, N. Attractors at the same position, including the body itself, add nothing.
    fn attraction_of_all(&self, field: &FieldDef, law: &MutualGravity, body: BodyId) -> Vec3 {
        let own = attractor(field, &Target::of_body(self.expect(body)));
        self.attractors(field).map(|other| law.force(&own, &other)).sum()
    }

    fn attractors<'a>(&'a self, field: &'a FieldDef) -> impl Iterator<Item = Attractor> + 'a {
        self.targets().map(|target| attractor(field, &target)).filter(|attractor| attractor.weight > 0.0)
    }

    /// Iterates over all dynamic bodies and all particles.
    fn targets(&self) -> impl Iterator<Item = Target<'_>> {
        let bodies = self.bodies.iter().filter(|(_, body)| body.mass > 0.0 && !body.quarantined);
        let particles = self
            .groups
            .iter()
            .flat_map(|(_, group)| (0..group.positions().len()).map(move |i| Target::of_particle(group, i)));
        bodies.map(|(_, body)| Target::of_body(body)).chain(particles)
    }

    fn fields_now(&self) -> Fields<'_> {
        Fields::new(&self.fields, &self.functions, &self.def, self.steps)
    }

    fn check_field(&self, def: &FieldDef) {
        if let Err(what) = def.check() {
            panic!("{what}");
        }
        if let FieldKind::Custom { function, .. } = def.kind {
            assert!(self.functions.has(function), "field function {function} is registered");
        }
    }

    fn keep_region(&mut self, def: &FieldDef) {
        if let Some(shape) = def.region.shape() {
            self.library.keep(shape);
        }
    }

    fn wake_reached(&mut self, def: &FieldDef) {
        for index in 0..self.bodies.slot_count() as u32 {
            let asleep = |body: &&crate::body::Body| !body.is_awake() && def.reaches(&Target::of_body(body));
            if self.bodies.try_at(index).filter(asleep).is_some() {
                self.wake_body(index);
            }
        }
        for (_, group) in self.groups.iter_mut().filter(|(_, group)| def.reaches_group(group)) {
            group.wake();
        }
    }
}
