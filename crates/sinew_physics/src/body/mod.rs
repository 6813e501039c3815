//! A body as stored by the world.

pub(crate) mod contact_rule;
pub mod def;
pub(crate) mod external_work;
pub(crate) mod force;
pub(crate) mod library;
pub(crate) mod material;
pub(crate) mod owner;
pub mod shape;
pub(crate) mod snapshot;
pub(crate) mod surface;

use crate::arena::Item;
use crate::body::def::{BodyDef, BodyKind, Quality, Sleeping};
use crate::body::force::BodyForces;
use crate::body::owner::OwnerMark;
use crate::body::shape::{MassProperties, Shape, ShapeDef};
use crate::body::surface::{Surface, Surfaces};
use crate::id::BodyId;
use sinew_math::{Rotation, Sym3, Transform, Vec3, clamp};

/// Linear velocity of the centre of mass and angular velocity, world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Velocity {
    /// Linear velocity, m/s.
    pub linear: Vec3,
    /// Angular velocity, rad/s.
    pub angular: Vec3,
}

impl Velocity {
    /// Creates a velocity without rotation, m/s.
    pub const fn linear(linear: Vec3) -> Self {
        Self { linear, angular: Vec3::ZERO }
    }

    /// Creates a rotation without motion of the centre of mass, rad/s.
    pub const fn angular(angular: Vec3) -> Self {
        Self { linear: Vec3::ZERO, angular }
    }

    /// True if both velocities are zero.
    pub fn is_zero(&self) -> bool {
        self.linear == Vec3::ZERO && self.angular == Vec3::ZERO
    }

    /// Limits each component to `most`, m/s or rad/s.
    pub(crate) fn bound(&mut self, most: f32) {
        for component in self.linear.as_mut().iter_mut().chain(self.angular.as_mut()) {
            *component = clamp(*component, -most, most);
        }
    }

    /// True if a component has at least the size `most`, m/s or rad/s.
    pub(crate) fn reaches(&self, most: f32) -> bool {
        self.linear.as_ref().iter().chain(self.angular.as_ref()).any(|component| component.abs() >= most)
    }

    /// Velocity of a point at `arm` from the centre of mass, m/s.
    pub fn at(self, arm: Vec3) -> Vec3 {
        self.linear + self.angular.cross(arm)
    }
}

/// Awake, or asleep with its island.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Rest {
    /// Time for which the body has been at rest, seconds.
    Awake { rest_time: f32 },
    /// Number of the sleeping island; all of its bodies wake together.
    Asleep { island: u32 },
}

/// Velocity change since its last reversal; a share of the sum decays per step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gain {
    pub velocity: Velocity,
    /// Time since the last reversal, seconds.
    pub time: f32,
}

impl Gain {
    /// Adds the change of a step of `dt` seconds to `share` of the previous sum; `arm` (m) converts rotations to
    /// distances.
    pub fn add(&mut self, change: &Velocity, dt: f32, (arm, share): (f32, f32)) {
        let Self { velocity: Velocity { linear, angular }, time } = self;
        let along = linear.dot(change.linear) + arm * arm * angular.dot(change.angular);
        if along > 0.0 {
            *linear = *linear * share + change.linear;
            *angular = *angular * share + change.angular;
            *time += dt;
        } else {
            *self = Self { velocity: *change, time: 0.0 };
        }
    }
}

/// A shape of a body, in the body's principal frame. A body may have a million of them.
#[derive(Clone, Debug)]
pub(crate) struct BodyShape {
    pub shape: Shape,
    pub principal_from_shape: Transform,
    /// Number of the shape's surface among those of the body.
    pub surface: u32,
}

/// Body of the world. Its pose is that of the **principal frame**: origin at the centre of mass, axes along the
/// principal axes of inertia, so that the inertia is diagonal everywhere in the solver.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub kind: BodyKind,
    pub world_from_principal: Transform,
    /// Pose before the last step, for interpolation and continuous collision.
    pub previous: Transform,
    pub velocity: Velocity,
    /// Force that the user applied for the next step, N, and torque, N·m, world axes. They do not move a kinematic body
    /// and are [reported](crate::Events::pushed).
    pub force: Vec3,
    pub torque: Vec3,
    /// Forces that last until they are changed.
    pub forces: BodyForces,
    pub principal_from_body: Transform,
    /// Mass, kg; 0 unless dynamic.
    pub mass: f32,
    /// Principal moments of inertia, kg·m².
    pub inertia: Vec3,
    /// Mass and principal moments that the body gets when it becomes dynamic; only for a body that was dynamic or was
    /// given a mass.
    pub laid_by: Option<(f32, Vec3)>,
    pub linear_damping: f32,
    pub angular_damping: f32,
    pub gravity_scale: f32,
    pub shapes: Vec<BodyShape>,
    pub surfaces: Surfaces,
    pub rest: Rest,
    /// Permission for the body to fall asleep.
    pub sleeping: Sleeping,
    /// Step quality; `None`: that of the world.
    pub quality: Option<Quality>,
    /// Pose at the start of the body's time at rest.
    pub place: Transform,
    pub gain: Gain,
    /// True after the body's state became non-finite: it was rolled back and is no longer simulated.
    pub quarantined: bool,
    /// True if the user changed the body since the last step.
    pub changed: bool,
    pub user_data: u64,
    /// Owner of the body; `None` if the body is the user's.
    pub owner: Option<OwnerMark>,
}

