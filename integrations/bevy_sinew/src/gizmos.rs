//! Lines of the world as gizmos.

use crate::Physics;
use bevy_app::{App, Plugin, PostUpdate};
use bevy_color::Color;
use bevy_ecs::prelude::*;
use bevy_gizmos::AppGizmoBuilder;
use bevy_gizmos::config::GizmoConfigGroup;
use bevy_gizmos::gizmos::Gizmos;
use bevy_math::Vec3;
use bevy_reflect::Reflect;
use sinew_physics::{DebugDraw, DrawKind};

/// Draws the world: outlines of shapes, joints, contacts, springs. Needs Bevy's `GizmoPlugin`, which `DefaultPlugins` include;
/// `GizmoConfigStore` enables and disables the drawing as `PhysicsGizmos`.
#[derive(Clone, Copy, Debug, Default)]
pub struct SinewGizmosPlugin;

impl Plugin for SinewGizmosPlugin {
    fn build(&self, app: &mut App) {
        app.init_gizmo_group::<PhysicsGizmos>();
        app.init_resource::<GizmoColors>();
        app.add_systems(PostUpdate, draw);
    }
}

/// Gizmos of the world, for `GizmoConfigStore`.
#[derive(Clone, Copy, Debug, Default, GizmoConfigGroup, Reflect)]
pub struct PhysicsGizmos;

/// Colours of the gizmos.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct GizmoColors {
    /// Outlines of static shapes. Default grey.
    pub fixed: Color,
    /// Outlines of kinematic shapes. Default blue.
    pub kinematic: Color,
    /// Outlines of awake dynamic shapes. Default orange.
    pub awake: Color,
    /// Outlines of sleeping dynamic shapes. Default dark green.
    pub asleep: Color,
    /// Colour of lines from centres of bodies to anchors of their joints. Default yellow.
    pub joint: Color,
    /// Springs between particles. Default white.
    pub spring: Color,
    /// Normals of contacts. Default red.
    pub contact: Color,
    /// Lines of the user's own objects. Default pink.
    pub object: Color,
}

impl Default for GizmoColors {
    fn default() -> Self {
        Self {
            fixed: Color::srgb(0.5, 0.5, 0.5),
            kinematic: Color::srgb(0.3, 0.5, 1.0),
            awake: Color::srgb(1.0, 0.6, 0.1),
            asleep: Color::srgb(0.2, 0.5, 0.2),
            joint: Color::srgb(1.0, 0.9, 0.2),
            spring: Color::WHITE,
            contact: Color::srgb(1.0, 0.1, 0.1),
            object: Color::srgb(1.0, 0.4, 0.8),
        }
    }
}

impl GizmoColors {
    /// Returns the colour of a line of that kind.
    pub fn of(&self, kind: DrawKind) -> Color {
        match kind {
            DrawKind::Static => self.fixed,
            DrawKind::Kinematic => self.kinematic,
            DrawKind::Awake => self.awake,
            DrawKind::Asleep => self.asleep,
            DrawKind::Joint => self.joint,
            DrawKind::Spring => self.spring,
            DrawKind::Contact => self.contact,
            DrawKind::Object => self.object,
        }
    }
}

struct Lines<'a, 'w, 's> {
    gizmos: &'a mut Gizmos<'w, 's, PhysicsGizmos>,
    colors: &'a GizmoColors,
}

impl DebugDraw for Lines<'_, '_, '_> {
    fn line(&mut self, from: Vec3, to: Vec3, kind: DrawKind) {
        self.gizmos.line(from, to, self.colors.of(kind));
    }
}

fn draw(physics: Res<Physics>, colors: Res<GizmoColors>, mut gizmos: Gizmos<PhysicsGizmos>) {
    physics.draw(&mut Lines { gizmos: &mut gizmos, colors: &colors });
}
