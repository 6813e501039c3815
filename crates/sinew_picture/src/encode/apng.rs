//! PNG, and APNG from the second frame on (PNG specification, third edition, §4.9 and §11.3.6).

use super::changes::Changes;
use super::{EncodeError, Rect};
use crate::image::Image;
use png::chunk::{IDAT, fcTL, fdAT};
use png::{BitDepth, ColorType, Compression, Encoder};

/// Writer of a PNG. Frames are compressed as they arrive; the file is assembled at the end, because its header contains their number.
pub(super) struct ApngWriter {
    width: u32,
    height: u32,
    fps: u32,
    changes: Changes,
    frames: Vec<CompressedFrame>,
}

struct CompressedFrame {
    rect: Rect,
    /// A still PNG of the rectangle.
    png: Vec<u8>,
}

impl ApngWriter {
    pub(super) fn new(width: u32, height: u32, fps: u32) -> Self {
        Self { width, height, fps, changes: Changes::default(), frames: Vec::new() }
    }

    pub(super) fn push(&mut self, image: &Image) -> Result<(), EncodeError> {
        let (rect, rgb) = self.changes.take(image, 1);
        let mut png = Vec::new();
        let mut writer = encoder(&mut png, rect.width as u32, rect.height as u32).write_header()?;
        writer.write_image_data(&rgb)?;
        writer.finish()?;
        self.frames.push(CompressedFrame { rect, png });
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<Vec<u8>, EncodeError> {
        if self.frames.len() == 1 {
            return Ok(self.frames.remove(0).png);
        }
        let mut file = Vec::new();
        let mut encoder = encoder(&mut file, self.width, self.height);
        encoder.set_animated(self.frames.len() as u32, 0)?;
        // The frames are written as finished chunks, which the encoder does not track.
        encoder.validate_sequence(false);
        let mut writer = encoder.write_header()?;
        let mut sequence = 0u32;
        for (number, frame) in self.frames.iter().enumerate() {
            writer.write_chunk(fcTL, &frame_control(sequence, frame.rect, self.fps))?;
            sequence += 1;
            for data in chunks(&frame.png).filter(|(kind, _)| *kind == IDAT.0).map(|(_, data)| data) {
                if number == 0 {
                    writer.write_chunk(IDAT, data)?;
                } else {
                    writer.write_chunk(fdAT, &[&sequence.to_be_bytes(), data].concat())?;
                    sequence += 1;
                }
            }
        }
        writer.finish()?;
        Ok(file)
    }
}

fn encoder(file: &mut Vec<u8>, width: u32, height: u32) -> Encoder<'static, &mut Vec<u8>> {
    let mut encoder = Encoder::new(file, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    encoder
}

/// Returns the data of a frame's control chunk: sequence number, rectangle and time. The last two bytes, zeros, mean: keep the frame, and
/// draw over it.
fn frame_control(sequence: u32, rect: Rect, fps: u32) -> Vec<u8> {
    let numbers = [sequence, rect.width as u32, rect.height as u32, rect.left as u32, rect.top as u32];
    let mut data: Vec<u8> = numbers.into_iter().flat_map(u32::to_be_bytes).collect();
    data.extend(1u16.to_be_bytes());
    data.extend((fps as u16).to_be_bytes());
    data.extend([0, 0]);
    data
}

/// Returns kind and data of each chunk of a PNG file that this crate wrote.
fn chunks(png: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    const SIGNATURE: usize = 8;
    let mut rest = &png[SIGNATURE..];
    core::iter::from_fn(move || {
        let (&length, after) = rest.split_first_chunk::<4>()?;
        let (&kind, after) = after.split_first_chunk::<4>()?;
        let (data, crc_and_rest) = after.split_at(u32::from_be_bytes(length) as usize);
        rest = &crc_and_rest[4..];
        Some((kind, data))
    })
}
