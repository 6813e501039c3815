//! GIF: each frame holds only the changed pixels, with its own palette.

use super::palette::{Histogram, Palette};
use super::{EncodeError, Rect, bounds};
use crate::image::Image;
use gif::{DisposalMethod, Encoder, Frame, Repeat};
use std::borrow::Cow;

/// Largest change per channel, since a pixel was last drawn, at which the pixel is left unchanged: the change is invisible, and
/// long runs of unchanged pixels keep the file small.
const UNSEEN_CHANGE: u8 = 5;

/// Strength of the dither, in steps of 1/255: enough to hide the bands in a clear sky; a stronger dither makes files
/// larger.
const DITHER: i32 = 3;

/// Thresholds of ordered dithering in a square of 4 × 4 pixels (Bayer 1973).
const BAYER: [[i32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

pub(super) struct GifWriter {
    encoder: Encoder<Vec<u8>>,
    width: usize,
    height: usize,
    fps: u32,
    frames: u64,
    histogram: Histogram,
    palette: Palette,
    /// Colour of each pixel when it was last drawn, as in the image, before palette and dither.
    drawn: Vec<[u8; 4]>,
    changed: Vec<bool>,
}

/// Number of pixels in one comparison: most stretches of a picture stay unchanged.
const STRETCH: usize = 32;

/// Marks the pixels of a stretch that must be drawn, and stores their colours.
fn redraw(drawn: &mut [[u8; 4]], changed: &mut [bool], rgba: &[u8]) {
    let mut most = 0;
    for (a, b) in drawn.as_flattened().iter().zip(rgba) {
        most = u8::max(most, a.abs_diff(*b));
    }
    if most <= UNSEEN_CHANGE {
        changed.fill(false);
        return;
    }
    for ((drawn, changed), rgba) in drawn.iter_mut().zip(changed).zip(rgba.chunks_exact(4)) {
        *changed = (0..3).any(|i| drawn[i].abs_diff(rgba[i]) > UNSEEN_CHANGE);
        if *changed {
            *drawn = [rgba[0], rgba[1], rgba[2], rgba[3]];
        }
    }
}

impl GifWriter {
    pub(super) fn new(width: u16, height: u16, fps: u32) -> Result<Self, EncodeError> {
        let mut encoder = Encoder::new(Vec::new(), width, height, &[])?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(Self {
            encoder,
            width: width as usize,
            height: height as usize,
            fps,
            frames: 0,
            histogram: Histogram::new(),
            palette: Palette::new(),
            drawn: Vec::new(),
            changed: Vec::new(),
        })
    }

    pub(super) fn push(&mut self, image: &Image) -> Result<(), EncodeError> {
        let rect = self.take_changes(image);
        self.histogram.clear();
        for pixel in rect.pixels(self.width).filter(|&pixel| self.changed[pixel]) {
            let [r, g, b, _] = self.drawn[pixel];
            self.histogram.add([r, g, b]);
        }
        self.palette.fit(&mut self.histogram);
        let transparent = self.palette.colors.len() as u8;
        let mut indices = Vec::with_capacity(rect.width * rect.height);
        for pixel in rect.pixels(self.width) {
            indices.push(if self.changed[pixel] { self.shown(pixel) } else { transparent });
        }
        let mut palette = self.palette.colors.concat();
        palette.extend([0; 3]);
        let frame = Frame {
            delay: self.delay(),
            dispose: DisposalMethod::Keep,
            transparent: Some(transparent),
            left: rect.left as u16,
            top: rect.top as u16,
            width: rect.width as u16,
            height: rect.height as u16,
            palette: Some(palette),
            buffer: Cow::Owned(indices),
            ..Frame::default()
        };
        self.encoder.write_frame(&frame)?;
        self.frames += 1;
        Ok(())
    }

    pub(super) fn finish(self) -> Result<Vec<u8>, EncodeError> {
        self.encoder.into_inner().map_err(EncodeError::Gif)
    }

    /// Marks the pixels that must be drawn and returns the rectangle around them. A frame needs at least one pixel.
    fn take_changes(&mut self, image: &Image) -> Rect {
        if self.frames == 0 {
            self.drawn =
                image.rgba.chunks_exact(4).map(|rgba| [rgba[0], rgba[1], rgba[2], rgba[3]]).collect();
            self.changed = vec![true; self.drawn.len()];
        } else {
            let drawn = self.drawn.chunks_mut(STRETCH).zip(self.changed.chunks_mut(STRETCH));
            for ((drawn, changed), rgba) in drawn.zip(image.rgba.chunks(4 * STRETCH)) {
                redraw(drawn, changed, rgba);
            }
        }
        let first_pixel = Rect { left: 0, top: 0, width: 1, height: 1 };
        bounds(self.width, self.height, |pixel| self.changed[pixel]).unwrap_or(first_pixel)
    }

    /// Returns the palette entry of a pixel, after dithering. The pattern is fixed to the picture, so that it does not flicker.
    fn shown(&mut self, pixel: usize) -> u8 {
        let threshold = BAYER[pixel / self.width % 4][pixel % self.width % 4];
        let shift = (2 * threshold - 15) * DITHER / 15;
        let [r, g, b, _] = self.drawn[pixel];
        self.palette.entry([r, g, b].map(|channel| (i32::from(channel) + shift).clamp(0, 255) as u8))
    }

    /// Returns the hundredths of a second to the next frame. Sums stay right if `fps` does not divide 100: 3, 3, 4 at 30.
    fn delay(&self) -> u16 {
        let time = |frame: u64| (frame * 100 + u64::from(self.fps) / 2) / u64::from(self.fps);
        (time(self.frames + 1) - time(self.frames)) as u16
    }
}
