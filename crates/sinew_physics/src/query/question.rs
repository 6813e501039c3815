//! What can be asked: a question finds out one shape's answer, and orders the answers of several.

use super::Query;
use super::candidates::Reach;
use crate::body::shape::Shape;
use crate::id::{BodyId, ShapeId};
use sinew_math::Transform;

/// What a [`Query`](super::Query) can be asked; [the module](super) lists all questions there are.
pub trait Question: sealed::Ask<Found = <Self as Question>::Answer> {
    /// What a shape answers.
    type Answer: sealed::Reply;
}

/// What the questions have to know, kept from those who only ask them.
pub(super) mod sealed {
    use super::{BodyId, Query, Reach, Shape, ShapeId, Transform};

    pub trait Ask {
        /// [`Question::Answer`](super::Question::Answer).
        type Found: Reply;

        /// Where shapes that have an answer are, or `None` if no shape has one: a number is not finite.
        fn reach(&self) -> Option<Reach>;

        /// The answer of a placed shape, if it has one. No number in it is NaN or infinite.
        fn ask(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> Option<Self::Found>;

        /// The first answer to each of several, for questions that have a quicker way than one after the other.
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

        /// True if it has one; where that is cheaper than the answer itself.
        fn is_met(&self, id: ShapeId, shape: &Shape, world_from_shape: &Transform) -> bool {
            self.ask(id, shape, world_from_shape).is_some()
        }
    }

    /// What a shape answers.
    pub trait Reply: Copy + core::fmt::Debug + PartialEq {
        /// Which shape answered.
        fn shape(&self) -> ShapeId;

        /// Where the answer stands among others: what is smaller comes first; equal ones go by body and shape.
        fn rank(&self) -> f32;
    }
}
