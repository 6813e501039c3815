//! WebP, lossless, and animated from the second frame on (RFC 9649, §2.7).

use super::changes::Changes;
use super::{EncodeError, Rect};
use crate::image::Image;
use image_webp::{ColorType, WebPEncoder};

/// Writer of a WebP. Frames are compressed as they arrive; the file is assembled at the end, because only then their number is
/// known.
pub(super) struct WebpWriter {
    width: u32,
    height: u32,
    fps: u32,
    changes: Changes,
    frames: Vec<CompressedFrame>,
}

struct CompressedFrame {
    rect: Rect,
    /// A still WebP file of the rectangle.
    webp: Vec<u8>,
}

/// Length of the file header: `RIFF`, the length of the rest, `WEBP`.
const FILE_HEADER: usize = 12;
/// Bit of the extended header that marks an animation.
const ANIMATION: u8 = 1 << 1;
/// Bit of a frame's header: the frame is drawn over, not blended.
const DO_NOT_BLEND: u8 = 1 << 1;

impl WebpWriter {
    pub(super) fn new(width: u32, height: u32, fps: u32) -> Self {
        Self { width, height, fps, changes: Changes::default(), frames: Vec::new() }
    }

    pub(super) fn push(&mut self, image: &Image) -> Result<(), EncodeError> {
        // The format places frames in steps of two pixels.
        let (rect, rgb) = self.changes.take(image, 2);
        let mut webp = Vec::new();
        WebPEncoder::new(&mut webp).encode(&rgb, rect.width as u32, rect.height as u32, ColorType::Rgb8)?;
        self.frames.push(CompressedFrame { rect, webp });
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<Vec<u8>, EncodeError> {
        if self.frames.len() == 1 {
            return Ok(self.frames.remove(0).webp);
        }
        let mut body = Vec::new();
        let mut extended = vec![ANIMATION, 0, 0, 0];
        extended.extend(uint24(self.width - 1));
        extended.extend(uint24(self.height - 1));
        chunk(&mut body, *b"VP8X", &extended);
        // Background colour and number of plays; 0 plays for ever.
        chunk(&mut body, *b"ANIM", &[0; 6]);
        for (number, frame) in self.frames.iter().enumerate() {
            chunk(&mut body, *b"ANMF", &self.frame(number as u64, frame));
        }
        let mut file = b"RIFF".to_vec();
        let length = u32::try_from(body.len() + 4).map_err(|_| EncodeError::TooLong)?;
        file.extend(length.to_le_bytes());
        file.extend(b"WEBP");
        file.extend(body);
        Ok(file)
    }

    fn frame(&self, number: u64, frame: &CompressedFrame) -> Vec<u8> {
        let CompressedFrame { rect, webp } = frame;
        let time = |number: u64| (number * 1000 + u64::from(self.fps) / 2) / u64::from(self.fps);
        let milliseconds = (time(number + 1) - time(number)) as u32;
        let halves = [rect.left as u32 / 2, rect.top as u32 / 2];
        let sizes = [rect.width as u32 - 1, rect.height as u32 - 1];
        let numbers = [halves[0], halves[1], sizes[0], sizes[1], milliseconds];
        let mut data: Vec<u8> = numbers.into_iter().flat_map(uint24).collect();
        data.push(DO_NOT_BLEND);
        // A still file consists of its header and the pixel chunk, which a frame uses unchanged.
        data.extend(&webp[FILE_HEADER..]);
        data
    }
}

fn uint24(value: u32) -> [u8; 3] {
    let [a, b, c, _] = value.to_le_bytes();
    [a, b, c]
}

fn chunk(file: &mut Vec<u8>, kind: [u8; 4], data: &[u8]) {
    file.extend(kind);
    file.extend((data.len() as u32).to_le_bytes());
    file.extend(data);
    if data.len() % 2 == 1 {
        file.push(0);
    }
}
