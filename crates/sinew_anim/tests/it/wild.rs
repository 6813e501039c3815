//! Compares the roles of public rigs with a table that was written before the recogniser first ran on them.

use crate::rigs;
use needs_data::needs_data;
use sinew_anim::roles::HUMANOID_ROLES;
use sinew_anim::{Joint, LocalTransform, Primitive, Rig, RigMesh, Skin, analyze};
use sinew_math::{Affine, Random, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// Roles of a convention: joint name per role name.
struct Truth {
    convention: String,
    files: Vec<String>,
    roles: BTreeMap<String, String>,
}

/// Expands `[a|b]` to a for left and b for right; without brackets both are equal.
fn sides(text: &str) -> [String; 2] {
    let parts = text.split_once('[').and_then(|(before, rest)| {
        let (choice, after) = rest.split_once(']')?;
        let (left, right) = choice.split_once('|')?;
        Some([left, right].map(|side| format!("{before}{side}{after}")))
    });
    parts.unwrap_or_else(|| [text.to_owned(), text.to_owned()])
}

fn expected_roles() -> Vec<Truth> {
    let mut conventions: Vec<Truth> = Vec::new();
    for line in
        include_str!("../data/truth.txt").lines().filter(|line| !line.is_empty() && !line.starts_with('#'))
    {
        let (word, rest) = line.split_once(' ').expect("two words a line");
        if word == "convention" {
            conventions.push(Truth { convention: rest.into(), files: vec![], roles: BTreeMap::new() });
            continue;
        }
        let truth = conventions.last_mut().expect("a convention first");
        let [left, right] = sides(rest);
        if word == "files" {
            truth.files = rest.split(' ').map(str::to_owned).collect();
        } else if word.starts_with(char::is_uppercase) {
            truth.roles.extend([(format!("left{word}"), left), (format!("right{word}"), right)]);
        } else {
            truth.roles.insert(word.into(), rest.into());
        }
    }
    conventions
}

/// Returns the files under ../shared/data that match a pattern with at most one star.
fn files(pattern: &str) -> Vec<String> {
    let Some((before, after)) = pattern.split_once('*') else { return vec![pattern.into()] };
    let (folder, start) = before.split_once('/').expect("a folder");
    let names = std::fs::read_dir(format!("{}{folder}", rigs::DATA)).expect("the folder");
    let mut found: Vec<String> = names
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("a name in UTF-8"))
        .filter(|name| name.starts_with(start) && name.ends_with(after))
        .map(|name| format!("{folder}/{name}"))
        .collect();
    found.sort();
    found
}

/// Makes a rig from a skeleton's joints, with skin around each bone that moves skin in the file.
fn of_skeleton(json: &serde_json::Value) -> Rig {
    let nodes = json["nodes"].as_array().expect("nodes");
    let number = |value: &serde_json::Value| value.as_f64().expect("a number") as f32;
    let place = |i: usize| {
        let at = nodes[i]["rest"].as_array().expect("a place");
        Vec3::new(number(&at[0]), number(&at[1]), number(&at[2]))
    };
    let parent = |i: usize| usize::try_from(nodes[i]["parent"].as_i64().expect("an index")).ok();
    let vertices = |i: usize| nodes[i]["vertices"].as_u64().unwrap_or(0);
    // Compressed meshes have no counts, so every joint of the skin counts, except joints that never move skin.
    let counted = (0..nodes.len()).any(|i| vertices(i) > 0);
    let bare = |i: usize| {
        let name = nodes[i]["name"].as_str().expect("a name");
        ["Root", "root", "Body"].contains(&name) || name.starts_with("PoleTarget") || name.ends_with("_end")
    };
    let in_skin = |i: usize| nodes[i]["joint"].as_bool() == Some(true) && !bare(i);
    let moves = |i: usize| if counted { vertices(i) > 0 } else { in_skin(i) };
    let mut bones: Vec<(usize, Vec3, Vec3)> = Vec::new();
    for i in (0..nodes.len()).filter(|&i| moves(i)) {
        let children: Vec<usize> = (0..nodes.len()).filter(|&k| parent(k) == Some(i)).collect();
        let length = |k: &usize| (place(*k) - place(i)).length();
        let longest = children.into_iter().max_by(|a, b| length(a).total_cmp(&length(b)));
        // The direction of the last bone of a chain is unknown; straight up implies no forward direction.
        let end = Vec3::Y * parent(i).map_or(0.1, |p| 0.4 * (place(i) - place(p)).length());
        bones.push((i, place(i), longest.map_or(place(i) + end, place)));
    }
    rig_of(nodes.iter().map(|node| node["name"].as_str().expect("a name")), &parent, &place, &bones)
}

