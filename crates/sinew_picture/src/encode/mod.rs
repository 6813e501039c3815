//! Encodes images as a GIF, PNG or WebP file; PNG and WebP are animated from the second image on.

mod apng;
mod changes;
mod gif;
mod palette;
mod webp;

use crate::image::Image;
use apng::ApngWriter;
use gif::GifWriter;
use webp::WebpWriter;

/// Kind of picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// GIF, with 256 colours a frame: every viewer plays it; the smallest for movies.
    Gif,
    /// Lossless PNG; with several frames an APNG, which browsers play and other viewers show as its first frame.
    Png,
    /// Lossless WebP; animated with several frames.
    WebP,
}

impl PictureFormat {
    /// Returns the format of a file name's extension, in upper or lower case: `gif`, `png`, `apng`, `webp`.
    pub fn from_extension(extension: &str) -> Option<Self> {
        let is = |name: &str| extension.eq_ignore_ascii_case(name);
        if is("gif") {
            Some(Self::Gif)
        } else if is("png") || is("apng") {
            Some(Self::Png)
        } else if is("webp") {
            Some(Self::WebP)
        } else {
            None
        }
    }
}

/// Reason why no picture file was made.
#[derive(Debug, thiserror::Error)]
pub enum EncodeError {
    /// No image was given.
    #[error("a picture file needs at least one image")]
    Empty,
    /// An image has no pixels, or its bytes do not fit its size.
    #[error("an image of {width} × {height} pixels cannot have {bytes} bytes")]
    Malformed {
        /// Width in pixels.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Length of the image's `rgba`, bytes.
        bytes: usize,
    },
    /// An image has a different size from the first.
    #[error("the images differ in size: {first:?} and {other:?}")]
    Size {
        /// Width and height of the first image, pixels.
        first: (u32, u32),
        /// Width and height of the image, pixels.
        other: (u32, u32),
    },
    /// The format does not allow pictures this large.
    #[error("{width} × {height} is more than the format's {most} pixels a side")]
    TooLarge {
        /// Width in pixels.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Largest number of pixels along a side.
        most: u32,
    },
    /// The WebP movie has more than 4 GiB.
    #[error("the movie is longer than a WebP file can be")]
    TooLong,
    /// The GIF encoder failed.
    #[error("GIF: {0}")]
    Gif(#[from] ::gif::EncodingError),
    /// The PNG encoder failed.
    #[error("PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// The WebP encoder failed.
    #[error("WebP: {0}")]
    WebP(#[from] image_webp::EncodingError),
}

/// A picture file that grows image by image, so that a movie need not keep all images.
pub struct Movie {
    format: PictureFormat,
    fps: u32,
    size: Option<(u32, u32)>,
    writer: Option<FrameWriter>,
}

enum FrameWriter {
    Gif(Box<GifWriter>),
    Png(Box<ApngWriter>),
    WebP(Box<WebpWriter>),
}

impl Movie {
    /// Starts a file with `fps` images a second, 1..=100 (GIF counts time in 1/100 s). The first image decides
    /// the size.
    ///
    /// # Panics
    /// If `fps` is outside 1..=100.
    pub fn new(format: PictureFormat, fps: u32) -> Self {
        assert!((1..=100).contains(&fps), "the rate must be 1 to 100 images a second, not {fps}");
        Self { format, fps, size: None, writer: None }
    }

    /// Appends an image. Its alpha is ignored.
    ///
    /// # Errors
    /// If an image is malformed, differs in size from the first image, or is too large for the format.
    pub fn push(&mut self, image: &Image) -> Result<(), EncodeError> {
        check(image, self.size, self.format)?;
        self.size = Some((image.width, image.height));
        let writer = match &mut self.writer {
            Some(writer) => writer,
            none => none.insert(FrameWriter::new(self.format, image, self.fps)?),
        };
        match writer {
            FrameWriter::Gif(writer) => writer.push(image),
            FrameWriter::Png(writer) => writer.push(image),
            FrameWriter::WebP(writer) => writer.push(image),
        }
    }

    /// Returns the bytes of the file.
    ///
    /// # Errors
    /// If no image was pushed, or more than the format can hold.
    pub fn finish(self) -> Result<Vec<u8>, EncodeError> {
        match self.writer.ok_or(EncodeError::Empty)? {
            FrameWriter::Gif(writer) => writer.finish(),
            FrameWriter::Png(writer) => writer.finish(),
            FrameWriter::WebP(writer) => writer.finish(),
        }
    }
}

impl FrameWriter {
    fn new(format: PictureFormat, first: &Image, fps: u32) -> Result<Self, EncodeError> {
        let (width, height) = (first.width, first.height);
        Ok(match format {
            PictureFormat::Gif => Self::Gif(Box::new(GifWriter::new(width as u16, height as u16, fps)?)),
            PictureFormat::Png => Self::Png(Box::new(ApngWriter::new(width, height, fps))),
            PictureFormat::WebP => Self::WebP(Box::new(WebpWriter::new(width, height, fps))),
        })
    }
}

/// Encodes all images; `fps` as in [`Movie::new`].
///
/// # Errors
/// The errors of [`Movie::push`] and [`Movie::finish`].
///
/// # Panics
/// If `fps` is outside 1..=100.
pub fn encode(format: PictureFormat, images: &[Image], fps: u32) -> Result<Vec<u8>, EncodeError> {
    let mut movie = Movie::new(format, fps);
    for image in images {
        movie.push(image)?;
    }
    movie.finish()
}

fn check(image: &Image, size: Option<(u32, u32)>, format: PictureFormat) -> Result<(), EncodeError> {
    let &Image { width, height, ref rgba } = image;
    let bytes = (u64::from(width) * u64::from(height)).saturating_mul(4);
    if bytes == 0 || bytes != rgba.len() as u64 {
        return Err(EncodeError::Malformed { width, height, bytes: rgba.len() });
    }
    if let Some(first) = size
        && first != (width, height)
    {
        return Err(EncodeError::Size { first, other: (width, height) });
    }
    let most = match format {
        PictureFormat::Gif => 65_535,
        PictureFormat::Png => i32::MAX as u32,
        PictureFormat::WebP => 16_383,
    };
    if width > most || height > most {
        return Err(EncodeError::TooLarge { width, height, most });
    }
    Ok(())
}

/// Rectangle of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rect {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

/// Returns the smallest rectangle around all pixels for which `changed(index)` holds; `None` if there are none.
fn bounds(width: usize, height: usize, changed: impl Fn(usize) -> bool) -> Option<Rect> {
    let row_changed = |y: &usize| (y * width..(y + 1) * width).any(&changed);
    let top = (0..height).find(row_changed)?;
    let bottom = (top..height).rev().find(row_changed)?;
    let column_changed = |x: &usize| (top..=bottom).any(|y| changed(y * width + x));
    let left = (0..width).find(column_changed)?;
    let right = (left..width).rev().find(column_changed)?;
    Some(Rect { left, top, width: right - left + 1, height: bottom - top + 1 })
}

impl Rect {
    /// Returns the indices of the rectangle's pixels in a picture `pitch` pixels wide, row by row.
    fn pixels(self, pitch: usize) -> impl Iterator<Item = usize> {
        let rows = self.top..self.top + self.height;
        rows.flat_map(move |y| (y * pitch + self.left..).take(self.width))
    }
}
