//! Kinds of queries: each finds the answer of one shape, and orders the answers of several shapes.

use super::Query;
use super::candidates::Reach;
use crate::body::shape::Shape;
use crate::id::{BodyId, ShapeId};
use sinew_math::Transform;

/// Kind of a [`Query`]; [the module](super) lists all kinds.
pub trait QueryKind: sealed::Ask<Found = <Self as QueryKind>::Answer> {
    /// Answer of a shape.
    type Answer: sealed::Reply;
}

/// Internal methods of query kinds, hidden from users.
pub(super) mod sealed {
    use super::{BodyId, Query, Reach, Shape, ShapeId, Transform};

    pub trait Ask {
        /// [`QueryKind::Answer`](super::QueryKind::Answer).
        type Found: Reply;

        /// Reach of the query, or `None` if no shape can answer: a number is not finite.
        fn reach(&self) -> Option<Reach>;

        /// Returns the answer of a placed shape, if it has one. No number in the answer is NaN or infinite.
        fn ask(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> Option<Self::Found>;

        /// The first answer to each of several queries, for kinds with a faster batch algorithm.
        fn first_each<P: Fn(BodyId, u32) -> bool>(
            query: &Query<'_, P>,
            questions: &[Self],
            answers: &mut [Option<Self::Found>],
        ) where
            Self: Sized,
        {
            for (question, answer) in questions.iter().zip(answers) {
                *answer = query.best(question);
            }
        }

        /// True if the shape has an answer; may be cheaper than the answer itself.
        fn is_met(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> bool {
            self.ask(id, shape, world_from_shape).is_some()
        }
    }

    /// Answer of a shape.
    pub trait Reply: Copy + core::fmt::Debug + PartialEq {
        /// Shape that was found.
        fn shape(&self) -> ShapeId;

        /// Rank of the answer: smaller comes first; equal ranks are ordered by body and shape.
        fn rank(&self) -> f32;
    }
}