/// Makes a rig with a double pyramid of skin around every bone (joint, from, to).
pub fn rig_of<'a>(
    names: impl Iterator<Item = &'a str>,
    parent: &dyn Fn(usize) -> Option<usize>,
    place: &dyn Fn(usize) -> Vec3,
    bones: &[(usize, Vec3, Vec3)],
) -> Rig {
    let mut rig = Rig::default();
    let (mut skin, mut skinned) =
        (Skin { name: String::new(), joints: vec![], inverse_bind: vec![] }, Primitive::default());
    for (i, name) in names.enumerate() {
        let translation = place(i) - parent(i).map_or(Vec3::ZERO, place);
        let rest = LocalTransform { translation, ..LocalTransform::default() };
        rig.joints.push(Joint { name: name.into(), parent: parent(i), rest, source: i });
        skin.joints.push(i);
        skin.inverse_bind.push(Affine { translation: -place(i), ..Affine::IDENTITY });
    }
    for &(joint, from, to) in bones {
        let first = u32::try_from(skinned.positions.len()).expect("few");
        let (middle, r) = ((from + to) * 0.5, 0.15 * (to - from).length() + 1e-4);
        let belt = [Vec3::X, Vec3::Z, -Vec3::X, -Vec3::Z].map(|way| middle + way * r + Vec3::Y * (0.3 * r));
        skinned.positions.extend([from, to]);
        skinned.positions.extend(belt);
        skinned.joints.extend([[u16::try_from(joint).expect("few"), 0, 0, 0]; 6]);
        skinned.weights.extend([[1.0, 0.0, 0.0, 0.0]; 6]);
        for k in 0..4 {
            let (a, b) = (2 + k, 2 + (k + 1) % 4);
            skinned.indices.extend([0, a, b, 1, b, a].map(|corner| first + corner));
        }
    }
    rig.skins = vec![skin];
    rig.meshes = vec![RigMesh { name: String::new(), joint: 0, skin: Some(0), primitives: vec![skinned] }];
    rig
}

/// Returns the number of correct roles, and the number of roles that are expected or found.
fn score(rig: &Rig, truth: &BTreeMap<String, String>, complaints: &mut Vec<String>) -> (usize, usize) {
    let names: Vec<String> = rig.joints.iter().map(|joint| joint.name.clone()).collect();
    score_of(rig, &names, truth, complaints)
}

/// Like [`score`], for a rig whose joints have other names in the table.
fn score_of(
    rig: &Rig,
    names: &[String],
    truth: &BTreeMap<String, String>,
    complaints: &mut Vec<String>,
) -> (usize, usize) {
    let found = analyze(rig).expect("a skin");
    let mut all: BTreeSet<(String, String)> = BTreeSet::new();
    let given: BTreeSet<(String, String)> = found
        .roles
        .iter()
        .enumerate()
        .filter_map(|(joint, guess)| Some((guess.as_ref()?.role, names[joint].clone())))
        // Generic roles do not count: if a human role is expected, it is missing.
        .filter(|(role, _)| HUMANOID_ROLES.contains(role))
        .map(|(role, name)| (role.name(), name))
        .collect();
    let wanted: BTreeSet<(String, String)> =
        truth.iter().map(|(role, joint)| (role.clone(), joint.clone())).collect();
    all.extend(given.iter().chain(&wanted).cloned());
    let roles: BTreeSet<&String> = all.iter().map(|(role, _)| role).collect();
    let right = given.intersection(&wanted).count();
    let wrong: Vec<String> =
        wanted.difference(&given).map(|(role, joint)| format!("{role}={joint}")).collect();
    let extra: Vec<String> =
        given.difference(&wanted).map(|(role, joint)| format!("+{role}={joint}")).collect();
    if !found.humanoid {
        complaints.push(format!("no humanoid: {:?}", found.notes));
    } else if wrong.len() + extra.len() > 0 {
        complaints.push(format!("{} {}", wrong.join(" "), extra.join(" ")));
    }
    (right, roles.len())
}

