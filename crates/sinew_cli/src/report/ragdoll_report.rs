//! Report of `ragdoll build` on a ragdoll.

use crate::report::quality_report::{quality_json, quality_text};
use crate::report::skin_report::{SkinReport, skin_json, skin_text};
use crate::report::table::{Table, shown};
use crate::report::{Report, number, numbers};
use serde_json::{Map, Value, json};
use sinew::math::{Range, SwingTwistLimit, Vec3};
use sinew::physics::{JointKind, Shape};
use sinew::ragdoll::build::BuildReport;
use sinew::ragdoll::filter::{Overlap, Remedy, Seen};
use sinew::ragdoll::quality::GateReport;
use sinew::ragdoll::{DropReport, LimitSource, RagdollDef, RagdollJointDef};
use std::fmt::Write;

/// A ragdoll to report.
pub struct RagdollReport<'a> {
    /// File from which the ragdoll was built.
    pub file: &'a str,
    /// The ragdoll.
    pub def: &'a RagdollDef,
    /// Report of the ragdoll's build.
    pub build: &'a BuildReport,
    /// Processor time from the file to the definition, milliseconds.
    pub build_ms: f64,
    /// Results of eight drops and a wall hit.
    pub tested: &'a DropReport,
    /// Report on the drawn skin.
    pub skin: &'a SkinReport,
    /// Results of random falls, if requested.
    pub gated: Option<&'a GateReport>,
}