/// Least ratio of a principal moment to the largest. Smaller moments are raised to it, since they would make long thin
/// bodies spin wildly on contact, because `r × n` dominates the effective mass.
const SMALLEST_MOMENT: f32 = 1e-3;

/// Panics if a number is not finite, a shape is not valid, or a half-space belongs to a body that is not static.
#[track_caller]
fn check(def: &BodyDef) {
    assert!(
        def.position.is_finite() && def.rotation.is_finite(),
        "a body's pose must be finite, not {:?} and {:?}",
        def.position,
        def.rotation
    );
    assert!(
        def.linear_velocity.is_finite() && def.angular_velocity.is_finite(),
        "a body's velocity must be finite, not {:?} and {:?}",
        def.linear_velocity,
        def.angular_velocity
    );
    assert!(
        def.linear_damping.is_finite() && def.angular_damping.is_finite() && def.gravity_scale.is_finite(),
        "a body's damping and gravity scale must be finite, not {} and {} and {}",
        def.linear_damping,
        def.angular_damping,
        def.gravity_scale
    );
    if let Some(MassProperties { mass, center, inertia }) = &def.mass {
        let finite = mass.is_finite() && center.is_finite() && inertia.is_finite();
        assert!(
            finite,
            "a body's mass, centre and inertia must be finite, not {mass} and {center:?} and {inertia:?}"
        );
    }
    for shape in &def.shapes {
        if let Err(what) = shape.check() {
            panic!("a body's shape is valid: {what}");
        }
        assert!(
            def.kind == BodyKind::Static || shape.shape != Shape::HalfSpace,
            "half-spaces are static bodies"
        );
    }
}

impl Item for Body {
    type Id = BodyId;
}

impl Body {
    /// # Panics
    /// If a number is not finite, a shape is not valid, or a dynamic body has no mass.
    pub fn new(def: &BodyDef) -> Self {
        check(def);
        let world_from_body = Transform::new(def.position, def.rotation.normalize());
        let properties = def.mass.unwrap_or_else(|| mass_of_shapes(&def.shapes));
        let (moments, body_from_principal) = match def.kind {
            BodyKind::Dynamic => principal_frame(&properties),
            BodyKind::Static | BodyKind::Kinematic => (Vec3::ZERO, Transform::IDENTITY),
        };
        let principal_from_body = body_from_principal.inverse();
        let mass = if def.kind == BodyKind::Dynamic { properties.mass } else { 0.0 };
        if def.kind == BodyKind::Dynamic {
            expect_solid(mass, moments);
        }
        let mut surfaces = Surfaces::default();
        let body_shape = |def: &ShapeDef| BodyShape {
            shape: def.shape.clone(),
            principal_from_shape: principal_from_body * def.body_from_shape,
            surface: surfaces.intern(&Surface::of(def)),
        };
        let shapes = def.shapes.iter().map(body_shape).collect();
        surfaces.shrink();
        let velocity = match def.kind {
            BodyKind::Static => Velocity::default(),
            _ => Velocity { linear: def.linear_velocity, angular: def.angular_velocity },
        };
        Self {
            kind: def.kind,
            world_from_principal: world_from_body * body_from_principal,
            previous: world_from_body * body_from_principal,
            velocity,
            force: Vec3::ZERO,
            torque: Vec3::ZERO,
            forces: BodyForces::default(),
            principal_from_body,
            mass,
            inertia: moments,
            laid_by: None,
            linear_damping: def.linear_damping,
            angular_damping: def.angular_damping,
            gravity_scale: def.gravity_scale,
            shapes,
            surfaces,
            rest: Rest::Awake { rest_time: 0.0 },
            sleeping: def.sleeping,
            quality: def.quality,
            place: world_from_body * body_from_principal,
            gain: Gain::default(),
            quarantined: false,
            changed: false,
            user_data: def.user_data,
            owner: None,
        }
    }

    /// World pose of a kinematic body's principal frame after `count` substeps of `h` seconds at its velocity.
    pub fn carried(&self, h: f32, count: u32) -> Transform {
        let (Transform { translation, rotation }, time) = (self.world_from_principal, h * count as f32);
        let Velocity { linear, angular } = self.velocity;
        let turned = (small_turn(angular * time) * rotation).normalize();
        Transform::new(translation + linear * time, turned)
    }

