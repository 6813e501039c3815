//! Queries of a world: rays, overlaps, sweeps, nearest points.
//!
//! A [`QueryKind`] is plain data. [`World::query`] applies it to all shapes of a world, or to those that pass a
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
//! # Queries
//!
//! | query | finds | answers, in this order |
//! |---|---|---|
//! | [`Ray`](crate::ray::Ray) | shapes on a segment | [`BodyHit`], by fraction |
//! | [`ShapeCast`] | shapes that a moving shape hits | [`BodyHit`], by fraction |
//! | [`OverlapWith`] | shapes that share a point with a shape | [`ShapeId`], by body and shape |
//!
//! [`PenetrationOf`]
//! depth of a shape in each shape that it overlaps, and the way out
//! [`BodyPenetration`], the deepest first
//!
//! | [`ContainsPoint`] | shapes that contain a point | [`ShapeId`], by body and shape |
//! | [`NearestTo`] | surfaces within a distance of a point | [`BodySurface`], the nearest first |
//! | [`NearestToShape`] | surfaces within a distance of a shape | [`BodySurface`], the nearest first |
//!
//! Each query supports the [`first`](Query::first) answer, [`all`](Query::all) answers, [`any`](Query::any) (true if
//! there is an answer), and the [`bodies`](Query::bodies) that answer; and batches of queries, with results in the
//! caller's memory: [`first_each`](Query::first_each), [`all_each`](Query::all_each), [`any_each`](Query::any_each). A
//! shape answers once. Equal answers are ordered by body index, then by shape number, so that the order is
//! deterministic.
//!
//! # Starts inside
//!
//! Shapes are closed sets: a surface belongs to its shape, and touching counts as inside. This holds for every shape
//! and every query:
//!
//! | | apart at the start | touching | inside |
//! |---|---|---|---|
//! | [`Ray`](crate::ray::Ray), [`ShapeCast`] | hit at the first contact, if any | hit at fraction 0, in any direction | same as touching |
//! | their [`normal`](BodyHit::normal) | outward | opposite to the sweep; for zero length, the way out | same as touching |
//! | their [`start`](BodyHit::start) | `None` | depth 0 | depth, and the shortest way out |
//! | [`OverlapWith`], [`ContainsPoint`] | no answer | an answer | an answer |
//! | [`PenetrationOf`] | no answer | depth 0 | depth, and the shortest way out |
//! | [`NearestTo`], [`NearestToShape`] | distance above 0 | 0 | below 0 |
//!
//! A ray that leaves a shape does not hit it again; one without length hits the shapes that contain its start.
//!
//! Meshes and height fields are surfaces: only points on their triangles are inside. Queries hit triangles only from
//! their outside, and no way out leads through the back of a triangle. Distances from them are never negative, except
//! for shapes that cross a triangle.
//!
//! # Queries without answers
//!
//! With a non-finite number, or a negative size or distance, no shape answers. Nothing farther than 10¹⁸ m from the
//! world's origin is found. No answer contains NaN or infinity.

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

/// Query of the shapes of a world that pass a filter and a predicate.
#[derive(Clone, Copy)]
#[must_use]
pub struct Query<'a, P> {
    world: &'a World,
    filter: QueryFilter<'a>,
    accept: P,
}

impl World {
    /// Starts a query of every shape except sensors, unless a [`filter`](Query::filter) is set. Bodies are at their
    /// current poses, from a step or from [`set_transform`](World::set_transform), asleep or awake.
    #[doc(alias = "raycast")]
    #[doc(alias = "cast_ray")]
    #[doc(alias = "QueryPipeline")]
    #[doc(alias = "sweep")]
    pub fn query(&self) -> Query<'_, impl Fn(BodyId, u32) -> bool + Copy> {
        Query { world: self, filter: QueryFilter::default(), accept: |_, _| true }
    }
}

impl<'a, P: Fn(BodyId, u32) -> bool> Query<'a, P> {
    /// Restricts the query to the shapes that pass a filter, replacing an earlier filter.
    pub fn filter(self, filter: QueryFilter<'a>) -> Self {
        Self { filter, ..self }
    }

