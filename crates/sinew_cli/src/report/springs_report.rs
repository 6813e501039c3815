//! Reports springs of a character and of a file.

use super::number;
use super::table::{Table, counted, shown};
use serde_json::{Value, json};
use sinew::anim::springs::{
    ColliderShape, LimitKind, Side, SpringBone, SpringChain, SpringCollider, SpringLink, Springs,
};
use sinew::anim::{JointIdx, Rig};
use sinew::math::{Vec3, direction, max, min};
use sinew::ragdoll::{CharacterDef, RagdollDef};

/// Largest number of joint names in a note.
const MOST_NAMES: usize = 6;

/// Springs that a character wears in a bake.
pub struct SpringsReport {
    chains: usize,
    bones: usize,
    links: usize,
    /// Names of requested joints that do not swing.
    left_out: Vec<String>,
}

impl SpringsReport {
    /// Creates the report on the springs of a character.
    pub fn of(character: &CharacterDef) -> Self {
        let springs = character.springs();
        let name = |&joint: &JointIdx| character.rig.joints[joint].name.clone();
        Self {
            chains: springs.source().chains.len(),
            bones: springs.joints().len(),
            links: springs.link_count(),
            left_out: springs.left_out().iter().map(name).collect(),
        }
    }

    /// Returns the JSON object of the report.
    pub fn to_json(&self) -> Value {
        json!({ "chains": self.chains, "bones": self.bones, "links": self.links, "left_out": self.left_out })
    }

    /// Returns notes, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.bones > 0 {
            let bones = counted(self.bones, "spring bone swings", "spring bones swing");
            let linked = match self.links {
                0 => String::new(),
                links => format!(" with {} across", counted(links, "link", "links")),
            };
            notes.push(format!(
                "{bones}, in {}{linked}; --no-springs turns them off",
                counted(self.chains, "chain", "chains")
            ));
        }
        if !self.left_out.is_empty() {
            let names = listed(&self.left_out);
            notes.push(format!(
                "no springs for {names}: bodies of the ragdoll move them, or they have no length"
            ));
        }
        notes
    }
}

/// Returns the first few names.
pub fn listed(names: &[String]) -> String {
    let first: Vec<String> = names.iter().take(MOST_NAMES).map(|name| shown(name)).collect();
    let more = names.len().saturating_sub(MOST_NAMES);
    if more == 0 { first.join(", ") } else { format!("{} and {more} more", first.join(", ")) }
}

/// Returns the springs of a file: each chain with its bones and their settings.
pub fn springs_json(rig: &Rig) -> Value {
    let chain = |chain: &SpringChain| {
        let first = &chain.bones[0];
        let names: Vec<&str> = chain.bones.iter().map(|bone| rig.joints[bone.joint].name.as_str()).collect();
        json!({
            "name": chain.name,
            "joints": names,
            "bones": chain.bones.iter().map(|bone| bone_json(rig, bone)).collect::<Vec<_>>(),
            "stiffness": number(first.stiffness),
            "gravity": first.gravity.to_array().map(number),
            "drag": number(first.drag),
            "radius": number(first.radius),
            "limit": first.limit.map(|limit| limit_name(limit.kind)),
            "center": chain.center.map(|joint| rig.joints[joint].name.as_str()),
            "colliders": chain.colliders,
        })
    };
    rig.springs.chains.iter().map(chain).collect()
}

fn bone_json(rig: &Rig, bone: &SpringBone) -> Value {
    json!({
        "joint": rig.joints[bone.joint].name,
        "tail": bone.tail.to_array().map(number),
        "stiffness": number(bone.stiffness),
        "gravity": bone.gravity.to_array().map(number),
        "drag": number(bone.drag),
        "radius": number(bone.radius),
        "limit": bone.limit.map(|limit| limit_name(limit.kind)),
        "limit_deg": bone.limit.map(|limit| {
            angles(limit.kind).into_iter().map(|angle| number(angle.to_degrees())).collect::<Vec<_>>()
        }),
    })
}

/// Returns the colliders of a file's springs, in the order that chains refer to.
pub fn colliders_json(rig: &Rig) -> Value {
    let collider = |collider: &SpringCollider| {
        let it = Described::of(&collider.shape);
        json!({
            "joint": rig.joints[collider.joint].name,
            "shape": it.name,
            "offset": it.offset.to_array().map(number),
            "tail": it.tail.map(|tail| tail.to_array().map(number)),
            "normal": it.normal.map(|normal| normal.to_array().map(number)),
            "radius": it.radius.map(number),
            "inside": it.keeps == Side::Inside,
        })
    };
    rig.springs.colliders.iter().map(collider).collect()
}

