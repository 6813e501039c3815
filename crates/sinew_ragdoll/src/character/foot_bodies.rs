//! Keeps the bodies of feet no lower than their drawn skin. Toes bend, but the body of their foot is rigid, so its
//! front would be in the ground whenever the heel is up.

use super::clearance::{outermost, part_without_repeats};
use crate::character::tuning::{BODY_BELOW_SKIN, UPSIDE_DOWN};
use crate::def::RagdollDef;
use crate::skin::surface::Surface;
use sinew_anim::roles::{Role, Side};
use sinew_anim::{Rig, smoothstep};
use sinew_math::trig::atan2;
use sinew_math::{Affine, Rotation, Transform, Vec3, max, min};

/// Number of bisections between 0 and [`flat_angle`](FootBody::flat_angle): they leave about a milliradian.
const BISECTIONS: usize = 11;

/// The body of a foot.
#[derive(Clone, Debug)]
struct FootBody {
    body: usize,
    /// Up direction of a flat foot, in the body's frame.
    up: Vec3,
    /// Axis of a rotation that raises the toes, in the body's frame.
    axis: Vec3,
    skin: Surface,
}

/// The bodies of a character's feet.
#[derive(Clone, Debug, Default)]
pub(super) struct FootBodies(Vec<FootBody>);

impl FootBodies {
    /// Collects the feet of a humanoid; `bind` is the bind pose in model space.
    pub fn of(rig: &Rig, def: &RagdollDef, bind: &[Affine]) -> Self {
        let surface = Surface::of(rig, def);
        let mut palette = Vec::new();
        surface.palette(bind, &mut palette);
        let foot = |side: Side| {
            let body = def.bodies.iter().position(|body| body.role == Role::Foot(side).name())?;
            let joint = def.joints.iter().find(|joint| joint.child == body)?.frame_child.translation;
            let body_from_character = def.bodies[body].character_from_body.rotation.inverse();
            let up = body_from_character * Vec3::Y;
            let axis = (-joint).cross(up);
            let vertices: Vec<usize> =
                outermost(&surface, body, &palette).into_iter().map(|(vertex, _)| vertex).collect();
            let is_flat = axis.length() > 0.0 && !vertices.is_empty();
            let skin = part_without_repeats(&surface, vertices);
            is_flat.then(|| FootBody { body, up, axis: axis.normalize(), skin })
        };
        Self([Side::Left, Side::Right].into_iter().filter_map(foot).collect())
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Rotates the bodies of the feet about their ankles until they are no lower than the skin drawn in the pose
    /// `model`, in world space.
    pub fn raise(&self, def: &RagdollDef, model: &[Affine], bodies: &mut [Transform]) {
        let mut palette = Vec::new();
        for foot in &self.0 {
            let places = foot.skin.places(model, &mut palette);
            let lowest = places.iter().map(|place| place.y).fold(f32::INFINITY, min);
            foot.raise(def, lowest - BODY_BELOW_SKIN * def.height, &mut bodies[foot.body]);
        }
    }
}

impl FootBody {
    /// Rotates the body about its joint until its shape is no lower than the height `least` (metres), or until the foot
    /// is flat.
    fn raise(&self, def: &RagdollDef, least: f32, world_from_body: &mut Transform) {
        let shape = &def.bodies[self.body].shape;
        let joint = def.joints[self.body - 1].frame_child.translation;
        let is_deep = |at: &Transform| shape.aabb(at).min.y < least;
        if !is_deep(world_from_body) {
            return;
        }
        let (from, pivot) = (world_from_body.rotation, world_from_body.point(joint));
        let turned = |angle: f32| {
            let rotation = (from * Rotation::from_axis_angle(self.axis, angle)).normalize();
            Transform { translation: pivot - rotation * joint, rotation }
        };
        let (mut low, mut high) = (0.0, self.flat_angle(from));
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if is_deep(&turned(middle)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        *world_from_body = turned(high);
    }

    /// Returns the angle about the axis at which the foot is flat, radians; 0 if its toes point up already. A foot on
    /// its side, or with its sole up, keeps its pose.
    fn flat_angle(&self, world_from_body: Rotation) -> f32 {
        let vertical = world_from_body.inverse() * Vec3::Y;
        let (up, ahead) = (vertical.dot(self.up), vertical.dot(self.axis.cross(self.up)));
        let upright = smoothstep(1.0 + up / UPSIDE_DOWN);
        max(atan2(ahead, up), 0.0) * upright * (1.0 - vertical.dot(self.axis).abs())
    }
}