    /// Restricts the query to shapes that a predicate accepts in addition to the filter, replacing an earlier
    /// predicate. The predicate gets the body and the number of the shape. It is called in any order, possibly
    /// repeatedly, and possibly for shapes that do not answer.
    pub fn accept<F: Fn(BodyId, u32) -> bool>(self, accept: F) -> Query<'a, F> {
        Query { world: self.world, filter: self.filter, accept }
    }

    /// Returns the first answer in the order of the query's kind: for a ray the nearest hit. Equal answers are ordered
    /// by the index of the body, then by the number of the shape.
    pub fn first<Q: QueryKind>(&self, question: &Q) -> Option<Q::Answer> {
        self.best(question)
    }

    /// True if there is an answer; cheaper than [`first`](Self::first).
    pub fn any<Q: QueryKind>(&self, question: &Q) -> bool {
        let mut any = false;
        self.shapes(question, |id, shape, frame| {
            any = question.is_met(id, shape, frame);
            if any { ControlFlow::Break(()) } else { ControlFlow::Continue(f32::INFINITY) }
        });
        any
    }

    /// Writes all answers to `answers`, one per answering shape, in the order of the query's kind, equal ones by body
    /// and shape. Clears `answers` first; allocates only if `answers` must grow.
    pub fn all<Q: QueryKind>(&self, question: &Q, answers: &mut Vec<Q::Answer>) {
        answers.clear();
        self.answers(question, |answer| {
            answers.push(answer);
            ControlFlow::Continue(f32::INFINITY)
        });
        // DETERMINISM: no two keys are equal, so the order in which shapes were found has no effect.
        answers.sort_unstable_by(|a, b| key(a).partial_cmp(&key(b)).expect("no rank is NaN"));
    }

    /// Writes the bodies that answer to `bodies`, each once, by index. Clears `bodies` first; allocates only to grow
    /// it.
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

    /// Writes the [`first`](Self::first) answer of each query. Batches of rays are faster than single rays. Does not
    /// allocate.
    ///
    /// # Panics
    /// If the number of answers differs from the number of queries.
    pub fn first_each<Q: QueryKind>(&self, questions: &[Q], answers: &mut [Option<Q::Answer>]) {
        assert_eq!(questions.len(), answers.len(), "one answer for each question");
        Q::first_each(self, questions, answers);
    }

    /// Writes the result of [`any`](Self::any) for each query. Does not allocate.
    ///
    /// # Panics
    /// If the number of answers differs from the number of queries.
    pub fn any_each<Q: QueryKind>(&self, questions: &[Q], answers: &mut [bool]) {
        assert_eq!(questions.len(), answers.len(), "one answer for each question");
        for (question, answer) in questions.iter().zip(answers) {
            *answer = self.any(question);
        }
    }

    /// Runs [`all`](Self::all) for each query in turn: `visit` gets the number of the query and its answers. `answers`
    /// is scratch memory; it allocates only to grow.
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

    /// Returns the [`first`](Self::first) answer, for internal use.
    fn best<Q: Ask>(&self, question: &Q) -> Option<Q::Found> {
        let mut best = None;
        self.answers(question, |answer| {
            keep_first(&mut best, answer);
            ControlFlow::Continue(best.as_ref().map_or(f32::INFINITY, Reply::rank))
        });
        best
    }

    /// Passes every answer to `visit`, in any order, until `visit` breaks.
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

    /// Passes every shape that may answer and passes the filter to `visit`, in any order, until `visit` breaks.
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

    /// Passes a shape to `visit` if the shape passes the filter; returns the result of `visit`.
    #[inline]
    fn meet<T>(&self, owner: Owner, visit: impl FnOnce(ShapeId, &Shape, &Transform) -> T) -> Option<T> {
        let Owner { body: index, shape: number } = owner;
        let id = ShapeId { body: self.world.bodies.id(index), shape: number };
        // A body spans several cache lines. A single-shape static body is queried without reading the body.
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

/// Replaces the best answer if `answer` precedes it.
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
