//! Changes between images: lossless animations store only the changed rectangle.

use super::{Rect, bounds};
use crate::image::Image;

/// Stores the last image.
#[derive(Default)]
pub(super) struct Changes {
    previous: Vec<u8>,
}

impl Changes {
    /// Returns the rectangle in which the image differs from the last one, with its pixels as RGB. It is the whole
    /// image for the first one, and a single pixel if nothing differs. Its left and top are multiples of `grid`.
    pub(super) fn take(&mut self, image: &Image, grid: usize) -> (Rect, Vec<u8>) {
        let (width, height) = (image.width as usize, image.height as usize);
        let pixel =
            |bytes: &[u8], index: usize| [bytes[4 * index], bytes[4 * index + 1], bytes[4 * index + 2]];
        let rect = if self.previous.is_empty() {
            Rect { left: 0, top: 0, width, height }
        } else {
            let changed = |index: usize| pixel(&image.rgba, index) != pixel(&self.previous, index);
            bounds(width, height, changed).unwrap_or(Rect { left: 0, top: 0, width: 1, height: 1 })
        };
        let (left, top) = (rect.left - rect.left % grid, rect.top - rect.top % grid);
        let rect =
            Rect { left, top, width: rect.width + rect.left - left, height: rect.height + rect.top - top };
        self.previous.clone_from(&image.rgba);
        (rect, rect.pixels(width).flat_map(|index| pixel(&image.rgba, index)).collect())
    }
}