/// Returns the links across strands: joints, share, and mode.
pub fn links_json(rig: &Rig, links: &[SpringLink]) -> Value {
    let link = |link: &SpringLink| {
        json!({
            "joints": link.joints.map(|joint| rig.joints[joint].name.as_str()),
            "share": number(link.share),
            "holds_apart": link.holds_apart,
        })
    };
    links.iter().map(link).collect()
}

/// Returns the text of links across strands; empty without any.
pub fn links_text(rig: &Rig, links: &[SpringLink]) -> String {
    if links.is_empty() {
        return String::new();
    }
    let mut table = Table::titled(&["from", "to", "share", "holds apart"]);
    for link in links {
        let [from, to] = link.joints.map(|joint| shown(&rig.joints[joint].name));
        let holds = if link.holds_apart { "yes" } else { "no" };
        table.row([from, to, short(link.share), holds.to_owned()]);
    }
    format!("\nLinks of springs\n{}", table.to_text())
}

/// Returns the text of a file's springs: its chains, with the settings of their joints in the file's units, each as one
/// number or a range, and their colliders. `format` is the name of their format; empty without springs.
pub fn springs_text(rig: &Rig, format: Option<&str>) -> String {
    let Some(format) = format else { return String::new() };
    let springs = &rig.springs;
    if springs.is_empty() {
        return format!("\nSprings ({format}): none has a joint to swing\n");
    }
    let (chains, bones) = (springs.chains.len(), springs.bone_count());
    let mut text = format!(
        "\nSprings ({format}): {} of {}\n",
        counted(chains, "chain", "chains"),
        counted(bones, "bone", "bones")
    );
    text += &springs_table(rig).to_text();
    if !springs.colliders.is_empty() {
        text += "\nColliders of springs\n";
        text += &colliders_table(rig).to_text();
    }
    text
}

fn springs_table(rig: &Rig) -> Table {
    let titles = [
        "spring",
        "joints",
        "bones",
        "stiffness",
        "gravity",
        "drag",
        "radius",
        "limit",
        "center",
        "colliders",
    ];
    let mut table = Table::titled(&titles);
    for chain in &rig.springs.chains {
        let span = |value: fn(&SpringBone) -> f32| span(chain.bones.iter().map(value));
        let name = |joint: JointIdx| shown(&rig.joints[joint].name);
        let [first, last] =
            [&chain.bones[0], &chain.bones[chain.bones.len() - 1]].map(|bone| name(bone.joint));
        table.row([
            shown(&chain.name),
            if chain.bones.len() == 1 { first } else { format!("{first} to {last}") },
            chain.bones.len().to_string(),
            span(|bone| bone.stiffness),
            gravity(chain),
            span(|bone| bone.drag),
            span(|bone| bone.radius),
            limits(chain),
            chain.center.map_or("-".to_owned(), name),
            indices(&chain.colliders),
        ]);
    }
    table
}

fn colliders_table(rig: &Rig) -> Table {
    let mut table = Table::titled(&["number", "joint", "shape", "radius", "at"]);
    for (index, collider) in rig.springs.colliders.iter().enumerate() {
        let it = Described::of(&collider.shape);
        let mut at = vector(it.offset);
        at += &it.tail.map_or(String::new(), |tail| format!(" to {}", vector(tail)));
        at += &it.normal.map_or(String::new(), |normal| format!(", normal {}", vector(normal)));
        let side = if it.keeps == Side::Inside { ", inside" } else { "" };
        table.row([
            index.to_string(),
            shown(&rig.joints[collider.joint].name),
            format!("{}{side}", it.name),
            it.radius.map_or("-".to_owned(), short),
            at,
        ]);
    }
    table
}

/// Formats a number with at most four significant digits, and zero without a sign.
fn short(x: f32) -> String {
    let x = if x == 0.0 { 0.0 } else { x };
    format!("{x:.3e}").parse::<f32>().unwrap_or(x).to_string()
}

fn vector(v: Vec3) -> String {
    format!("({})", v.to_array().map(short).join(", "))
}

/// Formats one number, or the smallest and the largest.
fn span(values: impl Iterator<Item = f32>) -> String {
    let none = (f32::INFINITY, f32::NEG_INFINITY);
    let (low, high) = values.fold(none, |(low, high), x| (min(low, x), max(high, x)));
    let (low, high) = (short(low), short(high));
    if low == high { low } else { format!("{low} to {high}") }
}