/// Returns the rig with every joint displaced at random, so that symmetry finds no limb and only names decide.
fn blurred(rig: &Rig, seed: u64) -> Rig {
    let mut rig = rig.clone();
    let mut random = Random::new(seed);

    let places: Vec<Vec3> = rig.skins[0].inverse_bind.iter().map(|inverse| -inverse.translation).collect();
    let size = places.iter().fold(0.0f32, |size, p| size.max((*p - places[0]).length()));
    for inverse in &mut rig.skins[0].inverse_bind {
        inverse.translation += random.in_cube() * (0.05 * size);
    }
    rig
}

/// Returns the rig with numbers for names and without roles stated by the file.
fn numbered(rig: &Rig) -> Rig {
    let mut rig = rig.clone();
    rig.stated_roles.clear();
    for (number, joint) in rig.joints.iter_mut().enumerate() {
        joint.name = number.to_string();
    }
    rig
}

/// Correct roles of a file, each as (correct, all).
#[derive(Clone, Copy, Default)]
struct Scores {
    /// Scores with names and shape.
    plain: (usize, usize),
    /// Scores with every joint displaced, so that only names decide; for skeletons.
    by_names: Option<(usize, usize)>,
    /// Scores with numbers for names, so that only the shape decides; for files with a mesh, because other shapes are
    /// synthetic.
    by_shape: Option<(usize, usize)>,
}

/// Loads a rig of the shared data.
fn load(file: &str) -> Rig {
    if file.starts_with("skeletons/") {
        let bytes = rigs::bytes(file);
        return of_skeleton(&serde_json::from_slice(&bytes).expect("JSON"));
    }
    let path = format!("{}{file}", rigs::DATA);
    sinew_formats::load_gltf(path, sinew_formats::ReadOptions::default()).expect("a rig").rig
}

/// Returns the scores of a file, and its errors in words. `unstated` is the table without roles stated by the file.
fn measure(file: &str, truth: &Truth, unstated: &Truth) -> (Scores, String) {
    let rig = load(file);
    let mut complaints = Vec::new();
    let mut scores = Scores { plain: score(&rig, &truth.roles, &mut complaints), ..Scores::default() };
    if file.starts_with("skeletons/") {
        complaints.push("| by names:".into());
        scores.by_names = Some(score(&blurred(&rig, 7), &truth.roles, &mut complaints));
    } else {
        complaints.push("| by shape:".into());
        let names: Vec<String> = rig.joints.iter().map(|joint| joint.name.clone()).collect();
        scores.by_shape = Some(score_of(&numbered(&rig), &names, &unstated.roles, &mut complaints));
    }
    (scores, complaints.join(" "))
}

/// Writes the table as JSON to the path given by `cargo xtask wild`.
fn write_table(table: &[(String, Scores)]) {
    let Some(path) = std::env::var_os("SINEW_WILD_ROLES") else { return };
    let pair = |(right, all): (usize, usize)| serde_json::json!([right, all]);
    let rows: serde_json::Map<String, serde_json::Value> = table
        .iter()
        .map(|(file, scores)| {
            let row = serde_json::json!({
                "plain": pair(scores.plain),
                "by_names": scores.by_names.map(pair),
                "by_shape": scores.by_shape.map(pair),
            });
            (file.clone(), row)
        })
        .collect();
    std::fs::write(path, serde_json::Value::from(rows).to_string()).expect("the table is written");
}

#[needs_data]
#[test]
fn roles_of_public_rigs_reach_the_required_share() {
    let (mut rows, mut table) = (String::new(), Vec::new());
    let expected_roles = expected_roles();
    for truth in &expected_roles {
        // `Mixamo, stated as VRM` without the statement is Mixamo.
        let plain = truth.convention.split(", stated").next().expect("at least one part");
        let unstated = expected_roles.iter().find(|other| other.convention == plain).unwrap_or(truth);
        for file in truth.files.iter().flat_map(|pattern| files(pattern)) {
            let (scores, complaints) = measure(&file, truth, unstated);
            let Scores { plain, by_names, by_shape } = scores;
            let convention = &truth.convention;
            rows += &format!("{file} ({convention}): {plain:?} {by_names:?} {by_shape:?} {complaints}\n");
            table.push((file, scores));
        }
    }
    write_table(&table);
    let sum = |of: fn(&Scores) -> Option<(usize, usize)>| {
        let all = table.iter().filter_map(|(_, scores)| of(scores));
        all.fold((0, 0), |sum, score| (sum.0 + score.0, sum.1 + score.1))
    };
    let sums = [
        (98, sum(|scores| Some(scores.plain))),
        (98, sum(|scores| scores.by_names)),
        (90, sum(|scores| scores.by_shape)),
    ];
    println!("{rows}all: {sums:?}");
    for (share, (right, all)) in sums {
        assert!(
            100 * right >= share * all,
            "{right} of {all} roles are right; the user must confirm {share} %\n{rows}"
        );
    }
}

