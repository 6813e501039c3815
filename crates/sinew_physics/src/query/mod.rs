//! Questions to a world: what a ray meets, what a shape would touch, what is near.
//!
//! A [`QueryKind`] is plain data. [`World::query`] takes it to the shapes of a world, all of them or those that pass a
//! [`QueryFilter`] and a predicate:
//!
//! ```
//! use sinew_math::Vec3;
//! use sinew_physics::ray::Ray;
//! use sinew_physics::{BodyDef, BodyKinds, ContainsPoint, QueryFilter, Shape, World, WorldDef};
//!
//! let mut world = World::new(WorldDef::default());
//! world.add_body(&BodyDef::fixed(Shape::HalfSpace));
//! let ball = world.add_body(&BodyDef::dynamic(Shape::Sphere { radius: 0.5 }).at(Vec3::Y * 2.0));
//!
//! let down = Ray { origin: Vec3::Y * 5.0, direction: Vec3::Y * -10.0 };
//! let hit = world.query().first(&down).expect("the ball is in the way");
//! assert!(hit.body == ball && hit.shape == 0 && (hit.point.y - 2.5).abs() < 1e-6);
//!
//! let level = world.query().filter(QueryFilter::of(BodyKinds::STATIC));
//! assert_eq!(level.first(&down).map(|hit| hit.point.y), Some(0.0));
//! assert!(!world.query().accept(|body, _| body != ball).any(&ContainsPoint(Vec3::Y * 2.0)));
//! ```
//!
//! # What can be asked
//!
//! | question | asks for | answers, in this order |
//! |---|---|---|
//! | [`Ray`](crate::ray::Ray) | what is on a stretch of a line | [`BodyHit`], by fraction |
//! | [`ShapeCast`] | what a shape meets that is moved | [`BodyHit`], by fraction |
//! | [`OverlapWith`] | what a shape has a point in common with | [`ShapeId`], by body and shape |
//! | [`PenetrationOf`] | how deep a shape is in those, and the way out of each | [`BodyPenetration`], the deepest first |
//! | [`ContainsPoint`] | what holds a point | [`ShapeId`], by body and shape |
//! | [`NearestTo`] | surfaces within a distance of a point | [`BodySurface`], the nearest first |
//! | [`NearestToShape`] | surfaces within a distance of a shape | [`BodySurface`], the nearest first |
//!
//! Each of them for its [`first`](Query::first) answer, for [`all`](Query::all), whether there is [`any`](Query::any), and which
//! [`bodies`](Query::bodies) answer; and likewise slices of them, into room of the caller's: [`first_each`](Query::first_each),
//! [`all_each`](Query::all_each), [`any_each`](Query::any_each). A shape answers once. Equal answers go by the index of the body,
//! then by the number of the shape, so that the order is always the same.
//!
//! # Starts inside
//!
//! Shapes are closed sets: their surfaces belong to them, and what touches is inside. So it is for every shape and every question:
//!
//! | | apart at the start | touching | inside |
//! |---|---|---|---|
//! | [`Ray`](crate::ray::Ray), [`ShapeCast`] | hit where they meet, if they do | hit at fraction 0, wherever the way leads | likewise |
//! | their [`normal`](BodyHit::normal) | out of the shape | opposite to the way; if it has no length, the way out | likewise |
//! | their [`start`](BodyHit::start) | `None` | depth 0 | how deep, and the shortest way out |
//! | [`OverlapWith`], [`ContainsPoint`] | no answer | an answer | an answer |
//! | [`PenetrationOf`] | no answer | depth 0 | how deep, and the shortest way out |
//! | [`NearestTo`], [`NearestToShape`] | distance above 0 | 0 | below 0 |
//!
//! A ray that leaves a shape does not hit it again; one without length hits what holds its start.
//!
//! Meshes and height fields are surfaces: nothing is inside of them but what touches one of their triangles. They are hit from
//! the outside of their triangles alone, and no way out leads through a triangle's back; distances from them are never below 0
//! but for shapes that go through a triangle.
//!
//! # What is not answered
//!
//! A number that is not finite, a size or distance below 0: no shape answers such a question. Nor is anything found that is
//! farther than 10¹⁸ m from the world's origin. No answer holds NaN or infinity.

