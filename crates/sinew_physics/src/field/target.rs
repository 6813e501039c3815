//! Targets of fields: bodies and particles.

use crate::body::shape::Shape;
use crate::body::{Body, Velocity};
use crate::particles::ParticleGroup;
use sinew_math::{Transform, Vec3};

/// Target of a field: a body or a particle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target<'a> {
    /// World pose of the principal frame: the translation is the centre of mass.
    pub pose: Transform,
    pub velocity: Velocity,
    pub mass: f32,
    pub gravity_scale: f32,
    pub form: Form<'a>,
}

/// Geometry of a target for air and water.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Form<'a> {
    Body(&'a Body),
    /// Ball with a radius, metres, on some layers; for air also the sheet faces at this particle, if its group has any.
    Particle {
        radius: f32,
        layers: u32,
        group: &'a ParticleGroup,
        index: usize,
    },
}

impl<'a> Target<'a> {
    pub fn of_body(body: &'a Body) -> Self {
        Self::at(body, body.world_from_principal, body.velocity)
    }

    /// Returns the target of a body at a pose within its step.
    pub fn at(body: &'a Body, pose: Transform, velocity: Velocity) -> Self {
        let form = Form::Body(body);
        Self { pose, velocity, mass: body.mass, gravity_scale: body.gravity_scale, form }
    }

    pub fn of_particle(group: &'a ParticleGroup, index: usize) -> Self {
        Self {
            pose: Transform::from_translation(group.positions()[index]),
            velocity: Velocity { linear: group.velocities()[index], angular: Vec3::ZERO },
            mass: group.masses()[index],
            gravity_scale: group.gravity_scale(),
            form: Form::Particle {
                radius: group.radii()[index],
                layers: group.filter().layers,
                group,
                index,
            },
        }
    }

    pub fn center(&self) -> Vec3 {
        self.pose.translation
    }

    /// Velocity of a world point that moves with the body, m/s.
    pub(super) fn velocity_at(&self, point: Vec3) -> Vec3 {
        self.velocity.at(point - self.center())
    }

    /// True if the target is on any of these layers. A body without shapes is on all.
    pub(super) fn is_on(&self, layers: u32) -> bool {
        match self.form {
            Form::Body(body) => {
                let mut surfaces = body.surfaces.as_slice().iter();
                body.shapes.is_empty() || surfaces.any(|surface| surface.filter.layers & layers != 0)
            }
            Form::Particle { layers: own, .. } => own & layers != 0,
        }
    }

    /// Returns the parts of the faces around a particle of a sheet, as vector areas, m²; `None` for other targets.
    pub(super) fn face_parts(&self) -> Option<impl Iterator<Item = Vec3> + 'a> {
        match self.form {
            Form::Particle { group, index, .. } if group.has_faces(index) => Some(group.face_parts(index)),
            _ => None,
        }
    }

    /// Visits the shapes of the target with their world poses. A particle with a radius is a ball.
    pub(super) fn for_each_shape(&self, mut visit: impl FnMut(&Shape, &Transform)) {
        match self.form {
            Form::Body(body) => {
                for s in &body.shapes {
                    visit(&s.shape, &(self.pose * s.principal_from_shape));
                }
            }
            Form::Particle { radius, .. } if radius > 0.0 => visit(&Shape::Sphere { radius }, &self.pose),
            Form::Particle { .. } => {}
        }
    }
}
