//! A humanoid of capsules on stairs, like the demo's pictures.

use sinew::math::{Rotation, Transform, Vec3, trig};
use sinew::physics::Shape;
use sinew_picture::draw;
use sinew_picture::{Camera, Caption, Line, LineDepth, Model, RenderMaterial, Scene};

const WOOD: [f32; 3] = [0.50, 0.33, 0.19];
const SKIN: [f32; 3] = [0.86, 0.42, 0.17];
const SHIRT: [f32; 3] = [0.10, 0.32, 0.56];

/// Returns stairs with a landing, a humanoid in the middle of a step at `time` seconds, a ball and a glass box.
pub fn scene(time: f32) -> Scene {
    let mut models = vec![draw::floor(Vec3::ZERO, 60.0, [0.36, 0.37, 0.37], [0.27, 0.28, 0.29])];
    for step in 0..5 {
        let height = 0.18 * (step + 1) as f32;
        let center = Vec3::new(0.0, 0.5 * height, -0.15 - 0.3 * step as f32);
        models.push(block(center, Vec3::new(0.8, 0.5 * height, 0.15), WOOD));
    }
    models.push(block(Vec3::new(0.0, 0.45, -2.15), Vec3::new(0.8, 0.45, 0.65), WOOD));
    models.push(block(Vec3::new(-0.9, 0.9, -1.4), Vec3::new(0.06, 0.9, 1.4), [0.55, 0.53, 0.49]));
    let ball = Transform::from_translation(Vec3::new(1.4, 0.35, 0.3));
    models.push(draw::shape(&Shape::Sphere { radius: 0.35 }, ball, RenderMaterial::new([0.62, 0.07, 0.06])));
    let glass = RenderMaterial { opacity: 0.35, ..RenderMaterial::new([0.2, 0.6, 0.9]) };
    let place = Transform::new(Vec3::new(1.3, 0.3, -0.9), Rotation::from_axis_angle(Vec3::Y, 0.5));
    models.push(draw::shape(&Shape::Box { half_extents: Vec3::splat(0.3) }, place, glass));
    models.extend(figure(hips(time), time));
    let lines = vec![Line {
        from: hips(time),
        to: hips(time) + Vec3::Y * 0.9,
        color: [0.9, 0.8, 0.1],
        depth: LineDepth::OnTop,
    }];
    let captions = vec![
        Caption::new(format!("t = {time:.2} s  limp")),
        Caption { y: -12, scale: 1, ..Caption::new("The quick brown fox (jumps): 0123456789 #!?") },
    ];
    Scene { models, lines, captions, ..Scene::default() }
}

pub fn hips(time: f32) -> Vec3 {
    Vec3::new(0.1, 0.92, 0.9 - 0.6 * time)
}

pub fn camera(time: f32) -> Camera {
    Camera::framing(hips(time), 1.5, Vec3::new(0.75, 0.42, 0.9))
}

fn block(center: Vec3, half_extents: Vec3, color: [f32; 3]) -> Model {
    draw::shape(&Shape::Box { half_extents }, Transform::from_translation(center), RenderMaterial::new(color))
}

fn figure(hips: Vec3, time: f32) -> Vec<Model> {
    let swing = 0.5 * trig::sin(6.0 * time + 0.8);
    let at = |x: f32, y: f32, z: f32| hips + Vec3::new(x, y, z);
    let mut parts = vec![
        limb(at(0.0, 0.0, 0.0), at(0.0, 0.16, 0.0), 0.13, SHIRT),
        limb(at(0.0, 0.2, 0.0), at(0.0, 0.4, 0.0), 0.16, SHIRT),
        limb(at(0.0, 0.66, -0.02), at(0.0, 0.70, -0.02), 0.11, SKIN),
    ];
    for (side, phase) in [(-1.0, 1.0), (1.0, -1.0)] {
        let (shoulder, hip) = (at(0.22 * side, 0.46, 0.0), at(0.1 * side, -0.06, 0.0));
        let elbow = shoulder + Vec3::new(0.08 * side, -0.26, 0.2 * swing * phase);
        let hand = elbow + Vec3::new(0.0, -0.18, -0.16);
        let knee = hip + Vec3::new(0.0, -0.4, -0.35 * swing * phase - 0.06);
        let foot = knee + Vec3::new(0.0, -0.38, 0.1);
        parts.push(limb(shoulder, elbow, 0.055, SHIRT));
        parts.push(limb(elbow, hand, 0.045, SKIN));
        parts.push(limb(hip, knee, 0.08, [0.13, 0.14, 0.17]));
        parts.push(limb(knee, foot, 0.06, [0.13, 0.14, 0.17]));
        parts.push(limb(foot, foot + Vec3::new(0.0, -0.02, -0.14), 0.05, [0.05, 0.05, 0.05]));
    }
    parts
}

fn limb(from: Vec3, to: Vec3, radius: f32, color: [f32; 3]) -> Model {
    let length = (to - from).length();
    let rotation = Rotation::from_arc(Vec3::Y, (to - from) / length);
    let place = Transform::new((from + to) * 0.5, rotation);
    draw::shape(&Shape::Capsule { half_height: 0.5 * length, radius }, place, RenderMaterial::new(color))
}
