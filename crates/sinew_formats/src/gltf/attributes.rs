//! Attributes of a primitive's vertices, uncompressed or compressed.

use super::accessor::fill_holes;
use super::draco::Decoded;
use super::source::Source;
use crate::container::json::At;
use crate::error::Result;

/// The attributes of a primitive.
pub(super) struct Attributes<'s, 'a> {
    source: &'s Source<'a>,
    at: At<'a>,
    draco: Option<Decoded<'a>>,
}

impl<'s, 'a> Attributes<'s, 'a> {
    /// Returns the attributes of a primitive whose position accessor is `position`.
    pub(super) fn of(source: &'s Source<'a>, primitive: At<'a>, position: At<'a>) -> Result<Self> {
        let draco = Decoded::of(source, primitive, position)?;
        Ok(Self { source, at: primitive.need("attributes")?, draco })
    }

    /// Returns the attribute's accessor index; `None` if the primitive lacks the attribute.
    pub(super) fn get(&self, name: &str) -> Result<Option<At<'a>>> {
        self.at.get(name)
    }

    /// Returns the Draco stream if it has the attribute.
    fn stream(&self, name: &str) -> Result<Option<&Decoded<'a>>> {
        match &self.draco {
            Some(draco) if draco.holds(name)? => Ok(Some(draco)),
            _ => Ok(None),
        }
    }

    /// Returns elements of `N` numbers, with 0 for numbers that are not finite, and the indices of elements
    /// with such numbers.
    pub(super) fn floats<const N: usize>(
        &self,
        name: &str,
        at: At<'a>,
    ) -> Result<(Vec<[f32; N]>, Vec<usize>)> {
        let Some(draco) = self.stream(name)? else { return self.source.floats_and_holes(at) };
        let full = self.source.full_scale(at)?;
        let mut numbers = draco.numbers::<N>(self.source, name)?;
        if full > 1.0 {
            numbers.iter_mut().flatten().for_each(|x| *x = sinew_math::max(*x / full, -1.0));
        }
        let holes = fill_holes(&mut numbers);
        Ok((numbers, holes))
    }

    /// Returns elements of `N` unsigned integers.
    pub(super) fn integers<const N: usize>(&self, name: &str, at: At<'a>) -> Result<Vec<[u32; N]>> {
        let Some(draco) = self.stream(name)? else { return self.source.integers(at) };
        let numbers = draco.numbers::<N>(self.source, name)?;
        // Negative numbers and NaN become 0, because integer attributes have none.
        Ok(numbers.into_iter().map(|element| element.map(|x| x as u32)).collect())
    }

    /// Returns the corners of the stream's triangles; `None` if the primitive is not compressed.
    pub(super) fn triangles(&self) -> Result<Option<Vec<u32>>> {
        self.draco.as_ref().map(|draco| draco.triangles(self.source)).transpose()
    }
}
