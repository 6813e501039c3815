//! Contacts at internal edges, where another fixed shape continues the surface. Part of the stage `collide`.

use crate::arena::Arena;
use crate::body::Body;
use crate::body::contact_rule::ContactRule;
use crate::body::def::BodyKind;
use crate::body::shape::{Sensing, Shape};
use crate::boxes::Aabb;
use crate::collide::{
    Faces, Half, MAX_POINTS, Manifold, ManifoldPoint, collide, name_as_face, name_as_hidden,
};
use crate::contact::ContactKey;
use crate::contact::filter::PairFilter;
use crate::contact::proxies::{Owner, Proxies};
use crate::contact::tuning::{SEAM_REACH, SEAM_SLOPS};
use core::ops::ControlFlow;
use sinew_math::{Rotation, Transform, Vec3, max3, min3};

/// Bodies, their bounds and the pair filter: the surroundings of contacts.
#[derive(Clone, Copy)]
pub(crate) struct Seams<'a> {
    pub bodies: &'a Arena<Body>,
    pub proxies: &'a Proxies,
    pub filter: PairFilter<'a>,
}

/// Limits of a manifold's search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Search {
    /// Search distance (`margin`) and slop of the shapes, metres.
    pub margin: f32,
    pub slop: f32,
    /// Length of the step, seconds.
    pub dt: f32,
}

/// Sides of a contact between the ground and a dynamic body.
struct Sides {
    ground: Owner,
    mover: Owner,
    of_ground: Half,
    /// Contact normal from the ground to the body, unit length, world axes.
    out: Vec3,
}

