//! Report of the build.

use super::bones::Bones;
use super::joint_name;
use crate::filter::{FilterReport, Overlap, Remedy, Seen};
use crate::fit::Fit;
use crate::fit::patch::Selection;
use crate::limits::{JointPlan, LimitSource};
use crate::tuning::NOTED_WIDENING;
use sinew_anim::Rig;

/// Report on a ragdoll.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildReport {
    /// Report on each body, in the definition's order.
    pub bodies: Vec<BodyReport>,
    /// Bodies that overlap without a joint, and the remedy for each, sorted by pair.
    pub overlaps: Vec<Overlap>,
    /// Area-weighted mean distance between skin and shapes of all bodies, metres.
    pub mean_error: f32,
    /// Sum of the shapes' volumes, m³. It exceeds the volume of the flesh, because shapes overlap.
    pub shape_volume: f32,
    /// Notes for a person, one sentence each.
    pub notes: Vec<String>,
}

/// Report on one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyReport {
    /// Area-weighted mean distance between the bone's skin and the shape's surface, metres.
    pub error: f32,
    /// Selection of the skin to which the shape was fitted.
    pub selection: Selection,
    /// Factor on the cross-section to avoid other bodies; 1 if not needed.
    pub scale: f32,
    /// Angle by which the bind pose exceeded the table's limits of the joint to the parent, radians. The limits were
    /// widened by it.
    pub widened: f32,
    /// Source of the limits of the joint to the parent.
    pub limits: LimitSource,
}

impl BuildReport {
    pub(super) fn new(
        rig: &Rig,
        bones: &Bones,
        fits: &[Fit],
        filter: &FilterReport,
        (plans, limits): (&[JointPlan], &[LimitSource]),
    ) -> Self {
        let body = |body: usize| BodyReport {
            error: fits[body].error,
            selection: fits[body].selection,
            scale: filter.scale[body],
            widened: body.checked_sub(1).map_or(0.0, |joint| plans[joint].widened),
            limits: body.checked_sub(1).map_or(LimitSource::Anatomy, |joint| limits[joint]),
        };
        let bodies: Vec<_> = (0..fits.len()).map(body).collect();
        let area: f32 = fits.iter().map(|fit| fit.area).sum();
        let mean_error =
            fits.iter().map(|fit| fit.error * fit.area).sum::<f32>() / sinew_math::max(area, 1e-9);
        Self {
            notes: notes(rig, bones, &bodies, filter),
            bodies,
            overlaps: filter.overlaps.clone(),
            mean_error,
            shape_volume: fits.iter().map(|fit| fit.shape.volume()).sum(),
        }
    }
}

fn notes(rig: &Rig, bones: &Bones, bodies: &[BodyReport], filter: &FilterReport) -> Vec<String> {
    let name = |body: usize| {
        format!("{} ({})", bones.list[body].role.name(), joint_name(rig, bones.list[body].joint))
    };
    let mut notes = Vec::new();
    for (index, body) in bodies.iter().enumerate() {
        if body.selection == Selection::Nothing {
            notes.push(format!("{} moves no skin: a thin capsule along the bone stands in", name(index)));
        }
        if body.selection == Selection::Twin {
            notes.push(format!("{} fits worse than its twin: it has the twin's shape", name(index)));
        }
        if body.widened > NOTED_WIDENING {
            let degrees = body.widened.to_degrees();
            notes
                .push(format!("{} is bound {degrees:.0}° beyond its limits: they were widened", name(index)));
        }
    }
    if bodies.iter().any(|body| body.limits == LimitSource::Clips) {
        for index in (1..bodies.len()).filter(|&index| bodies[index].limits == LimitSource::Anatomy) {
            notes.push(format!("the clips show too little of {}: its limits are the table's", name(index)));
        }
    }
    for overlap in &filter.overlaps {
        let done = match overlap.remedy {
            Remedy::Tolerated => continue,
            Remedy::OnlyBound => "they collide, but for a ragdoll that starts there",
            Remedy::Shrunk => "they were made thinner",
            Remedy::Disabled => "they do not collide",
        };
        let (a, b) = overlap.pair;
        notes.push(format!("{} and {} overlap {}: {done}", name(a), name(b), places(&overlap.seen)));
    }
    notes
}

/// Describes the poses in which two bodies overlap.
fn places(seen: &Seen) -> String {
    let mut places = Vec::new();
    if seen.bind > 0.0 {
        places.push(format!("by {:.0} mm in the bind pose", 1000.0 * seen.bind));
    }
    places.push(format!("in {:.0} % of the poses that their joints allow", 100.0 * seen.limits));
    if let Some(clips) = seen.clips {
        places.push(format!("in {:.0} % of the clips' poses", 100.0 * clips));
    }
    places.join(", ")
}