/// Prefixes of the files of animals, machines and fish; some of these have arms, hips and a head by name.
const BEASTS: [&str; 14] = [
    "quaternius_animals_",
    "quaternius_dinosaurs_",
    "quaternius_easy_enemies_",
    "quaternius_fish_",
    "quaternius_cute_fish_",
    "quaternius_tank_",
    "quaternius_cyberpunk_Enemy_",
    "quaternius_platformer_game_B",
    "quaternius_platformer_game_Crab",
    "playground_frontend_Fox",
    "pet_proj_wolf",
    "Multi_",
    "godot_4_3D_Characters_",
    "siege_bakery_",
];

#[needs_data]
#[test]
fn animals_and_machines_are_not_human() {
    let mut seen = 0;
    for file in BEASTS.iter().flat_map(|start| files(&format!("skeletons/{start}*"))) {
        let json = serde_json::from_slice(&rigs::bytes(&file)).expect("JSON");
        let rig = of_skeleton(&json);
        for rig in [rig.clone(), blurred(&rig, 2)] {
            assert!(!analyze(&rig).expect("a skin").humanoid, "{file}");
        }
        seen += 1;
    }
    assert!(seen > 35, "{seen} files");
}

#[test]
fn dog_with_human_names_is_not_human() {
    let dog = |role: &str| {
        let at = human(role);
        let trunk = !role.starts_with("left") && !role.starts_with("right");
        let arm = ["Arm", "Hand", "Shoulder"].iter().any(|part| role.contains(part));
        match (trunk, arm) {
            // The upright direction becomes forward, and arms hang down below the chest.
            (true, _) => Vec3::new(0.0, 0.6, at.y - 0.95),
            (_, true) => Vec3::new(0.12 * at.x.signum(), 0.65 - 0.8 * (at.x.abs() - 0.04), 0.4),
            _ => Vec3::new(at.x, 0.6 * at.y, 0.05 + at.z),
        }
    };
    let (_, mut lines) = conventions().into_iter().find(|(name, _)| name == "Unreal").expect("a convention");
    // Paws have no role, because otherwise the animal would walk on hands.
    let gone = |line: &Line| line.2.as_deref().is_some_and(|role| role.ends_with("Hand"));
    for line in lines.iter_mut().filter(|line| gone(line)) {
        line.0 = "dewclaw".into();
    }
    let rig = dressed_as(&lines, &dog);
    for rig in [rig.clone(), blurred(&rig, 4)] {
        let found = analyze(&rig).expect("a skin");
        assert!(!found.humanoid, "{:?}", found.notes);
    }
}

/// Returns the role of the arm at +X of a human with numbers for names.
fn side_of_plus_x(human: &dyn Fn(&str) -> Vec3) -> String {
    let (_, lines) = conventions().into_iter().find(|(name, _)| name == "Unreal").expect("a convention");
    let found = analyze(&numbered(&dressed_as(&lines, human))).expect("a skin");
    let arm = lines.iter().position(|line| line.2.as_deref() == Some("leftUpperArm")).expect("an arm");
    found.roles[arm].as_ref().expect("a role").role.name()
}

#[test]
fn elbow_bend_gives_the_front_without_feet() {
    for ahead in [1.0, -1.0] {
        let bent = |role: &str| {
            let at = human(role);
            let z = if role.ends_with("LowerArm") { -0.08 * ahead } else { 0.0 };
            Vec3::new(at.x, at.y, z)
        };
        assert_eq!(side_of_plus_x(&bent), if ahead > 0.0 { "leftUpperArm" } else { "rightUpperArm" });
    }
}