    /// Mass, centre and inertia in the body's frame.
    pub fn mass_properties(&self) -> MassProperties {
        let body_from_principal = self.principal_from_body.inverse();
        MassProperties {
            mass: self.mass,
            center: body_from_principal.translation,
            inertia: Sym3::from_rotated_diagonal(body_from_principal.rotation, self.inertia),
        }
    }

    /// Adds a force (N) and a torque (N·m) that the next step reports. Drops them if they would make a sum infinite.
    pub fn note_push(&mut self, force: Vec3, torque: Vec3) {
        let (force, torque) = (self.force + force, self.torque + torque);
        if force.is_finite() && torque.is_finite() {
            (self.force, self.torque) = (force, torque);
        }
    }

    /// Mass of the body if it were dynamic, kg; 0 if it never had a mass.
    pub fn weighs(&self) -> f32 {
        self.laid_by.map_or(self.mass, |(mass, _)| mass)
    }

    pub fn world_from_body(&self) -> Transform {
        self.world_from_principal * self.principal_from_body
    }

    pub fn set_world_from_body(&mut self, world_from_body: Transform) {
        let Transform { translation, rotation } = world_from_body;
        let world_from_body = Transform::new(translation, rotation.normalize());
        self.world_from_principal = world_from_body * self.principal_from_body.inverse();
        self.previous = self.world_from_principal;
    }

    /// Moves the principal frame within the body; the body's pose and motion do not change.
    pub fn set_principal_frame(&mut self, principal_from_body: Transform) {
        let new_from_old = principal_from_body * self.principal_from_body.inverse();
        let old_from_new = new_from_old.inverse();
        let arm = self.world_from_principal.rotation * old_from_new.translation;
        self.velocity.linear = self.velocity.at(arm);
        self.torque -= arm.cross(self.force);
        for pose in [&mut self.world_from_principal, &mut self.previous, &mut self.place] {
            *pose = *pose * old_from_new;
        }
        for shape in &mut self.shapes {
            shape.principal_from_shape = new_from_old * shape.principal_from_shape;
        }
        self.principal_from_body = principal_from_body;
    }

    /// Mass, centre and inertia in the body's frame, computed from the densities of the shapes.
    pub fn mass_of_shapes(&self) -> MassProperties {
        let body_from_principal = self.principal_from_body.inverse();
        let of = |shape: &BodyShape| {
            let density = self.surfaces.as_slice()[shape.surface as usize].density;
            let body_from_shape = body_from_principal * shape.principal_from_shape;
            shape.shape.mass_properties(density).transformed(&body_from_shape)
        };
        self.shapes.iter().fold(MassProperties::default(), |sum, shape| sum.combine(&of(shape)))
    }

    /// Adds a shape at the end of the list.
    pub fn push_shape(&mut self, def: &ShapeDef) {
        let shape = BodyShape {
            shape: def.shape.clone(),
            principal_from_shape: self.principal_from_body * def.body_from_shape,
            surface: self.surfaces.intern(&Surface::of(def)),
        };
        self.shapes.push(shape);
    }

    /// Removes surfaces that no shape uses.
    pub fn tidy_surfaces(&mut self) {
        let old = core::mem::take(&mut self.surfaces);
        for shape in &mut self.shapes {
            shape.surface = self.surfaces.intern(&old.as_slice()[shape.surface as usize]);
        }
        self.surfaces.shrink();
    }

    /// Surface of a shape: its non-geometric properties.
    pub fn surface(&self, shape: usize) -> &Surface {
        &self.surfaces.as_slice()[self.shapes[shape].surface as usize]
    }

    /// Pose of a shape in the world. Most bodies have one shape at their own origin, and levels are bodies at the
    /// world's origin: then no multiplication is needed.
    pub fn world_from_shape(&self, shape: usize) -> Transform {
        let principal_from_shape = self.shapes[shape].principal_from_shape;
        if principal_from_shape == Transform::IDENTITY {
            self.world_from_principal
        } else if self.world_from_principal == Transform::IDENTITY {
            principal_from_shape
        } else {
            self.world_from_principal * principal_from_shape
        }
    }

    /// Velocity of a shape's surface relative to the body at a world point, world axes.
    pub fn surface_velocity(&self, shape: usize, point: Vec3) -> Velocity {
        let (frame, material) = (self.world_from_shape(shape), &self.surface(shape).material);
        let angular = frame.rotation * material.surface_spin;
        let linear = frame.rotation * material.surface_velocity + angular.cross(point - frame.translation);
        Velocity { linear, angular }
    }

