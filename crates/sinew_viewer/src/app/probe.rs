//! A probe: the first surface on the ray through the pointer.

use crate::stage::Stage;
use egui::{Align2, Color32, FontId, Pos2};
use sinew::math::Vec3;
use sinew::physics::ray::Ray;
use sinew::physics::{BodyHit, BodyKind, BodyKinds, QueryFilter, World};
use sinew_picture::{Line, LineDepth};

/// Length of the drawn normal, as a share of the camera's distance.
const NORMAL: f32 = 0.12;
const COLOR: [f32; 3] = [0.95, 0.1, 0.6];

/// Probe, and the surface that it found in the last frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Probe {
    pub is_on: bool,
    hit: Option<BodyHit>,
}

impl Probe {
    /// Finds the surface below the pointer, and writes its description beside the pointer.
    pub fn update(&mut self, below: Option<(Pos2, Ray)>, world: &World, ui: &egui::Ui) {
        self.hit = None;
        let Some((at, ray)) = below.filter(|_| self.is_on) else { return };
        let kinds = BodyKinds::DYNAMIC | BodyKinds::KINEMATIC | BodyKinds::STATIC;
        self.hit = world.query().filter(QueryFilter::of(kinds)).first(&ray);
        if let Some(hit) = &self.hit {
            let galley = ui.painter().layout_no_wrap(
                told(world, hit, ray.origin),
                FontId::monospace(12.0),
                Color32::WHITE,
            );
            let rect = Align2::LEFT_TOP.anchor_size(at + egui::vec2(16.0, 16.0), galley.size());
            ui.painter().rect_filled(rect.expand(6.0), 4.0, Color32::from_black_alpha(190));
            ui.painter().galley(rect.min, galley, Color32::WHITE);
        }
    }

    /// Draws the normal of the surface; `distance` is that of the camera from its target, metres.
    pub fn draw(&self, distance: f32, stage: &mut Stage<'_>) {
        if let Some(hit) = &self.hit {
            let to = hit.point + hit.normal * (NORMAL * distance);
            stage.scene.lines.push(Line { from: hit.point, to, color: COLOR, depth: LineDepth::OnTop });
        }
    }
}

/// Describes a body and the point on it, seen from `eye`.
fn told(world: &World, hit: &BodyHit, eye: Vec3) -> String {
    let kind = match world.kind(hit.body) {
        BodyKind::Static => "static".to_owned(),
        BodyKind::Kinematic => "kinematic".to_owned(),
        BodyKind::Dynamic => format!("{:.2} kg", world.mass(hit.body).mass),
    };
    let (speed, distance) = (world.velocity(hit.body).linear.length(), (hit.point - eye).length());
    let (point, normal) = (hit.point, hit.normal);
    format!(
        "body {}, {kind}\npoint {:.3} {:.3} {:.3} m\nnormal {:.2} {:.2} {:.2}\n{distance:.3} m away, {speed:.2} m/s",
        hit.body.to_bits() as u32,
        point.x,
        point.y,
        point.z,
        normal.x,
        normal.y,
        normal.z,
    )
}
