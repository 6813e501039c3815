//! Overlay on the finished picture: lines and text.

use crate::camera::{NEAR, View};
use crate::color::ColorTables;
use crate::image::Image;
use crate::pipeline::raster::{Samples, ScreenVertex};
use crate::scene::{Caption, Line, LineDepth};
use sinew::math::{clamp, max};

/// Bitmap of the letters, from the space on, sixteen in a row; `#` marks a set dot.
const GLYPHS: &[u8] = include_bytes!("glyphs.txt");
const GLYPH_ROWS: usize = 8;
const GLYPH_COLUMNS: usize = 5;
/// Number of columns of a letter, including the gap after it.
const ADVANCE: usize = GLYPH_COLUMNS + 1;
const LETTERS_PER_ROW: usize = 16;
/// Number of bytes in a line of the bitmap, which ends with a line feed instead of the last letter's gap.
const SHEET_PITCH: usize = LETTERS_PER_ROW * ADVANCE;

/// Factor by which a line is drawn nearer, so that the surface under it does not hide it.
const LINE_BIAS: f32 = 1.004;

pub(crate) fn draw_lines(
    image: &mut Image,
    lines: &[Line],
    view: &View,
    samples: &Samples,
    tables: &ColorTables,
) {
    for line in lines {
        if let Some(ends) = on_picture(line, view, samples) {
            draw_line(image, ends, tables.to_srgb3(line.color), line.depth, samples);
        }
    }
}

/// Returns the ends of the part of a line that is in front of the camera and inside or near the picture.
fn on_picture(line: &Line, view: &View, samples: &Samples) -> Option<[ScreenVertex; 2]> {
    let [a, b] = [view.clip_from_world(line.from), view.clip_from_world(line.to)];
    let (mut first, mut last) = (0.0f32, 1.0f32);
    // Liang and Barsky 1984: the part between the near plane and the four edges of the picture.
    let inside = |v: [f32; 3]| [v[2] - NEAR, v[2] - v[0], v[2] + v[0], v[2] - v[1], v[2] + v[1]];
    for (da, db) in inside(a).into_iter().zip(inside(b)) {
        if !(da >= 0.0 || db >= 0.0) {
            return None;
        }
        if da < 0.0 {
            first = max(first, da / (da - db));
        } else if db < 0.0 {
            last = sinew::math::min(last, da / (da - db));
        }
    }
    // The comparison is false for NaN.
    let some = first < last;
    some.then(|| {
        [first, last].map(|t| {
            let v = core::array::from_fn(|i| a[i] + (b[i] - a[i]) * t);
            ScreenVertex::from_clip(v, samples.width, samples.height)
        })
    })
}

/// Draws an antialiased line: two pixels at each step along its longer direction, weighted by their distance from the
/// line (Wu, "An Efficient Antialiasing Technique", SIGGRAPH 1991); the line is a little wider for readability.
fn draw_line(
    image: &mut Image,
    [a, b]: [ScreenVertex; 2],
    srgb: [u8; 3],
    depth: LineDepth,
    samples: &Samples,
) {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    let steep = dy.abs() > dx.abs();
    let steps = (max(dx.abs(), dy.abs()) + 1.0) as i32;
    for step in 0..=steps {
        let t = step as f32 / steps as f32;
        let (x, y) = (a.x + dx * t - 0.5, a.y + dy * t - 0.5);
        let nearness = (a.depth + (b.depth - a.depth) * t) * LINE_BIAS;
        let along = if steep { y } else { x }.floor() as i32;
        let across = if steep { x } else { y };
        for pixel in across.floor() as i32 - 1..=across.floor() as i32 + 2 {
            let amount = clamp(1.2 - (across - pixel as f32).abs(), 0.0, 1.0);
            let (px, py) = if steep { (pixel, along) } else { (along, pixel) };
            if amount > 0.0 && (depth == LineDepth::OnTop || !hidden(samples, px, py, nearness)) {
                image.blend(px, py, srgb, (amount * 255.0) as u8);
            }
        }
    }
}

fn hidden(samples: &Samples, x: i32, y: i32, nearness: f32) -> bool {
    let on_it = x >= 0 && y >= 0 && x < samples.width as i32 && y < samples.height as i32;
    on_it && samples.depth(x as usize, y as usize) > nearness
}

/// Writes text over a finished picture.
pub fn add_captions(image: &mut Image, captions: &[Caption]) {
    draw_captions(image, captions, &ColorTables::new());
}

pub(crate) fn draw_captions(image: &mut Image, captions: &[Caption], tables: &ColorTables) {
    for caption in captions {
        let scale = caption.scale.max(1) as i32;
        let width = caption.text.chars().count() as i32 * ADVANCE as i32 * scale;
        let height = GLYPH_ROWS as i32 * scale;
        let left = if caption.x < 0 { image.width as i32 + caption.x - width } else { caption.x };
        let top = if caption.y < 0 { image.height as i32 + caption.y - height } else { caption.y };
        // A dark plate keeps the text readable over any picture.
        fill(
            image,
            [left - 2 * scale, top - 2 * scale],
            [width + 3 * scale, height + 3 * scale],
            [16, 20, 26],
            120,
        );
        let srgb = tables.to_srgb3(caption.color);
        for (i, letter) in caption.text.chars().enumerate() {
            let left = left + i as i32 * ADVANCE as i32 * scale;
            for (row, column) in ink(letter) {
                let corner = [left + column as i32 * scale, top + row as i32 * scale];
                fill(image, corner, [scale, scale], srgb, 255);
            }
        }
    }
}

fn fill(image: &mut Image, [left, top]: [i32; 2], [width, height]: [i32; 2], srgb: [u8; 3], amount: u8) {
    for y in top..top + height {
        for x in left..left + width {
            image.blend(x, y, srgb, amount);
        }
    }
}

/// Returns row and column of every dot of a letter.
fn ink(letter: char) -> impl Iterator<Item = (usize, usize)> {
    let code = if (' '..='~').contains(&letter) { letter as usize } else { '?' as usize } - ' ' as usize;
    let corner = code / LETTERS_PER_ROW * GLYPH_ROWS * SHEET_PITCH + code % LETTERS_PER_ROW * ADVANCE;
    let dots = (0..GLYPH_ROWS).flat_map(|row| (0..GLYPH_COLUMNS).map(move |column| (row, column)));
    dots.filter(move |&(row, column)| GLYPHS[corner + row * SHEET_PITCH + column] == b'#')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_letter_has_ink_of_its_own() {
        let dots = |letter: char| ink(letter).collect::<Vec<_>>();
        assert!(dots(' ').is_empty());
        for a in '!'..='~' {
            assert!(!dots(a).is_empty(), "{a}");
            for b in (' '..a).filter(|&b| b != a) {
                assert_ne!(dots(a), dots(b), "{a} {b}");
            }
        }
        assert_eq!(dots('é'), dots('?'));
    }
}