mod body;
mod candidates;
mod cast;
mod filter;
mod kind;
mod metrics;
mod pair;
mod place;
mod probe;
mod rays;
mod triangles;

pub use cast::{BodyHit, ShapeCast};
pub use filter::{BodyKinds, QueryFilter, Sensors};
pub use kind::QueryKind;
pub use metrics::{Energy, Momentum};
pub use place::{
    BodyPenetration, BodySurface, ContainsPoint, NearestTo, NearestToShape, OverlapWith, PenetrationOf,
};
pub use probe::Probe;

use crate::body::def::BodyKind;
use crate::body::shape::{Filter, Sensing, Shape};
use crate::contact::proxies::{Owner, Placed};
use crate::id::{BodyId, ShapeId};
use crate::world::World;
use candidates::{Limit, candidates};
use core::ops::ControlFlow;
use kind::sealed::{Ask, Reply};
use sinew_math::Transform;

/// Asks a world, about those of its shapes that pass a filter and a predicate.
#[derive(Clone, Copy)]
#[must_use]
pub struct Query<'a, P> {
    world: &'a World,
    filter: QueryFilter<'a>,
    accept: P,
}

impl World {
    /// Asks about every shape that is no sensor, until a [`filter`](Query::filter) says something else. The bodies are where
    /// they are now, whether a step or [`set_transform`](World::set_transform) brought them there, asleep or awake.
    #[doc(alias = "raycast")]
    #[doc(alias = "cast_ray")]
    #[doc(alias = "QueryPipeline")]
    #[doc(alias = "sweep")]
    pub fn query(&self) -> Query<'_, impl Fn(BodyId, u32) -> bool + Copy> {
        Query { world: self, filter: QueryFilter::default(), accept: |_, _| true }
    }
}

impl<'a, P: Fn(BodyId, u32) -> bool> Query<'a, P> {
    /// Asks about the shapes that pass a filter, instead of the one that was given before.
    pub fn filter(self, filter: QueryFilter<'a>) -> Self {
        Self { filter, ..self }
    }