#[test]
fn fingers_on_a_forearm_replace_the_hand() {
    // Each forearm has four fingers that start at the wrist or at the end of a palm; fingers on a hand are only
    // fingers.
    let rig = |spread: f32, on_hand: bool| {
        let (_, mut lines) =
            conventions().into_iter().find(|(name, _)| name == "Unreal").expect("a convention");
        let mut places: Vec<Vec3> = Vec::new();
        for line in &mut lines {
            let on = line.1.map_or(Vec3::Y * 0.9, |parent| places[parent]);
            places.push(line.2.as_deref().map_or(on, human));
            line.3 &= line.2.is_some();
        }
        for side in ["left", "right"] {
            let of = |role: &str| {
                let role = format!("{side}{role}");
                lines.iter().position(|line| line.2.as_deref() == Some(role.as_str())).expect("a joint")
            };
            let (arm, hand) = (of("LowerArm"), of("Hand"));
            let (on, from) = if on_hand { (hand, places[hand]) } else { (arm, places[hand]) };
            let out = Vec3::X * places[hand].x.signum();
            if !on_hand {
                // The hand has no skin.
                lines[hand].3 = false;
            }
            for finger in 0..4 {
                let aside = Vec3::Z * (finger as f32 - 1.5);
                let start = from + out * if on_hand { 0.09 } else { 0.0 } + aside * spread;
                let mut parent = on;
                for bone in 0..2 {
                    lines.push((format!("f{finger}{bone}"), Some(parent), None, true));
                    places.push(start + (out * 0.05 + aside * 0.02) * bone as f32);
                    parent = lines.len() - 1;
                }
            }
        }
        let mut bones = Vec::new();
        for (i, _) in lines.iter().enumerate().filter(|(_, line)| line.3) {
            let next = (i + 1..lines.len()).find(|&k| lines[k].1 == Some(i) && lines[k].3);
            bones.push((i, places[i], next.map_or(places[i] + Vec3::Y * 0.05, |k| places[k])));
        }
        let names = lines.iter().map(|line| line.0.as_str());
        (numbered(&rig_of(names, &|i| lines[i].1, &|i| places[i], &bones)), lines)
    };
    for (spread, on_hand) in [(0.0, false), (0.02, false), (0.02, true)] {
        let (rig, lines) = rig(spread, on_hand);
        let found = analyze(&rig).expect("a skin");
        for (joint, line) in lines.iter().enumerate() {
            let Some(role) = line.2.as_deref().filter(|role| role.contains("Arm") || role.ends_with("Hand"))
            else {
                continue;
            };
            let given = found.roles[joint].as_ref().map(|guess| guess.role.name());
            let wanted = (line.3).then(|| role.to_owned());
            assert_eq!(given, wanted, "{role}, fingers {spread} m apart, on a hand: {on_hand}");
        }
        let hands = found.roles.iter().flatten().filter(|guess| guess.role.name().ends_with("Hand")).count();
        assert_eq!(hands, if on_hand { 2 } else { 0 }, "fingers {spread} m apart");
    }
}

/// A joint of a skeleton of conventions.txt: name, parent, role if any, and true if it has skin.
type Line = (String, Option<usize>, Option<String>, bool);

fn conventions() -> Vec<(String, Vec<Line>)> {
    let text = include_str!("../data/conventions.txt");
    let blocks = text.split("convention ").skip(1);
    let read = |block: &str| {
        let (name, lines) = block.split_once('\n').expect("lines");
        let lines: Vec<&str> = lines.lines().filter(|line| !line.is_empty()).collect();
        let mut joints = Vec::new();
        add_lines(&lines, None, None, &mut joints);
        (name.to_owned(), joints)
    };
    blocks.map(read).collect()
}

