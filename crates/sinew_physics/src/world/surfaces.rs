//! World methods for surfaces of shapes and for contacts.

use crate::body::contact_rule::ContactRule;
use crate::body::material::{ContactMaterial, Material};
use crate::body::shape::{Filter, Sensing};
use crate::body::surface::Surface;
use crate::collide::MAX_POINTS;
use crate::contact::tracking::shape_ids;
use crate::contact::{Contact, Effect};
use crate::id::{BodyId, ShapeId};
use crate::world::World;
use sinew_math::Vec3;

/// A contact of two shapes after the last step. A pair may have several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyContact {
    /// Shape of the body with the smaller index.
    pub a: ShapeId,
    /// Shape of the other body.
    pub b: ShapeId,
    /// Unit normal from A to B, world axes.
    pub normal: Vec3,
    /// Effect of the contact.
    pub effect: Effect,
    /// Contact material of the two shapes, before a contact modifier changes it.
    pub material: ContactMaterial,
    /// Total friction impulse on B in the step, N·s, world axes; the impulse on A is the opposite.
    pub friction: Vec3,
    points: [ContactPoint; MAX_POINTS],
    count: usize,
}

impl BodyContact {
    /// Returns the contact points, touching or near; at least one.
    pub fn points(&self) -> &[ContactPoint] {
        &self.points[..self.count]
    }

    /// Sum of the normal impulses of the points in the step, N·s.
    pub fn impulse(&self) -> f32 {
        self.points().iter().fold(0.0, |sum, point| sum + point.impulse)
    }
}

/// A point of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactPoint {
    /// Midpoint between the surfaces, world, metres, at the last update.
    pub position: Vec3,
    /// Gap along the normal at the last update, metres; negative if the surfaces overlapped.
    pub separation: f32,
    /// Total normal impulse in the step, N·s.
    pub impulse: f32,
}

impl World {
    /// Iterates over the contacts of a body, including near ones that do not touch, in the order of pairs.
    #[track_caller]
    pub fn contacts_of(&self, id: BodyId) -> impl Iterator<Item = BodyContact> {
        self.expect(id);
        self.contacts().filter(move |contact| contact.a.body == id || contact.b.body == id)
    }

    /// Iterates over all contacts, including near ones that do not touch, in the order of pairs.
    pub fn contacts(&self) -> impl Iterator<Item = BodyContact> {
        let near = |contact: &&Contact| contact.manifold.count > 0;
        self.contacts_in_order().filter(near).map(|contact| self.body_contact(contact))
    }

    fn body_contact(&self, contact: &Contact) -> BodyContact {
        let (a, b) = shape_ids(&self.bodies, contact.key);
        let mut points = [ContactPoint::default(); MAX_POINTS];
        for (i, point) in contact.manifold.points().iter().enumerate() {
            let impulse = contact.memory.points[i].total;
            points[i] = ContactPoint { position: point.position, separation: point.separation, impulse };
        }
        BodyContact {
            a,
            b,
            normal: contact.manifold.normal,
            effect: contact.effect,
            material: contact.material(&self.bodies),
            friction: contact.memory.total_friction,
            points,
            count: contact.manifold.count,
        }
    }

    /// Iterates over the shapes of a body.
    #[track_caller]
    pub fn shape_ids(&self, body: BodyId) -> impl Iterator<Item = ShapeId> + use<> {
        (0..self.expect(body).shapes.len() as u32).map(move |shape| ShapeId { body, shape })
    }

    /// Material of a shape.
    #[track_caller]
    pub fn material(&self, id: ShapeId) -> Material {
        self.expect_surface(id).material
    }

    /// Collision filter of a shape.
    #[track_caller]
    pub fn filter(&self, id: ShapeId) -> Filter {
        self.expect_surface(id).filter
    }

    /// Effect of a shape on the shapes it touches: solid or sensor.
    #[track_caller]
    pub fn sensing(&self, id: ShapeId) -> Sensing {
        self.expect_surface(id).sensing
    }

    /// Rule for a shape's contacts.
    #[track_caller]
    pub fn contact_rule(&self, id: ShapeId) -> ContactRule {
        self.expect_surface(id).rule
    }

    /// Changes a shape's material from the next step on. The body and its touching bodies wake; the mass does not
    /// change.
    ///
    /// # Panics
    /// If [`Material::check`] rejects the material.
    #[track_caller]
    pub fn set_material(&mut self, id: ShapeId, material: Material) {
        if let Err(what) = material.check() {
            panic!("{what}");
        }
        self.change_surface(id, |surface| surface.material = material);
    }

    /// Changes a shape's filter from the next step on, which also reports ended touches. The body and its touching
    /// bodies wake.
    #[track_caller]
    pub fn set_filter(&mut self, id: ShapeId, filter: Filter) {
        self.change_surface(id, |surface| surface.filter = filter);
    }

    /// Makes a shape solid or a sensor from the next step on. Its touches end and begin again as the other kind of
    /// event. The body and its touching bodies wake.
    #[track_caller]
    pub fn set_sensing(&mut self, id: ShapeId, sensing: Sensing) {
        self.change_surface(id, |surface| surface.sensing = sensing);
    }

    /// Changes a shape's contact rule from the next step on. The body and its touching bodies wake.
    ///
    /// # Panics
    /// If [`ContactRule::check`] rejects the rule, or a modifier is not registered.
    #[track_caller]
    pub fn set_contact_rule(&mut self, id: ShapeId, rule: ContactRule) {
        if let Err(what) = rule.check() {
            panic!("{what}");
        }
        self.expect_modifier(rule);
        self.change_surface(id, |surface| surface.rule = rule);
    }

    #[track_caller]
    fn change_surface(&mut self, id: ShapeId, change: impl FnOnce(&mut Surface)) {
        self.expect_shape(id);
        self.mark_changed(id.body);
        let body = self.bodies.at_mut(id.body.index);
        let mut surface = *body.surface(id.shape as usize);
        change(&mut surface);
        let number = body.shapes[id.shape as usize].surface;
        if body.shapes.iter().filter(|shape| shape.surface == number).count() == 1 {
            body.surfaces.set(number, surface);
        } else {
            body.shapes[id.shape as usize].surface = body.surfaces.intern(&surface);
        }
        self.broad.proxies.refresh(id.body.index, self.bodies.at(id.body.index));
    }

    /// Makes the next step test a body's contacts again even if nothing moves; the body and its neighbours wake.
    #[track_caller]
    pub(crate) fn mark_changed(&mut self, id: BodyId) {
        self.look_anew(id);
        self.wake_neighbors(id.index);
    }

    /// Makes the next step test a body's contacts again even if nothing moves; wakes no body.
    #[track_caller]
    pub(crate) fn look_anew(&mut self, id: BodyId) {
        let body = self.expect_mut(id);
        if !core::mem::replace(&mut body.changed, true) {
            self.meetings.changed.push(id.index);
        }
        self.activity.recall(id.index);
    }
}