    /// World position of the centre of mass.
    pub fn center(&self) -> Vec3 {
        self.world_from_principal.translation
    }

    pub fn is_awake(&self) -> bool {
        matches!(self.rest, Rest::Awake { .. })
    }

    /// Wakes the body and restarts its time at rest.
    pub fn disturb(&mut self) {
        self.rest = Rest::Awake { rest_time: 0.0 };
        self.place = self.world_from_principal;
    }

    /// True if the body takes part in the step as a dynamic body.
    pub fn is_active(&self) -> bool {
        self.kind == BodyKind::Dynamic && self.is_awake() && !self.quarantined
    }

    /// True if the body may start or end a contact: it moves, or was changed.
    pub fn can_touch(&self) -> bool {
        if self.changed {
            return true;
        }
        match self.kind {
            BodyKind::Dynamic => self.is_active(),
            BodyKind::Kinematic => self.velocity != Velocity::default(),
            BodyKind::Static => false,
        }
    }

    pub fn inverse_mass(&self) -> f32 {
        if self.mass > 0.0 { 1.0 / self.mass } else { 0.0 }
    }

    /// Computes `I⁻¹ v` in world axes.
    pub fn inverse_inertia_mul(&self, v: Vec3) -> Vec3 {
        if self.mass == 0.0 {
            return Vec3::ZERO;
        }
        let r = self.world_from_principal.rotation;
        r * ((r.inverse() * v) / self.inertia)
    }

    /// Computes `I v` in world axes.
    pub fn inertia_mul(&self, v: Vec3) -> Vec3 {
        let r = self.world_from_principal.rotation;
        r * ((r.inverse() * v) * self.inertia)
    }

    /// Kinetic energy, J.
    pub fn kinetic_energy(&self) -> f32 {
        let w = self.world_from_principal.rotation.inverse() * self.velocity.angular;
        0.5 * self.mass * self.velocity.linear.length_squared() + 0.5 * (w * self.inertia).dot(w)
    }

    /// Approximate largest speed of any point of the body, m/s.
    pub fn fastest_point(&self) -> f32 {
        self.velocity.linear.length() + self.velocity.angular.length() * self.reach()
    }

    /// Approximate largest distance from the centre of mass to the surface, metres: converts rad/s to m/s. 0 for static
    /// bodies, which do not rotate (and may be infinite).
    pub fn reach(&self) -> f32 {
        let mut reach = 0.0;
        for shape in self.shapes.iter().filter(|_| self.kind != BodyKind::Static) {
            let r = shape.principal_from_shape.translation.length() + shape.shape.bounding_radius();
            reach = sinew_math::max(reach, r);
        }
        reach
    }
}

/// Rotation by `v` (axis times angle, radians), like [`Rotation::from_scaled_axis`]. Uses the series where that is
/// equally exact, because a kinematic body of an animation rotates little per step.
fn small_turn(v: Vec3) -> Rotation {
    let square = 0.25 * v.length_squared();
    if square.is_nan() || square > 0.02 {
        return Rotation::from_scaled_axis(v);
    }
    let sin = 0.5 - square * (1.0 / 12.0 - square * (1.0 / 240.0 - square * (1.0 / 10_080.0)));
    let cos = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)));
    Rotation { x: v.x * sin, y: v.y * sin, z: v.z * sin, w: cos }
}

fn mass_of_shapes(shapes: &[ShapeDef]) -> MassProperties {
    let mut sum = MassProperties::default();
    for def in shapes {
        sum = sum.combine(&def.shape.mass_properties(def.density).transformed(&def.body_from_shape));
    }
    sum
}

/// Panics unless the mass (kg) and the principal moments (kg·m²) are valid for a dynamic body.
#[track_caller]
pub(crate) fn expect_solid(mass: f32, moments: Vec3) {
    let solid = mass > 0.0 && mass < f32::INFINITY && moments.z > 0.0 && moments.is_finite();
    assert!(solid, "a dynamic body has positive, finite mass and inertia, not {mass} kg and {moments:?}");
}

/// Returns the principal moments (largest first) and their frame.
pub(crate) fn principal_frame(properties: &MassProperties) -> (Vec3, Transform) {
    let Sym3 { diagonal, off } = properties.inertia;
    if off == Vec3::ZERO {
        // Keeps the axes of boxes and capsules unchanged.
        return (raise(diagonal), Transform::from_translation(properties.center));
    }
    let (moments, rotation): (Vec3, Rotation) = properties.inertia.eigen();
    (raise(moments), Transform::new(properties.center, rotation))
}

fn raise(moments: Vec3) -> Vec3 {
    let largest = sinew_math::max(moments.x, sinew_math::max(moments.y, moments.z));
    sinew_math::max3(moments, Vec3::splat(largest * SMALLEST_MOMENT))
}
