//! The stage `continuous` stops fast bodies that would pass through static ones.

use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::body::contact_rule::ContactRule;
use crate::body::def::BodyKind;
use crate::body::shape::Sensing;
use crate::body::surface::Surface;
use crate::contact::ContactKey;
use crate::contact::filter::PairFilter;
use crate::contact::proxies::{Owner, Proxies};
use crate::context::StepContext;
use crate::ray::Ray;
use crate::step::islands::Islands;
use crate::step::pairs::BroadPhase;
use crate::tree::Sweep;
use sinew_math::{Transform, Vec3, normalize_or};

/// `continuous`: a joint-free body whose centre passed through a static shape within the step is moved back to where
/// its core touches the shape. Speculative contacts stop nearly all bodies before. Jointed bodies rely on speculative
/// contacts only: moving one link would violate its joints. After this stage all poses are final, and the trees are
/// updated.
pub(crate) fn continuous(
    islands: &Islands,
    bodies: &mut Arena<Body>,
    activity: &Activity,
    broad: &mut BroadPhase,
    filter: PairFilter<'_>,
    context: &StepContext<'_>,
) {
    for island in islands.iter().filter(|island| island.joints.is_empty()) {
        for &index in island.bodies {
            let body = bodies.at(index);
            let core = core_radius(body);
            let motion = body.center() - body.previous.translation;
            if core == 0.0 || motion.length() <= core {
                continue;
            }
            let ray = Ray { origin: body.previous.translation, direction: motion };
            if let Some(fraction) = first_static_hit(bodies, &broad.proxies, filter, index, &ray) {
                let back = sinew_math::max(fraction - core / motion.length(), 0.0);
                let center = ray.at(back);
                bodies.at_mut(index).world_from_principal.translation = center;
            }
        }
    }
    // Kinematic bodies moved as predicted at the step's start.
    broad.proxies.follow(bodies, activity.active(), context.dt);
}

/// Radius of the largest ball about the centre of mass that is guaranteed to be inside a single-shape body, metres; 0
/// if there is none.
fn core_radius(body: &Body) -> f32 {
    match body.shapes.as_slice() {
        [only] if only.principal_from_shape.translation.length() < 1e-4 => only.shape.inner_radius(),
        _ => 0.0,
    }
}

fn first_static_hit(
    bodies: &Arena<Body>,
    proxies: &Proxies,
    filter: PairFilter<'_>,
    mover: u32,
    ray: &Ray,
) -> Option<f32> {
    let mut first: Option<f32> = None;
    let own = bodies.at(mover).shapes.len() as u32;
    let sweep = Sweep { origin: ray.origin, direction: ray.direction, half_extents: Vec3::ZERO, limit: 1.0 };
    proxies.along(&sweep, |Owner { body: index, shape }| {
        let body = bodies.at(index);
        let frame = body.world_from_shape(shape as usize);
        let meets = |i| filter.lets_meet(bodies, ContactKey::new((mover, i), (index, shape)));
        if body.kind == BodyKind::Static
            && stops(body.surface(shape as usize), &frame, ray)
            && (0..own).any(meets)
            && let Some(hit) = body.shapes[shape as usize].shape.cast_ray(&frame, ray)
            // A fraction of 0 is an overlap at the start, which the contacts resolve.
            && hit.fraction > 0.0
            && first.is_none_or(|first| hit.fraction < first)
        {
            first = Some(hit.fraction);
        }
        first.unwrap_or(1.0)
    });
    first
}

/// True if a shape certainly stops a body along a ray. False for a shape with a modifier: it has speculative contacts
/// only.
fn stops(s: &Surface, frame: &Transform, ray: &Ray) -> bool {
    let solid = s.sensing == Sensing::Solid;
    solid
        && match s.rule {
            ContactRule::Push | ContactRule::Yields(_) => true,
            ContactRule::Ghost | ContactRule::Modified { .. } => false,
            ContactRule::OneWay(one_way) => {
                one_way.holds(normalize_or(frame.rotation.inverse() * -ray.direction, Vec3::Y))
            }
        }
}