impl RagdollReport<'_> {
    /// Builds both forms of the report.
    pub fn finish(&self) -> Report {
        Report { json: self.to_json(), text: self.to_text() }
    }

    fn to_json(&self) -> Value {
        let def = self.def;
        let bone = |body: usize| &def.bodies[body].bone;
        let pairs: Vec<Value> = def.disabled_pairs.iter().map(|&(a, b)| json!([bone(a), bone(b)])).collect();
        json!({
            "bodies": (0..def.bodies.len()).map(|body| self.body_json(body)).collect::<Vec<_>>(),
            "joints": def.joints.iter().map(|joint| self.joint_json(joint)).collect::<Vec<_>>(),
            "total_mass_kg": number(def.total_mass),
            "height_m": number(def.height),
            "unit_scale": number(def.unit_scale),
            "up_axis": axis_name(def.up_axis),
            "dropped_bones": def.dropped_bones,
            "disabled_pairs": pairs,
            "overlaps": self.build.overlaps.iter().map(|overlap| self.overlap_json(overlap)).collect::<Vec<_>>(),
            "notes": self.build.notes,
            "build_ms": self.build_ms,
            "quality": self.quality_json(),
        })
    }

    fn quality_json(&self) -> Value {
        let DropReport { drop, wall, verdict, reasons, .. } = self.tested;
        let time = |seconds: Option<f32>| seconds.map_or(Value::Null, number);
        let mut quality = json!({
            "drop": quality_json(drop),
            "wall": quality_json(wall),
            "asleep_s": time(drop.asleep_s),
            "calm_to_asleep_s": time(drop.calm_to_asleep_s),
            "settled_omega_max_rad_s": time(drop.settled_omega_max),
            "nonadjacent_overlap_max_m": number(drop.nonadjacent_overlap_max_m),
            "skin": skin_json(self.skin),
        });
        if let Some(gated) = self.gated {
            quality["gate"] = gate_json(gated);
        }
        quality["verdict"] = verdict.name().into();
        quality["reasons"] = reasons.as_slice().into();
        quality
    }

    fn quality_text(&self) -> String {
        let DropReport { drop, wall, verdict, reasons, .. } = self.tested;
        let time = |seconds: Option<f32>| seconds.map_or("never".to_owned(), |s| format!("after {s:.1} s"));
        let mut text = format!("\nEight drops from 1 m, the worst: asleep {}\n", time(drop.asleep_s));
        text += &quality_text(drop);
        text += "Thrown at a wall at 15 m/s\n";
        text += &quality_text(wall);
        text += &skin_text(self.skin);
        if let Some(gated) = self.gated {
            text += &gate_text(gated);
        }
        let _ = writeln!(text, "verdict: {}", verdict.name());
        for reason in reasons {
            let _ = writeln!(text, "  {reason}");
        }
        text
    }

    fn body_json(&self, body: usize) -> Value {
        let body = &self.def.bodies[body];
        let mut object = Map::new();
        let mut put = |key: &str, value: Value| object.insert(key.into(), value);
        put("bone", json!(body.bone));
        put("role", json!(body.role));
        put("confidence", number(body.confidence));
        match body.shape {
            Shape::Box { half_extents } => {
                put("shape", json!("box"));
                put("half_extents_m", numbers(&half_extents.to_array()));
            }
            Shape::Sphere { radius } => {
                put("shape", json!("sphere"));
                put("radius_m", number(radius));
            }
            Shape::Capsule { half_height, radius } => {
                put("shape", json!("capsule"));
                put("radius_m", number(radius));
                put("half_height_m", number(half_height));
            }
            Shape::Hull(ref hull) => {
                put("shape", json!("hull"));
                put("points", json!(hull.vertices().len()));
            }
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                put("shape", json!("tapered_capsule"));
                put("radius_bottom_m", number(radius_bottom));
                put("radius_top_m", number(radius_top));
                put("half_height_m", number(half_height));
            }
            Shape::Cylinder { half_height, radius } | Shape::Cone { half_height, radius } => {
                let is_cone = matches!(body.shape, Shape::Cone { .. });
                put("shape", json!(if is_cone { "cone" } else { "cylinder" }));
                put("radius_m", number(radius));
                put("half_height_m", number(half_height));
            }
            Shape::HalfSpace | Shape::Mesh(_) | Shape::HeightField(_) => {
                unreachable!("no body of a ragdoll is a half-space or a surface")
            }
        }
        put("mass_kg", number(body.mass.mass));
        object.into()
    }

    /// Returns the reason why a pair does not collide or was thinned.
    fn overlap_json(&self, overlap: &Overlap) -> Value {
        let (a, b) = overlap.pair;
        let Seen { bind, limits, clips } = overlap.seen;
        let remedy = match overlap.remedy {
            Remedy::Tolerated => "tolerated",
            Remedy::OnlyBound => "only_bound",
            Remedy::Shrunk => "shrunk",
            Remedy::Disabled => "disabled",
        };
        json!({
            "bones": [self.def.bodies[a].bone, self.def.bodies[b].bone],
            "bind_m": number(bind),
            "limits_share": number(limits),
            "clips_share": clips.map_or(Value::Null, number),
            "remedy": remedy,
        })
    }

    fn joint_json(&self, joint: &RagdollJointDef) -> Value {
        let bone = |body: usize| &self.def.bodies[body].bone;
        let (kind, limit) = match joint.kind {
            JointKind::Ball { limit } => ("ball", limit.unwrap_or(FREE)),
            JointKind::Universal { limit } => {
                ("universal", SwingTwistLimit { twist: NONE, ..limit.unwrap_or(FREE) })
            }
            JointKind::Hinge { limit } => (
                "hinge",
                SwingTwistLimit { swing_y: NONE, swing_z: NONE, twist: limit.unwrap_or(FREE.twist) },
            ),
            JointKind::Fixed => ("fixed", SwingTwistLimit { swing_y: NONE, swing_z: NONE, twist: NONE }),
            kind => unreachable!("{kind:?}: joints of a ragdoll only rotate"),
        };
        let limits_from = match self.build.bodies[joint.child].limits {
            LimitSource::Anatomy => "anatomy",
            LimitSource::Clips => "clips",
        };
        json!({
            "parent": bone(joint.parent),
            "child": bone(joint.child),
            "type": kind,
            "limits_from": limits_from,
            "limits_deg": {
                "swing_y": degrees(limit.swing_y),
                "swing_z": degrees(limit.swing_z),
                "twist": degrees(limit.twist),
            },
        })
    }

    fn to_text(&self) -> String {
        let def = self.def;
        let (bodies, mass, height) = (def.bodies.len(), def.total_mass, def.height);
        let mut text = format!("{}: {bodies} bodies, {mass:.1} kg, {height:.2} m\n\n", shown(self.file));
        let mut table = Table::titled(&["bone", "role", "sure", "shape", "kg", "joint", "limits"]);
        for (index, body) in def.bodies.iter().enumerate() {
            let joint = index.checked_sub(1).map(|joint| self.joint_json(&def.joints[joint]));
            let (kind, limits) = joint.map_or((String::new(), String::new()), |joint| joint_cells(&joint));
            table.row([
                shown(&body.bone),
                body.role.clone(),
                format!("{:.2}", body.confidence),
                shape_cell(&body.shape),
                format!("{:.2}", body.mass.mass),
                kind,
                limits,
            ]);
        }
        text += &table.to_text();
        if !def.dropped_bones.is_empty() {
            let names: Vec<String> = def.dropped_bones.iter().map(|name| shown(name)).collect();
            let _ = writeln!(text, "\nwithout a body: {}", names.join(", "));
        }
        for note in &self.build.notes {
            let _ = writeln!(text, "note: {}", shown(note));
        }
        text + &self.quality_text()
    }
}

