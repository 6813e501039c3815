use crate::rigs;
use sinew_anim::{Rig, RigAnalysis, analyze};

fn table(name: &str, rig: &Rig, a: &RigAnalysis) -> String {
    let mut out = format!("{name}: humanoid {} unit {} up {} height {:.3} floor {:.3} forward {}\n", a.humanoid, a.unit_scale, a.up_axis, a.height, a.floor,
        a.character_from_model.rotation.inverse() * sinew_math::Vec3::Z);
    for note in &a.notes {
        out += &format!("  note: {note}\n");
    }
    for (i, bone) in a.kept.iter().enumerate() {
        let p = a.character_from_file().point(bone.bind_model.translation);
        let merged: Vec<_> = bone.merged.iter().map(|&j| rig.joints[j].name.as_str()).collect();
        out += &format!("  {i:2} {:14} <- {:14} {:.2} {:28} ({:6.3} {:6.3} {:6.3}) + {merged:?}\n", bone.role.name(), bone.parent.map_or(String::new(), |p| a.kept[p].role.name()), bone.confidence, rig.joints[bone.joint].name, p.x, p.y, p.z);
    }
    let other: Vec<_> = a.roles.iter().enumerate().filter_map(|(j, g)| g.filter(|g| a.kept_with(g.role).is_none()).map(|g| format!("{}={}", g.role.name(), rig.joints[j].name))).collect();
    out += &format!("  not kept: {other:?}\n");
    out
}

#[test]
fn print() {
    for name in ["CesiumMan.glb","RiggedFigure.glb","mannequiny.glb","mesh2motion_human_rigify.glb","kaykit_Knight.glb","quaternius_cyberpunk_Character.glb","CoolLoops_mixamorig_vrm0.vrm","Fox.glb","quaternius_Spider.glb","quaternius_MandarinFish.glb","RiggedSimple.glb","quaternius_Robot.glb","kaykit_mannequin/manny_med_mod.gltf","SimpleSkin.gltf","RecursiveSkeletons.glb"] {
        let Some((rig, _)) = rigs::load(&format!("rigs/{name}")) else { return };
        let a = analyze(&rig).expect("a skin");
        println!("{}", table(name, &rig, &a));
    }
}
