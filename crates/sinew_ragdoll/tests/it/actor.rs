//! The mannequin as a character, for tests.

use sinew_anim::analyze;
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::{BodyDef, BodyKind, Shape, ShapeDef};
use sinew_ragdoll::{BuildOptions, CharacterDef, Locomotion, build};
use sinew_scenes::mannequin::{WALK_SPEED, mannequin};
use std::sync::Arc;

/// Walks, and gets up by either clip.
pub fn walker() -> CharacterDef {
    let mannequin = mannequin();
    let analysis = analyze(&mannequin.rig).expect("the mannequin has a skin");
    let (ragdoll, _) = build(&mannequin.rig, &analysis, &BuildOptions::default()).expect("it has bones");
    let mut def = CharacterDef::new(mannequin.rig, ragdoll, &analysis.bind_model);
    def.clips = mannequin.clips;
    def.looped = Some(0);
    def.get_ups = vec![2, 3];
    def.locomotion = Locomotion::Forward { speed: WALK_SPEED };
    def
}

pub fn shared(def: CharacterDef) -> Arc<CharacterDef> {
    Arc::new(def)
}

pub fn floor() -> BodyDef {
    BodyDef { kind: BodyKind::Static, shapes: vec![ShapeDef::new(Shape::HalfSpace)], ..BodyDef::default() }
}

/// A place away from the origin, turned.
pub fn somewhere() -> Transform {
    Transform::new(Vec3::new(1.5, 0.0, -2.0), Rotation::from_axis_angle(Vec3::Y, 0.7))
}
