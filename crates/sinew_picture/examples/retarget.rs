//! Draws a captured motion on a character, the actor's bones beside it:
//! `cargo run --release -p sinew_picture --example retarget -- CAPTURE CHARACTER.glb OUT` writes `OUT_side.png` and
//! `OUT_front.png`, eight moments each. CAPTURE is a BVH file, or a DeepMimic clip with its character beside it.

use sinew::anim::retarget::{Body, RetargetOptions, Retargeted, retarget, stand};
use sinew::anim::{
    Clip, LocalTransform, Rig, RigAnalysis, Role, Take, analyze, local_to_model, skin_vertices,
};
use sinew::formats::bvh::{BvhDocument, BvhOptions, read_bvh};
use sinew::formats::{ReadOptions, load_gltf, read_deepmimic, read_deepmimic_character};
use sinew::math::{Affine, Vec3};
use sinew::physics::boxes::Aabb;
use sinew_picture::{
    Camera, Line, LineDepth, Model, PictureFormat, RenderSettings, Renderer, Scene, draw, encode,
};
use std::error::Error;
use std::path::Path;

const MOMENTS: usize = 8;

/// A motion on its body.
struct Actor<'a> {
    rig: &'a Rig,
    analysis: &'a RigAnalysis,
    take: &'a Take,
}

impl Actor<'_> {
    /// The model pose of a moment, in the body's own axes, with the pelvis over `place` and the floor at the height
    /// `floor`.
    fn at(&self, moment: usize, place: Vec3, floor: f32) -> Vec<Affine> {
        let frame = moment * (self.take.frames() - 1) / (MOMENTS - 1);
        let mut root = self.analysis.character_from_file();
        let mut model = Vec::new();
        local_to_model(self.rig, self.take.pose(frame), &root, &mut model);
        let hips = self.analysis.joint_with(Role::Hips).map_or(Vec3::ZERO, |hips| model[hips].translation);
        root.translation += place - Vec3::new(hips.x, floor, hips.z);
        local_to_model(self.rig, self.take.pose(frame), &root, &mut model);
        model
    }

    fn bones(&self, model: &[Affine], scene: &mut Scene) {
        for (joint, parent) in
            self.rig.joints.iter().enumerate().filter_map(|(i, joint)| Some((i, joint.parent?)))
        {
            let role = self.analysis.roles[parent].map(|guess| guess.role);
            let color = if role.is_some_and(Role::is_right) { [0.9, 0.2, 0.1] } else { [0.05, 0.2, 0.8] };
            let (from, to) = (model[parent].translation, model[joint].translation);
            scene.lines.push(Line { from, to, color, depth: LineDepth::OnTop });
        }
    }

    fn skin(&self, model: &[Affine], scene: &mut Scene) {
        for (m, mesh) in self.rig.meshes.iter().enumerate() {
            for (p, primitive) in mesh.primitives.iter().enumerate() {
                let (mut positions, mut normals) = (Vec::new(), Vec::new());
                skin_vertices(self.rig, m, p, model, &mut positions, &mut normals);
                let indices = primitive.indices.clone();
                scene.models.push(Model { positions, normals, indices, ..Model::default() });
            }
        }
    }
}

/// Content of a capture file.
struct Captured {
    rig: Rig,
    clip: Clip,
    rest_pose: Option<Vec<LocalTransform>>,
}

impl Captured {
    fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        let bytes = std::fs::read(path)?;
        if path.extension().is_some_and(|extension| extension == "bvh") {
            let BvhDocument { rig, clip, rest_pose, notes, .. } = read_bvh(&bytes, BvhOptions::default())?;
            notes.iter().for_each(|note| println!("{note}"));
            return Ok(Self { rig, clip, rest_pose });
        }
        let beside = path.with_file_name("deepmimic_humanoid3d.txt");
        let character = read_deepmimic_character(&std::fs::read(beside)?)?;
        let clip = read_deepmimic(&bytes, &character)?.clip;
        Ok(Self { rig: character.rig, clip, rest_pose: None })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [capture, character, out] = arguments.as_slice() else {
        return Err("give a capture, a character and the start of the pictures' names".into());
    };
    let captured = Captured::read(Path::new(capture))?;
    let (actor, reference) = stand(&captured.rig, &captured.clip, captured.rest_pose.as_deref())?;
    let document = load_gltf(character, ReadOptions::default())?;
    let analysis = analyze(&document.rig)?;
    let body = Body { rig: &captured.rig, analysis: &actor };
    let onto = Body { rig: &document.rig, analysis: &analysis };
    let found = retarget(body, &captured.clip, onto, &RetargetOptions::default())?;
    println!("reference {reference:?}; {}", said(&found, &analysis));
    let source = Take::of(&captured.rig, &captured.clip, 1.0 / 60.0);
    let from = Actor { rig: &captured.rig, analysis: &actor, take: &source };
    let to = Actor { rig: &document.rig, analysis: &analysis, take: &found.take };
    for (name, along, toward) in [("side", Vec3::Z, Vec3::X), ("front", Vec3::X, Vec3::Z)] {
        let mut scene = Scene::default();
        let step = 0.75 * analysis.height;
        for moment in 0..MOMENTS {
            let place = along * (step * moment as f32);
            to.skin(&to.at(moment, place, analysis.floor), &mut scene);
            let up = Vec3::Y * (1.25 * analysis.height);
            from.bones(&from.at(moment, place + up, 0.0), &mut scene);
        }
        let middle = along * (0.5 * step * (MOMENTS - 1) as f32);
        scene.models.push(draw::floor(middle, 40.0, [0.4; 3], [0.5; 3]));
        let reach = along * (0.5 * step * MOMENTS as f32) + Vec3::ONE * (0.1 * analysis.height);
        let bounds = Aabb { min: middle - reach, max: middle + reach + Vec3::Y * (2.2 * analysis.height) };
        let settings = RenderSettings { width: 1600, height: 700, threads: 2, ..RenderSettings::default() };
        let image =
            Renderer::new(settings).render(&scene, &Camera::framing_box(&bounds, toward, 1600.0 / 700.0));
        std::fs::write(format!("{out}_{name}.png"), encode::encode(PictureFormat::Png, &[image], 1)?)?;
    }
    Ok(())
}

fn said(found: &Retargeted, analysis: &RigAnalysis) -> String {
    let [before, after] = found.feet.slide.map(|slide| 100.0 * slide.mean / analysis.height);
    format!(
        "legs x {:.2}, {} contacts, slide {before:.2} -> {after:.3} cm/s per m, feet shifted up to {:.1} cm, pelvis lowered up \
         to {:.1} cm, without counterpart: {:?}",
        found.scale,
        found.contacts.len(),
        100.0 * found.feet.shifted,
        100.0 * found.feet.lowered,
        found.unmatched
    )
}
