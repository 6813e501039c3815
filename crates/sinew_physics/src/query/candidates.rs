//! Which shapes may have an answer. The one place where a question meets the world's bodies.

use crate::body::Body;
use crate::boxes::Aabb;
use crate::ray::Ray;
use crate::world::World;
use core::ops::ControlFlow;

/// Where the shapes are that may answer.
#[derive(Clone, Copy, Debug)]
pub enum Reach {
    /// Their bounds meet a box.
    Box(Aabb),
    /// Their bounds meet a box that is moved along a ray, from where it is to where the ray's end has carried it.
    Swept(Aabb, Ray),
}

/// How far along its way a question still looks.
pub(super) type Limit = ControlFlow<(), f32>;

/// Shows every shape within reach, and maybe others, to `visit`, in any order, until it breaks. Of a swept reach what it
/// gives back is how far along the ray it still wants to look, as a fraction.
pub(super) fn candidates(world: &World, _reach: &Reach, mut visit: impl FnMut(u32, &Body, u32) -> Limit) {
    for (index, body) in world.bodies.iter() {
        for shape in 0..body.shapes.len() as u32 {
            if visit(index, body, shape).is_break() {
                return;
            }
        }
    }
}
