//! World methods that add, replace and remove shapes of a body.

use crate::body::def::BodyKind;
use crate::body::shape::{Shape, ShapeDef};
use crate::body::surface::Surface;
use crate::body::{Body, expect_solid, principal_frame};
use crate::contact::ContactKey;
use crate::id::{BodyId, ShapeId};
use crate::world::World;
use sinew_math::{Transform, Vec3};

/// Treatment of a body's mass when its shapes change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MassUpdate {
    /// Recomputes mass, centre and inertia from the shapes' densities. Default.
    #[default]
    FromShapes,
    /// Leaves mass, centre and inertia unchanged.
    Keep,
}

/// Mass (kg), principal moments (kg·m²) and pose of the body's frame in its principal frame, after a change.
type Weight = (f32, Vec3, Transform);

impl World {
    /// Adds a shape to a body, as its last shape; the body wakes, with touching and jointed bodies. The next step
    /// reports the touches of the shape.
    ///
    /// ```
    /// use sinew_math::{Transform, Vec3};
    /// use sinew_physics::*;
    ///
    /// let mut world = World::new(WorldDef::default());
    /// let hammer = world.add_body(&BodyDef::dynamic(Shape::capsule(0.3, 0.02)));
    /// let handle = world.mass(hammer).mass;
    /// let head = ShapeDef {
    ///     body_from_shape: Transform::from_translation(Vec3::Y * 0.3),
    ///     density: 7800.0,
    ///     ..ShapeDef::new(Shape::cuboid(Vec3::new(0.1, 0.03, 0.03)))
    /// };
    /// let head = world.add_shape(hammer, &head, MassUpdate::FromShapes);
    /// assert!((world.mass(hammer).mass - handle - 7800.0 * 0.2 * 0.06 * 0.06).abs() < 1e-3);
    /// world.remove_shape(head, MassUpdate::FromShapes);
    /// assert!((world.mass(hammer).mass - handle).abs() < 1e-6);
    /// ```
    ///
    /// # Panics
    /// If the shape is not valid, is a half-space on a body that is not static, or names a modifier that is not registered,
    /// or a dynamic body would have no mass.
    #[doc(alias = "attach collider")]
    #[doc(alias = "add fixture")]
    #[track_caller]
    pub fn add_shape(&mut self, body: BodyId, def: &ShapeDef, mass: MassUpdate) -> ShapeId {
        self.check_shape(body, def);
        let id = ShapeId { body, shape: self.expect(body).shapes.len() as u32 };
        self.reshape(id, mass, |body| body.push_shape(def), |_| false);
        id
    }

    /// Replaces a shape of a body, keeping its id; the body wakes, with touching and jointed bodies. The next step
    /// reports touches that end, but not touches that continue.
    ///
    /// # Panics
    /// If the body has no such shape, the new shape is not valid, is a half-space on a body that is not static, or
    /// names a modifier that is not registered, or a dynamic body would have no mass.
    #[doc(alias = "set_collider_shape")]
    #[track_caller]
    pub fn set_shape(&mut self, id: ShapeId, def: &ShapeDef, mass: MassUpdate) {
        self.expect_shape(id);
        self.check_shape(id.body, def);
        let change = |body: &mut Body| {
            body.push_shape(def);
            body.shapes.swap_remove(id.shape as usize);
            body.tidy_surfaces();
        };
        self.reshape(id, mass, change, |shape| shape == id.shape);
    }

    /// Removes a shape from a body; the body wakes, with touching and jointed bodies. The numbers of the following
    /// shapes decrease by one. The next step reports the ended touches of the shape.
    ///
    /// # Panics
    /// If the body has no such shape, or a dynamic body would have no mass.
    #[doc(alias = "detach collider")]
    #[doc(alias = "destroy fixture")]
    #[track_caller]
    pub fn remove_shape(&mut self, id: ShapeId, mass: MassUpdate) {
        self.expect_shape(id);
        let change = |body: &mut Body| {
            body.shapes.remove(id.shape as usize);
            body.tidy_surfaces();
        };
        self.reshape(id, mass, change, |shape| shape >= id.shape);
    }