fn gate_json(gated: &GateReport) -> Value {
    let GateReport { spawns, verdicts: [good, usable, bad], worst, misses, .. } = gated;
    let misses = misses.iter().take(LISTED);
    json!({
        "spawns": spawns,
        "good": good,
        "usable": usable,
        "bad": bad,
        "worst": quality_json(worst),
        "worst_spawn": gated.worst_spawn,
        "worst_reasons": gated.worst_reasons,
        "bad_spawns": gated.bad.iter().take(LISTED).collect::<Vec<_>>(),
        "failed": failed(gated),
        "failures": misses
            .map(|miss| json!({ "spawn": miss.spawn, "what": miss.bar.key(), "value": number(miss.value) }))
            .collect::<Vec<_>>(),
    })
}

/// Largest number of listed falls.
const LISTED: usize = 100;

/// Returns the number of falls that violate a hard requirement.
fn failed(gated: &GateReport) -> usize {
    let mut spawns: Vec<u64> = gated.misses.iter().map(|miss| miss.spawn).collect();
    spawns.dedup();
    spawns.len()
}

fn gate_text(gated: &GateReport) -> String {
    let GateReport { spawns, verdicts: [good, usable, bad], worst, worst_spawn, .. } = gated;
    let mut text = format!(
        "{spawns} random falls: {good} good, {usable} usable, {bad} bad (worst is fall {worst_spawn})\n"
    );
    text += &quality_text(worst);
    let _ = writeln!(text, "  {} of them violate a hard requirement", failed(gated));
    for miss in gated.misses.iter().take(LISTED) {
        let _ = writeln!(text, "  fall {}: {} {}", miss.spawn, miss.bar.key(), miss.value);
    }
    text
}

/// A range without rotation.
const NONE: Range = Range { lo: 0.0, hi: 0.0 };
/// An unlimited rotation.
const FREE: SwingTwistLimit = {
    const ALL: Range = Range { lo: -core::f32::consts::PI, hi: core::f32::consts::PI };
    SwingTwistLimit { swing_y: ALL, swing_z: ALL, twist: ALL }
};

/// Rounds to a tenth of a degree: limits are not meant more precisely.
fn degrees(range: Range) -> [f64; 2] {
    // Adding zero turns −0 into 0.
    [range.lo, range.hi].map(|angle| (f64::from(angle).to_degrees() * 10.0).round() / 10.0 + 0.0)
}

/// Returns the type of a joint and its limits, as the report's cells.
fn joint_cells(joint: &Value) -> (String, String) {
    let range = |key: &str| {
        let range = &joint["limits_deg"][key];
        let [lo, hi] = [&range[0], &range[1]].map(|angle| angle.as_f64().unwrap_or(0.0));
        (lo != 0.0 || hi != 0.0).then(|| format!("{key} {lo:.0}..{hi:.0}°"))
    };
    let limits: Vec<String> = ["swing_y", "swing_z", "twist"].into_iter().filter_map(range).collect();
    (joint["type"].as_str().unwrap_or_default().to_owned(), limits.join(", "))
}

/// Returns the full sizes in centimetres.
fn shape_cell(shape: &Shape) -> String {
    let cm = |meters: f32| format!("{:.0}", 200.0 * meters);
    match *shape {
        Shape::Box { half_extents: h } => format!("box {} × {} × {} cm", cm(h.x), cm(h.y), cm(h.z)),
        Shape::Sphere { radius } => format!("sphere ⌀ {} cm", cm(radius)),
        Shape::Capsule { half_height, radius } => {
            format!("capsule {} × ⌀ {} cm", cm(half_height + radius), cm(radius))
        }
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            let height = half_height + 0.5 * (radius_bottom + radius_top);
            format!("tapered capsule {} × ⌀ {}–{} cm", cm(height), cm(radius_bottom), cm(radius_top))
        }
        Shape::Cylinder { half_height, radius } => {
            format!("cylinder {} × ⌀ {} cm", cm(half_height), cm(radius))
        }
        Shape::Cone { half_height, radius } => format!("cone {} × ⌀ {} cm", cm(half_height), cm(radius)),
        Shape::HalfSpace => "half-space".into(),
        Shape::Mesh(_) => "mesh".into(),
        Shape::HeightField(_) => "height field".into(),
        Shape::Hull(ref hull) => format!("hull of {} points", hull.vertices().len()),
    }
}

/// Returns the name of the axis nearest to a unit vector, such as `+Y`.
pub fn axis_name(axis: Vec3) -> &'static str {
    let [x, y, z] = axis.to_array();
    let (ax, ay, az) = (x.abs(), y.abs(), z.abs());
    let pick = |value: f32, names: [&'static str; 2]| if value < 0.0 { names[0] } else { names[1] };
    if ay >= ax && ay >= az {
        pick(y, ["-Y", "+Y"])
    } else if az >= ax {
        pick(z, ["-Z", "+Z"])
    } else {
        pick(x, ["-X", "+X"])
    }
}