/// Returns the magnitude of the gravity, and its direction unless that is down.
fn gravity(chain: &SpringChain) -> String {
    let size = span(chain.bones.iter().map(|bone| bone.gravity.length()));
    let way = |bone: &SpringBone| direction(bone.gravity).map(vector);
    let mut ways: Vec<String> = chain.bones.iter().filter_map(way).collect();
    ways.dedup();
    match &ways[..] {
        [] => size,
        [one] if *one == vector(Vec3::NEG_Y) => size,
        [one] => format!("{size} along {one}"),
        _ => format!("{size}, various directions"),
    }
}

/// Returns the kinds of limits with their angles in degrees, and the number of limited bones if not all are.
fn limits(chain: &SpringChain) -> String {
    let kinds: Vec<LimitKind> =
        chain.bones.iter().filter_map(|bone| bone.limit.map(|limit| limit.kind)).collect();
    let mut names: Vec<&str> = kinds.iter().map(|&kind| limit_name(kind)).collect();
    names.sort_unstable();
    names.dedup();
    let of = |name: &&str| {
        let same: Vec<Vec<f32>> =
            kinds.iter().filter(|&&kind| limit_name(kind) == *name).map(|&kind| angles(kind)).collect();
        let angle = |k: usize| format!("{}°", span(same.iter().map(|angles| angles[k].to_degrees())));
        let angles: Vec<String> = (0..same[0].len()).map(angle).collect();
        format!("{name} {}", angles.join(" × "))
    };
    let mut text = names.iter().map(of).collect::<Vec<_>>().join(", ");
    if kinds.is_empty() {
        text = "-".to_owned();
    } else if kinds.len() < chain.bones.len() {
        text += &format!(" ({} of {})", kinds.len(), chain.bones.len());
    }
    text
}

/// Returns collider numbers, with consecutive runs as ranges.
fn indices(list: &[usize]) -> String {
    let mut sorted = list.to_vec();
    sorted.sort_unstable();
    let runs = sorted.chunk_by(|a, b| a + 1 == *b);
    let run = |run: &[usize]| match run {
        [one] => one.to_string(),
        [first, .., last] => format!("{first}-{last}"),
        [] => String::new(),
    };
    let text = runs.map(run).collect::<Vec<_>>().join(", ");
    if text.is_empty() { "-".to_owned() } else { text }
}

/// Returns advice on joints that could swing according to their names and that no ragdoll body moves, for a rig without
/// springs; `None` without any.
pub fn proposal(rig: &Rig, springs: &Springs, ragdoll: &RagdollDef) -> Option<String> {
    let name = |bone: &SpringBone| rig.joints[bone.joint].name.clone();
    let has_body = |bone: &SpringBone| ragdoll.bodies.iter().any(|body| body.bone == name(bone));
    let swings = |chain: &&SpringChain| !chain.bones.iter().all(has_body);
    let roots: Vec<String> =
        springs.chains.iter().filter(swings).map(|chain| name(&chain.bones[0])).collect();
    (!roots.is_empty()).then(|| {
        format!(
            "{} could swing, by their names: --guess-springs of 'sinew bake', or \"springs\": \"names\" in the settings, enables them",
            listed(&roots)
        )
    })
}

fn limit_name(kind: LimitKind) -> &'static str {
    match kind {
        LimitKind::Cone { .. } => "cone",
        LimitKind::Hinge { .. } => "hinge",
        LimitKind::Spherical { .. } => "spherical",
    }
}

/// Returns the angles of a limit, radians.
fn angles(kind: LimitKind) -> Vec<f32> {
    match kind {
        LimitKind::Cone { angle } | LimitKind::Hinge { angle } => vec![angle],
        LimitKind::Spherical { phi, theta } => vec![phi, theta],
    }
}

/// Fields of a collider, some of which only some shapes have.
struct Described {
    name: &'static str,
    offset: Vec3,
    tail: Option<Vec3>,
    normal: Option<Vec3>,
    radius: Option<f32>,
    keeps: Side,
}

impl Described {
    fn of(shape: &ColliderShape) -> Self {
        let bare = |name, offset| Self {
            name,
            offset,
            tail: None,
            normal: None,
            radius: None,
            keeps: Side::Outside,
        };
        match *shape {
            ColliderShape::Sphere { offset, radius, keeps } => {
                Self { radius: Some(radius), keeps, ..bare("sphere", offset) }
            }
            ColliderShape::Capsule { offset, tail, radius, keeps } => {
                Self { tail: Some(tail), radius: Some(radius), keeps, ..bare("capsule", offset) }
            }
            ColliderShape::Plane { offset, normal } => Self { normal: Some(normal), ..bare("plane", offset) },
        }
    }
}
