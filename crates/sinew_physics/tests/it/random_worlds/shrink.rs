//! Shrinks a failing plan as long as it fails in the same way, and prints it.

use super::plan::{Change, WorldPlan};
use super::run::{Failure, Fault, check};
use sinew_math::Vec3;
use sinew_physics::*;

/// Largest number of runs.
const ATTEMPTS: usize = 1000;

/// Returns the smallest plan found that fails like the given one, and its failure.
pub fn shrunk(plan: &WorldPlan, failure: &Failure, steps: u32) -> (WorldPlan, Failure) {
    let mut least = (plan.clone(), failure.clone());
    let (mut steps, mut left) = (steps, ATTEMPTS);
    loop {
        let smaller = candidates(&least.0).take(left).find_map(|plan| {
            left -= 1;
            let found = check(&plan, steps).err()?;
            found.fault.same_kind(&failure.fault).then_some((plan, found))
        });
        let Some(smaller) = smaller else { return least };
        // The step of a panic is not known.
        if !matches!(smaller.1.fault, Fault::Panic(_)) {
            steps = u32::min(steps, smaller.1.step + 1);
        }
        least = smaller;
    }
}

/// Iterates over all plans that result from one simplification of the plan.
fn candidates(plan: &WorldPlan) -> impl Iterator<Item = WorldPlan> {
    let bodies = (0..plan.bodies.len()).map(|i| plan.without_body(i));
    let joints = (0..plan.joints.len()).map(|j| plan.without_joint(j));
    let changes = (0..plan.changes.len()).map(|k| {
        let mut less = plan.clone();
        less.changes.remove(k);
        less
    });
    let features = (0..plan.joints.len()).flat_map(|j| JOINT_CUTS.iter().map(move |cut| (j, cut)));
    let features = features.filter_map(|(j, cut)| {
        let mut less = plan.clone();
        cut(&mut less, j).then_some(less)
    });
    let parts = (0..plan.bodies.len()).flat_map(|i| BODY_CUTS.iter().map(move |cut| (i, cut)));
    let parts = parts.filter_map(|(i, cut)| {
        let mut less = plan.clone();
        cut(&mut less, i).then_some(less)
    });
    let whole = WORLD_CUTS.iter().filter_map(|cut| {
        let mut less = plan.clone();
        cut(&mut less).then_some(less)
    });
    bodies.chain(joints).chain(changes).chain(whole).chain(features).chain(parts)
}

/// Function that removes a feature from a joint or a body. Returns false if there is nothing to remove.
type PartCut = fn(&mut WorldPlan, usize) -> bool;

const JOINT_CUTS: &[PartCut] = &[
    |plan, j| plan.joints[j].motor.take().is_some(),
    |plan, j| plan.joints[j].spring.take().is_some(),
    |plan, j| plan.joints[j].soft_zone.take().is_some(),
    |plan, j| plan.joints[j].limit_softness.take().is_some(),
    |plan, j| plan.joints[j].weld.take().is_some(),
    |plan, j| core::mem::take(&mut plan.joints[j].friction) > 0.0,
    |plan, j| {
        core::mem::replace(&mut plan.joints[j].strength, Strength::UNBREAKABLE) != Strength::UNBREAKABLE
    },
    |plan, j| {
        let open = without_limits(plan.joints[j].kind);
        core::mem::replace(&mut plan.joints[j].kind, open) != open
    },
    |plan, j| {
        let ball = JointKind::Ball { limit: None };
        core::mem::replace(&mut plan.joints[j].kind, ball) != ball
    },
];

const BODY_CUTS: &[PartCut] = &[
    |plan, i| core::mem::take(&mut plan.bodies[i].velocity) != Velocity::default(),
    |plan, i| core::mem::take(&mut plan.bodies[i].collides),
    |plan, i| core::mem::take(&mut plan.bodies[i].material) != Material::default(),
    |plan, i| core::mem::replace(&mut plan.bodies[i].mass, 1.0) != 1.0,
    |plan, i| {
        let ball = Shape::Sphere { radius: plan.bodies[i].shape.bounding_radius() };
        core::mem::replace(&mut plan.bodies[i].shape, ball.clone()) != ball
    },
];

const WORLD_CUTS: &[fn(&mut WorldPlan) -> bool] = &[
    |plan| core::mem::take(&mut plan.floor),
    |plan| core::mem::replace(&mut plan.gravity, Vec3::ZERO) != Vec3::ZERO,
    |plan| core::mem::replace(&mut plan.sleeping, Sleeping::Off) == Sleeping::On,
];

fn without_limits(kind: JointKind) -> JointKind {
    let open = |motion: AxisMotion| match motion {
        AxisMotion::Limited(_) => AxisMotion::Free,
        motion => motion,
    };
    match kind {
        JointKind::Ball { .. } => JointKind::Ball { limit: None },
        JointKind::Hinge { .. } => JointKind::Hinge { limit: None },
        JointKind::Universal { .. } => JointKind::Universal { limit: None },
        JointKind::Slider { .. } => JointKind::Slider { limit: None },
        JointKind::SixDof(six) => JointKind::SixDof(SixDof {
            linear: six.linear.map(open),
            twist: open(six.twist),
            swing_y: open(six.swing_y),
            swing_z: open(six.swing_z),
        }),
        kind => kind,
    }
}

/// Returns the plan as Rust code, without paths of enum variants.
pub fn as_code(plan: &WorldPlan) -> String {
    let mut code = format!("{plan:?}").replace("Vec3(", "Vec3::new(").replace("inf", "f32::INFINITY");
    for list in ["bodies: [", "joints: [", "changes: ["] {
        code = code.replace(list, &list.replace('[', "vec!["));
    }
    for item in ["BodyPlan {", "JointPlan {", "joints: ", "changes: "] {
        code = code.replace(item, &format!("\n  {item}"));
    }
    code
}

/// Returns the features of a plan in one line.
pub fn features(plan: &WorldPlan) -> String {
    let mut found = Vec::new();
    let mut note = |there: bool, name: &str| {
        if there {
            found.push(name.to_owned());
        }
    };
    let joints = || {
        let redefined = plan.changes.iter().filter_map(|(_, change)| match change {
            Change::Redefine(_, joint, _) => Some(&**joint),
            _ => None,
        });
        plan.joints.iter().chain(redefined)
    };
    note(plan.floor, "floor");
    note(plan.gravity != Vec3::ZERO, "gravity");
    note(joints().any(|joint| joint.weld.is_some()), "weld");
    note(joints().any(|joint| joint.limit_softness.is_some()), "soft limit");
    note(joints().any(|joint| joint.soft_zone.is_some()), "soft zone");
    note(joints().any(|joint| joint.spring.is_some()), "spring");
    note(joints().any(|joint| joint.motor.is_some()), "motor");
    note(joints().any(|joint| joint.friction > 0.0), "friction");
    note(joints().any(|joint| joint.strength != Strength::UNBREAKABLE), "strength");
    note(joints().any(|joint| without_limits(joint.kind) != joint.kind), "limit");
    note(plan.bodies.iter().filter(|body| body.collides).count() > usize::from(!plan.floor), "contacts");
    for (_, change) in &plan.changes {
        let text = format!("{change:?}");
        note(true, text.split('(').next().unwrap_or_default());
    }
    for joint in joints() {
        let text = format!("{:?}", joint.kind);
        note(true, text.split(' ').next().unwrap_or_default());
    }
    format!("{} bodies, {} joints: {}", plan.bodies.len(), plan.joints.len(), found.join(", "))
}
