//! Rays through the world: closest, any, all, one or many. The trees say which shapes are in question,
//! [`Shape::cast_ray`](crate::Shape::cast_ray) what is hit, so that the answers have the bits that trying every shape would
//! give. Of equal fractions the smaller body index counts, then the smaller shape number.

use crate::id::BodyId;
use crate::proxies::Owner;
use crate::query::BodyHit;
use crate::ray::{Ray, RayHit};
use crate::tree::Sweep;
use crate::world::World;
use sinew_math::Vec3;

/// A ray that met a shape of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShapeHit {
    pub owner: Owner,
    pub hit: RayHit,
}

impl ShapeHit {
    fn is_before(&self, other: &Self) -> bool {
        (self.hit.fraction, self.owner) < (other.hit.fraction, other.owner)
    }
}

impl World {
    /// The first shape on the ray whose body passes `accept`; the smaller body wins a tie.
    pub fn cast_ray(&self, ray: &Ray, mut accept: impl FnMut(BodyId) -> bool) -> Option<BodyHit> {
        self.closest_on(ray, |owner| accept(self.id_at(owner.body))).map(|hit| self.body_hit(&hit))
    }

    /// [`cast_ray`](Self::cast_ray) for many rays: `out` becomes the list of their hits, in the same order.
    pub fn cast_rays(
        &self,
        rays: &[Ray],
        mut accept: impl FnMut(BodyId) -> bool,
        out: &mut Vec<Option<BodyHit>>,
    ) {
        out.clear();
        out.extend(rays.iter().map(|ray| self.cast_ray(ray, &mut accept)));
    }

    /// The first shape on a ray of those that pass `accept`, which is asked of shapes that are hit.
    pub(crate) fn closest_on(&self, ray: &Ray, mut accept: impl FnMut(Owner) -> bool) -> Option<ShapeHit> {
        let mut first: Option<ShapeHit> = None;
        let mut limit = 1.0;
        self.broad.proxies.along(&sweep(ray)?, |owner| {
            if let Some(hit) = self.meet(ray, owner)
                && first.is_none_or(|first| hit.is_before(&first))
                && accept(owner)
            {
                limit = hit.hit.fraction;
                first = Some(hit);
            }
            limit
        });
        first
    }

    /// Whether a ray meets any shape that passes `accept`.
    pub(crate) fn meets_any(&self, ray: &Ray, mut accept: impl FnMut(Owner) -> bool) -> bool {
        let Some(sweep) = sweep(ray) else { return false };
        let mut met = false;
        self.broad.proxies.along(&sweep, |owner| {
            met = met || (accept(owner) && self.meet(ray, owner).is_some());
            if met { -1.0 } else { 1.0 }
        });
        met
    }

    #[allow(dead_code, reason = "for queries of all hits")]
    /// Appends all shapes on a ray that pass `accept`, in the order in which it meets them.
    pub(crate) fn all_on(&self, ray: &Ray, mut accept: impl FnMut(Owner) -> bool, out: &mut Vec<ShapeHit>) {
        let Some(sweep) = sweep(ray) else { return };
        let start = out.len();
        self.broad.proxies.along(&sweep, |owner| {
            out.extend(self.meet(ray, owner).filter(|_| accept(owner)));
            1.0
        });
        out[start..]
            .sort_unstable_by(|a, b| a.hit.fraction.total_cmp(&b.hit.fraction).then(a.owner.cmp(&b.owner)));
    }

    fn meet(&self, ray: &Ray, owner: Owner) -> Option<ShapeHit> {
        let body = self.bodies.at(owner.body);
        let shape = owner.shape as usize;
        let hit = body.shapes[shape].shape.cast_ray(&body.world_from_shape(shape), ray)?;
        Some(ShapeHit { owner, hit })
    }

    pub(crate) fn id_at(&self, index: u32) -> BodyId {
        BodyId { index, generation: self.bodies.generation(index) }
    }

    fn body_hit(&self, hit: &ShapeHit) -> BodyHit {
        BodyHit { body: self.id_at(hit.owner.body), hit: hit.hit }
    }
}

/// `None` if a number is not finite: such a ray hits nothing.
fn sweep(ray: &Ray) -> Option<Sweep> {
    let Ray { origin, direction } = *ray;
    let is_finite = origin.is_finite() && direction.is_finite();
    is_finite.then_some(Sweep { origin, direction, half_extents: Vec3::ZERO, limit: 1.0 })
}