    /// Returns the geometry of a shape.
    #[track_caller]
    pub fn shape(&self, id: ShapeId) -> &Shape {
        self.expect_shape(id);
        &self.bodies.at(id.body.index).shapes[id.shape as usize].shape
    }

    /// Pose of a shape in the frame of its body.
    #[track_caller]
    pub fn body_from_shape(&self, id: ShapeId) -> Transform {
        self.expect_shape(id);
        let body = self.bodies.at(id.body.index);
        body.principal_from_body.inverse() * body.shapes[id.shape as usize].principal_from_shape
    }

    /// Returns the current definition of a shape.
    #[track_caller]
    pub fn shape_def(&self, id: ShapeId) -> ShapeDef {
        let body_from_shape = self.body_from_shape(id);
        let Surface { density, material, filter, sensing, rule } = *self.expect_surface(id);
        ShapeDef { shape: self.shape(id).clone(), body_from_shape, density, material, filter, sensing, rule }
    }

    #[track_caller]
    pub(super) fn expect_shape(&self, id: ShapeId) {
        let count = self.expect(id.body).shapes.len();
        assert!((id.shape as usize) < count, "{:?} has no shape {}", id.body, id.shape);
    }

    #[track_caller]
    pub(super) fn expect_surface(&self, id: ShapeId) -> &Surface {
        self.expect_shape(id);
        self.bodies.at(id.body.index).surface(id.shape as usize)
    }

    #[track_caller]
    fn check_shape(&self, body: BodyId, def: &ShapeDef) {
        if let Err(what) = def.check() {
            panic!("a body's shape is valid: {what} ({body:?})");
        }
        let is_endless = def.shape == Shape::HalfSpace;
        assert!(
            self.expect(body).kind == BodyKind::Static || !is_endless,
            "half-spaces are static bodies ({body:?})"
        );
        self.expect_modifier(def.rule);
    }

    /// Changes the shapes of a body and drops the contacts of shapes for which `goes` is true, by their old numbers.
    #[track_caller]
    fn reshape(
        &mut self,
        id: ShapeId,
        mass: MassUpdate,
        change: impl FnOnce(&mut Body),
        goes: impl Fn(u32) -> bool,
    ) {
        let ShapeId { body: id, shape: number } = id;
        let index = id.index;
        let mut changed = self.expect(id).clone();
        change(&mut changed);
        // The weight is computed before any change, because this may panic.
        let weight = weight(&changed, mass);
        self.mark_changed(id);
        if goes(number) {
            self.movers.forget(id);
        }
        let body = self.bodies.at_mut(index);
        (body.shapes, body.surfaces) = (changed.shapes, changed.surfaces);
        if let Some(shape) = body.shapes.get(number as usize) {
            self.library.keep(&shape.shape);
        }
        let goes =
            |key: &ContactKey| key.a == index && goes(key.shape_a) || key.b == index && goes(key.shape_b);
        for contact in self.contacts.extract_if(.., |contact| goes(&contact.key)) {
            self.meetings.part(&self.bodies, &contact);
        }
        self.groups.iter_mut().for_each(|(_, group)| group.pinched.forget(goes));
        let meetings = &mut self.meetings;
        let bodies = &self.bodies;
        self.activity.drop_returned(|contact| goes(&contact.key), |contact| meetings.part(bodies, &contact));
        if let Some((mass, moments, principal_from_body)) = weight {
            let body = self.bodies.at_mut(index);
            if body.kind == BodyKind::Dynamic {
                (body.mass, body.inertia) = (mass, moments);
            } else {
                body.laid_by = Some((mass, moments));
            }
            self.put_principal_frame(id, principal_from_body);
        }
        self.renew_bounds(id);
    }
}

/// Returns the mass of a body with changed shapes; `None` if the mass does not change.
#[track_caller]
fn weight(body: &Body, mass: MassUpdate) -> Option<Weight> {
    if mass == MassUpdate::Keep || body.kind != BodyKind::Dynamic && body.laid_by.is_none() {
        return None;
    }
    let properties = body.mass_of_shapes();
    if properties.mass == 0.0 && body.kind != BodyKind::Dynamic {
        return None;
    }
    let (moments, body_from_principal) = principal_frame(&properties);
    expect_solid(properties.mass, moments);
    Some((properties.mass, moments, body_from_principal.inverse()))
}