/// Adds the joints of lines at one depth or below; for a pair, each side with all its descendants.
fn add_lines(lines: &[&str], parent: Option<usize>, side: Option<usize>, out: &mut Vec<Line>) {
    let depth = |line: &str| line.len() - line.trim_start_matches(' ').len();
    let mut at = 0;
    while at < lines.len() {
        let end = (at + 1..lines.len()).find(|&i| depth(lines[i]) <= depth(lines[at])).unwrap_or(lines.len());
        let (name, role) =
            lines[at].trim().split_once(" = ").map_or((lines[at].trim(), None), |(a, b)| (a, Some(b)));
        let both = if name.contains('[') && side.is_none() { vec![Some(0), Some(1)] } else { vec![side] };
        for side in both {
            let name = sides(name)[side.unwrap_or(0)].clone();
            let role = role.map(|role| match side {
                Some(side) => format!("{}{role}", ["left", "right"][side]),
                None => role.to_owned(),
            });
            let bare = name.starts_with('-');
            let joint = out.len();
            out.push((name.trim_start_matches('-').to_owned(), parent, role, !bare));
            add_lines(&lines[at + 1..end], Some(joint), side, out);
        }
        at = end;
    }
}

/// Returns the position of a human joint by role, metres; the toes point forward (+Z).
fn human(role: &str) -> Vec3 {
    let (x, role) = match (role.strip_prefix("left"), role.strip_prefix("right")) {
        (Some(part), _) => (1.0, part),
        (_, Some(part)) => (-1.0, part),
        _ => (0.0, role),
    };
    let [across, up, ahead] = match role {
        "hips" => [0.0, 0.95, 0.0],
        "spine" => [0.0, 1.07, 0.0],
        "chest" => [0.0, 1.2, 0.0],
        "upperChest" => [0.0, 1.32, 0.0],
        "neck" => [0.0, 1.5, 0.0],
        "head" => [0.0, 1.6, 0.0],
        "Shoulder" => [0.04, 1.44, 0.0],
        "UpperArm" => [0.18, 1.44, 0.0],
        "LowerArm" => [0.46, 1.44, 0.0],
        "Hand" => [0.71, 1.44, 0.0],
        "UpperLeg" => [0.1, 0.92, 0.0],
        "LowerLeg" => [0.1, 0.5, 0.0],
        "Foot" => [0.1, 0.09, 0.0],
        "Toes" => [0.1, 0.03, 0.14],
        other => panic!("no role {other}"),
    };
    Vec3::new(x * across, up, ahead)
}

/// Makes a human with the joints of a convention; a joint without a role is between its parent and its child.
fn dressed(lines: &[Line]) -> Rig {
    dressed_as(lines, &human)
}

/// Like [`dressed`], with other joint positions.
fn dressed_as(lines: &[Line], human: &dyn Fn(&str) -> Vec3) -> Rig {
    let mut places: Vec<Vec3> = Vec::new();
    for (i, (name, parent, role, _)) in lines.iter().enumerate() {
        let carried =
            (i + 1..lines.len()).find(|&k| lines[k].1 == Some(i)).and_then(|k| lines[k].2.as_deref());
        let from = parent.map_or(Vec3::Y * 0.9, |parent| places[parent]);
        // Joints are displaced slightly by the length of the name, so that no two coincide.
        let aside = Vec3::new(0.0, 0.004, 0.004) * (1.0 + name.len() as f32 * 0.1);
        places.push(match (role, carried) {
            (Some(role), _) => human(role),
            (None, Some(carried)) if parent.is_some() => (from + human(carried)) * 0.5 + aside,
            _ => from + aside * 2.0,
        });
    }
    let mut bones = Vec::new();
    for (i, line) in lines.iter().enumerate().filter(|(_, line)| line.3) {
        let next = (i + 1..lines.len()).find(|&k| lines[k].1 == Some(i) && lines[k].3);
        let end = if line.2.is_some() { Vec3::Y * 0.1 } else { Vec3::Y * 0.01 };
        bones.push((i, places[i], next.map_or(places[i] + end, |k| places[k])));
    }
    let names = lines.iter().map(|line| line.0.as_str());
    rig_of(names, &|i| lines[i].1, &|i| places[i], &bones)
}

#[test]
fn names_of_all_conventions_give_the_roles() {
    let mut wrong = String::new();
    for (convention, lines) in conventions() {
        let truth: BTreeMap<String, String> =
            lines.iter().filter_map(|line| Some((line.2.clone()?, line.0.clone()))).collect();
        let rig = dressed(&lines);
        for (what, rig) in [("in shape", rig.clone()), ("by names alone", blurred(&rig, 3))] {
            let mut complaints = Vec::new();
            let (right, all) = score(&rig, &truth, &mut complaints);
            if right < all {
                wrong += &format!("{convention}, {what}: {right} of {all}: {}\n", complaints.join(" "));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