    /// Asks about those shapes alone that a predicate accepts besides the filter, instead of the predicate that was given
    /// before. It is asked with the body and the number of the shape, in any order, maybe again, and maybe for
    /// shapes that do not answer.
    pub fn accept<F: Fn(BodyId, u32) -> bool>(self, accept: F) -> Query<'a, F> {
        Query { world: self.world, filter: self.filter, accept }
    }

    /// The first answer in the question's order: of a ray the nearest hit. Of equal ones that of the body with the lower
    /// index, then of its shape with the lower number.
    pub fn first<Q: QueryKind>(&self, question: &Q) -> Option<Q::Answer> {
        self.best(question)
    }

    /// True if there is an answer; cheaper than the first one.
    pub fn any<Q: QueryKind>(&self, question: &Q) -> bool {
        let mut any = false;
        self.shapes(question, |id, shape, frame| {
            any = question.is_met(id, shape, frame);
            if any { ControlFlow::Break(()) } else { ControlFlow::Continue(f32::INFINITY) }
        });
        any
    }

    /// All answers, one for each shape that has one, in the question's order, equal ones by body and shape. `answers` is
    /// emptied first, and allocates only to grow.
    pub fn all<Q: QueryKind>(&self, question: &Q, answers: &mut Vec<Q::Answer>) {
        answers.clear();
        self.answers(question, |answer| {
            answers.push(answer);
            ControlFlow::Continue(f32::INFINITY)
        });
        // DETERMINISM: no two keys are equal, so that the order in which shapes were found does not matter.
        answers.sort_unstable_by(|a, b| key(a).partial_cmp(&key(b)).expect("no rank is NaN"));
    }

    /// The bodies that have an answer, each once, by index. `bodies` is emptied first, and allocates only to grow.
    pub fn bodies<Q: QueryKind>(&self, question: &Q, bodies: &mut Vec<BodyId>) {
        bodies.clear();
        self.shapes(question, |id, shape, frame| {
            if question.is_met(id, shape, frame) {
                bodies.push(id.body);
            }
            ControlFlow::Continue(f32::INFINITY)
        });
        bodies.sort_unstable();
        bodies.dedup();
    }

    /// [`first`](Self::first) of each question; many rays are quicker together. It does not allocate.
    ///
    /// # Panics
    /// If there are not as many answers as questions.
    pub fn first_each<Q: QueryKind>(&self, questions: &[Q], answers: &mut [Option<Q::Answer>]) {
        assert_eq!(questions.len(), answers.len(), "one answer for each question");
        Q::first_each(self, questions, answers);
    }

    /// [`any`](Self::any) of each question. It does not allocate.
    ///
    /// # Panics
    /// If there are not as many answers as questions.
    pub fn any_each<Q: QueryKind>(&self, questions: &[Q], answers: &mut [bool]) {
        assert_eq!(questions.len(), answers.len(), "one answer for each question");
        for (question, answer) in questions.iter().zip(answers) {
            *answer = self.any(question);
        }
    }

    /// [`all`](Self::all) of each question, one after the other: `visit` sees the number of the question and its answers.
    /// `answers` is room to work in, and allocates only to grow.
    pub fn all_each<Q: QueryKind>(
        &self,
        questions: &[Q],
        answers: &mut Vec<Q::Answer>,
        mut visit: impl FnMut(usize, &[Q::Answer]),
    ) {
        for (index, question) in questions.iter().enumerate() {
            self.all(question, answers);
            visit(index, answers);
        }
    }

    /// [`first`](Self::first), for those who answer questions.
    fn best<Q: Ask>(&self, question: &Q) -> Option<Q::Found> {
        let mut best = None;
        self.answers(question, |answer| {
            keep_first(&mut best, answer);
            ControlFlow::Continue(best.as_ref().map_or(f32::INFINITY, Reply::rank))
        });
        best
    }

    /// Every answer, in any order, until `visit` breaks.
    fn answers<Q: Ask>(&self, question: &Q, mut visit: impl FnMut(Q::Found) -> Limit) {
        let mut limit = f32::INFINITY;
        self.shapes(question, |id, shape, frame| {
            if let Some(answer) = question.ask(id, shape, frame) {
                limit = visit(answer)?;
            }
            ControlFlow::Continue(limit)
        });
    }

    fn passes(&self, id: ShapeId, kind: BodyKind, filter: Filter, sensing: Sensing) -> bool {
        self.filter.passes(id, kind, filter, sensing) && (self.accept)(id.body, id.shape)
    }

    /// Every shape that may have an answer and passes, in any order, until `visit` breaks.
    fn shapes<Q: Ask>(&self, question: &Q, mut visit: impl FnMut(ShapeId, &Shape, &Transform) -> Limit) {
        let Some(reach) = question.reach() else { return };
        let mut limit = f32::INFINITY;
        candidates(self.world, &reach, |owner| {
            if let Some(left) = self.meet(owner, &mut visit) {
                limit = left?;
            }
            ControlFlow::Continue(limit)
        });
    }

    /// Shows a shape to `visit`, if it passes.
    #[inline]
    fn meet<T>(&self, owner: Owner, visit: impl FnOnce(ShapeId, &Shape, &Transform) -> T) -> Option<T> {
        let Owner { body: index, shape: number } = owner;
        let id = ShapeId { body: self.world.bodies.id(index), shape: number };
        // A body is spread over lines of the cache that a ray would wait for: what stands alone is asked without it.
        if let Some(placed) = self.world.broad.proxies.lone(index) {
            let Placed { shape, world_from_shape, filter, sensing } = placed;
            return self
                .passes(id, BodyKind::Static, *filter, *sensing)
                .then(|| visit(id, shape, world_from_shape));
        }
        let (body, number) = (self.world.bodies.at(index), number as usize);
        let surface = body.surface(number);
        self.passes(id, body.kind, surface.filter, surface.sensing)
            .then(|| visit(id, &body.shapes[number].shape, &body.world_from_shape(number)))
    }
}

/// Replaces an answer by one that comes before it.
fn keep_first<A: Reply>(best: &mut Option<A>, answer: A) {
    if best.as_ref().is_none_or(|best| key(&answer) < key(best)) {
        *best = Some(answer);
    }
}

/// Key that answers are sorted by: rank, body, shape.
fn key(answer: &impl Reply) -> (f32, u32, u32) {
    let ShapeId { body, shape } = answer.shape();
    (answer.rank(), body.index, shape)
}