impl Seams<'_> {
    /// Rotates the normal of a contact at an edge or side of a ground shape to that of the surrounding surface: a face
    /// of the shape. If the face belongs to another shape, disables the contact.
    pub fn mend(&self, key: ContactKey, search: Search, manifold: &mut Manifold) {
        let Some(sides) = self.sides(key, manifold) else { return };
        let reach = SEAM_SLOPS * search.slop;
        let is_as_found = |&(normal, _): &(Vec3, f32)| normal.dot(sides.out) > AS_FOUND;
        let mut faces: [Option<Faces>; MAX_POINTS] = [None; MAX_POINTS];
        let mut bounds = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };
        for (around, point) in faces.iter_mut().zip(manifold.points()) {
            let on_ground = point.position - sides.out * (0.5 * point.separation);
            let Some(found) = self.faces(sides.ground, on_ground, reach) else { continue };
            // A contact away from the edges is unchanged.
            if found.count() < 2 && found.shown(sides.out).is_none_or(|shown| is_as_found(&shown)) {
                return;
            }
            bounds = Aabb { min: min3(bounds.min, on_ground), max: max3(bounds.max, on_ground) };
            *around = Some(found);
        }
        self.hide(&sides, manifold, (bounds.expand(reach), reach), &mut faces);
        if !faces.iter().flatten().any(Faces::has_hidden) {
            return;
        }
        let shown = faces.map(|around| around.and_then(|faces| faces.shown(sides.out)));
        if shown[..manifold.count].iter().flatten().any(is_as_found) {
            return;
        }
        // Uses a point that is over the shape: one end of a long shape that crosses an edge diagonally may be outside.
        let known = manifold.points().iter().enumerate().filter(|(i, _)| faces[*i].is_some());
        let known = known.map(|(i, point)| (i, *point));
        let deeper = |p: (usize, ManifoldPoint), q: (usize, ManifoldPoint)| {
            if q.1.separation < p.1.separation { q } else { p }
        };
        let Some((deepest, ManifoldPoint { position, separation, .. })) = known.reduce(deeper) else {
            return;
        };
        let on_ground = position - sides.out * (0.5 * separation);
        let plane = shown[deepest].map(|(normal, height)| (normal, on_ground - normal * height));
        let found = plane.map(|plane| self.put_on(&sides, plane, (search, reach)));
        match found.filter(|found| found.count > 0) {
            Some(found) => *manifold = found,
            None => name_as_hidden(manifold, sides.of_ground),
        }
    }

    /// Lists neighbouring ground shapes within `bounds` that may continue a surface at its edges.
    pub fn beside(&self, ground: Owner, mover: Owner, bounds: &Aabb, list: &mut Vec<Owner>) {
        list.clear();
        if self.bodies.at(ground.body).kind == BodyKind::Dynamic || !self.pushes(ground) {
            return;
        }
        let _ = self.proxies.overlapping(bounds, |other| {
            if self.goes_on(ground, other) && self.stops(mover, other) {
                list.push(other);
            }
            ControlFlow::<()>::Continue(())
        });
    }

    /// Normal of the combined surface at a point, and the height of the point over its plane, metres. The normal is
    /// `normal` if no shape hides the surface; `None` if other shapes hide all of it.
    pub fn shown(
        &self,
        ground: Owner,
        beside: &[Owner],
        (point, normal): (Vec3, Vec3),
        slop: f32,
    ) -> Option<(Vec3, f32)> {
        let reach = SEAM_SLOPS * slop;
        let Some(mut faces) = self.faces(ground, point, reach) else { return Some((normal, 0.0)) };
        for &other in beside {
            if let Some(its) = self.faces(other, point, reach) {
                faces.hide_behind(&its);
            }
        }
        if faces.has_hidden() { faces.shown(normal) } else { Some((normal, 0.0)) }
    }

    /// Sides of the contact; `None` unless one is dynamic, the other is not and has flat faces, and both push.
    fn sides(&self, key: ContactKey, manifold: &Manifold) -> Option<Sides> {
        if manifold.count == 0 {
            return None;
        }
        let a = Owner { body: key.a, shape: key.shape_a };
        let b = Owner { body: key.b, shape: key.shape_b };
        let is_ground = |owner: Owner| self.bodies.at(owner.body).kind != BodyKind::Dynamic;
        let sides = match (is_ground(a), is_ground(b)) {
            (true, false) => Sides { ground: a, mover: b, of_ground: Half::OfA, out: manifold.normal },
            (false, true) => Sides { ground: b, mover: a, of_ground: Half::OfB, out: -manifold.normal },
            _ => return None,
        };
        let is_edged = matches!(self.shape(sides.ground), Shape::Box { .. } | Shape::Hull(_));
        (is_edged && self.pushes(a) && self.pushes(b)).then_some(sides)
    }

    fn shape(&self, owner: Owner) -> &Shape {
        &self.bodies.at(owner.body).shapes[owner.shape as usize].shape
    }

    fn faces(&self, owner: Owner, point: Vec3, reach: f32) -> Option<Faces> {
        let frame = self.bodies.at(owner.body).world_from_shape(owner.shape as usize);
        Faces::around(self.shape(owner), &frame, point, reach)
    }

    /// Hides the parts of the faces around each point that are behind other ground shapes.
    fn hide(
        &self,
        sides: &Sides,
        manifold: &Manifold,
        (bounds, reach): (Aabb, f32),
        faces: &mut [Option<Faces>; MAX_POINTS],
    ) {
        let Sides { ground, mover, out, .. } = *sides;
        let _ = self.proxies.overlapping(&bounds, |other| {
            if self.goes_on(ground, other) && self.stops(mover, other) {
                for (around, point) in faces.iter_mut().zip(manifold.points()) {
                    let on_ground = point.position - out * (0.5 * point.separation);
                    if let (Some(around), Some(its)) = (around, self.faces(other, on_ground, reach)) {
                        around.hide_behind(&its);
                    }
                }
            }
            ControlFlow::<()>::Continue(())
        });
    }

    /// True if another shape never moves relative to a ground shape.
    fn goes_on(&self, ground: Owner, other: Owner) -> bool {
        let is_static = |owner: Owner| self.bodies.at(owner.body).kind == BodyKind::Static;
        other != ground && (other.body == ground.body || is_static(ground) && is_static(other))
    }

    /// True if another shape always pushes the mover.
    fn stops(&self, mover: Owner, other: Owner) -> bool {
        let key = ContactKey::new((mover.body, mover.shape), (other.body, other.shape));
        self.pushes(other) && self.filter.lets_meet(self.bodies, key)
    }

    fn pushes(&self, owner: Owner) -> bool {
        let surface = self.bodies.at(owner.body).surface(owner.shape as usize);
        surface.sensing == Sensing::Solid && surface.rule == ContactRule::Push
    }

    /// Contact of the mover with a ground plane, with the points that are over the ground shape now or within the step.
    fn put_on(
        &self,
        sides: &Sides,
        (normal, origin): (Vec3, Vec3),
        (search, reach): (Search, f32),
    ) -> Manifold {
        static PLANE: Shape = Shape::HalfSpace;
        let Sides { ground, mover, of_ground, .. } = *sides;
        let plane = Transform::new(origin, Rotation::from_arc(Vec3::Y, normal));
        let body = self.bodies.at(mover.body);
        let frame = body.world_from_shape(mover.shape as usize);
        let mut manifold = Manifold::default();
        let (ground_side, mover_side) = ((&PLANE, &plane), (self.shape(mover), &frame));
        let (a, b) = match of_ground {
            Half::OfA => (ground_side, mover_side),
            Half::OfB => (mover_side, ground_side),
        };
        collide(a.0, a.1, b.0, b.1, search.margin, &mut manifold);
        let way = (body.velocity.linear - self.bodies.at(ground.body).velocity.linear) * search.dt;
        let way = way - normal * way.dot(normal);
        let found = core::mem::take(&mut manifold.count);
        for i in 0..found {
            let point = manifold.points[i];
            let foot = point.position - normal * (0.5 * point.separation);
            let comes = point.separation > -SEAM_REACH * search.slop;
            let is_over = self.faces(ground, foot, reach).is_some()
                || comes && self.faces(ground, foot + way, reach).is_some();
            if is_over {
                manifold.points[manifold.count] = point;
                manifold.count += 1;
            }
        }
        name_as_face(&mut manifold, of_ground);
        manifold
    }
}

/// Cosine above which a normal counts as unchanged.
const AS_FOUND: f32 = 0.999_999_9;
