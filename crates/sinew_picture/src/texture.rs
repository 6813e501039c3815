use crate::color::ColorTables;
use sinew::math::Vec2;

/// An image on a surface, with a chain of smaller copies (mip levels), so that it does not shimmer at a distance.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Mip levels: the first has the full size, each of the others half the size of the one before in both directions,
    /// the last is 1 × 1.
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
struct Level {
    width: usize,
    height: usize,
    /// Texels, sRGB with alpha, rows from the top.
    rgba: Vec<u8>,
}

/// Error returned when the number of bytes does not fit the size of a texture.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a texture of {width} × {height} needs {needed} bytes and got {got}")]
pub struct TextureError {
    /// Requested width, pixels.
    pub width: u32,
    /// Requested height, pixels.
    pub height: u32,
    /// Required number of bytes: `width × height × 4`, or 4 if a side is 0.
    pub needed: u64,
    /// Number of bytes given.
    pub got: u64,
}

impl Texture {
    /// Creates a texture from 8-bit sRGB with alpha, `width × height × 4` bytes, rows from the top.
    ///
    /// # Errors
    /// If a side is 0, or the number of bytes does not fit the sides.
    pub fn new(width: u32, height: u32, rgba: Vec<u8>) -> Result<Self, TextureError> {
        let needed = (u64::from(width) * u64::from(height)).saturating_mul(4);
        let got = rgba.len() as u64;
        if needed == 0 || needed != got {
            return Err(TextureError { width, height, needed: needed.max(4), got });
        }
        let tables = ColorTables::new();
        let mut levels = vec![Level { width: width as usize, height: height as usize, rgba }];
        while let Some(smaller) = levels.last().and_then(|level| level.halved(&tables)) {
            levels.push(smaller);
        }
        Ok(Self { levels })
    }

    /// Returns width, height and bytes of each mip level, from the full size down: 8-bit sRGB with alpha, rows from the
    /// top.
    pub fn levels(&self) -> impl Iterator<Item = (u32, u32, &[u8])> {
        self.levels.iter().map(|level| (level.width as u32, level.height as u32, level.rgba.as_slice()))
    }

    /// Returns the number of texels of the full image.
    pub(crate) fn texels(&self) -> f32 {
        (self.levels[0].width * self.levels[0].height) as f32
    }

    /// Returns the mip level whose texels are nearest in size to a pixel, for a pixel that covers an area of
    /// `texels_per_pixel` texels of the full image.
    pub(crate) fn level_for(&self, texels_per_pixel: f32) -> usize {
        let mut level = 0;
        let mut area = texels_per_pixel;
        // Each level has a quarter of the area; the limit of 2 is half a level.
        while area > 2.0 && level + 1 < self.levels.len() {
            area *= 0.25;
            level += 1;
        }
        level
    }

    /// Returns the linear colour at `uv`, bilinear, repeated outside 0..1.
    pub(crate) fn sample(&self, uv: Vec2, level: usize, tables: &ColorTables) -> [f32; 3] {
        let level = &self.levels[level];
        let (x0, x1, fx) = texel_pair(uv.x, level.width);
        let (y0, y1, fy) = texel_pair(uv.y, level.height);
        let [a, b, c, d] = [level.at(x0, y0), level.at(x1, y0), level.at(x0, y1), level.at(x1, y1)];
        core::array::from_fn(|i| {
            let [a, b, c, d] = [a, b, c, d].map(|texel| tables.to_linear(texel[i]));
            let (top, bottom) = (a + (b - a) * fx, c + (d - c) * fx);
            top + (bottom - top) * fy
        })
    }
}

impl Level {
    fn at(&self, x: usize, y: usize) -> [u8; 4] {
        let start = (y * self.width + x) * 4;
        [self.rgba[start], self.rgba[start + 1], self.rgba[start + 2], self.rgba[start + 3]]
    }

    /// Returns the mip level of half the size, which averages 2 × 2 texels in linear light; `None` for the level 1 × 1.
    fn halved(&self, tables: &ColorTables) -> Option<Self> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let mut rgba = Vec::with_capacity(width * height * 4);
        for y in 0..height {
            let (y0, y1) = (2 * y, (2 * y + 1).min(self.height - 1));
            for x in 0..width {
                let (x0, x1) = (2 * x, (2 * x + 1).min(self.width - 1));
                let texels = [self.at(x0, y0), self.at(x1, y0), self.at(x0, y1), self.at(x1, y1)];
                for channel in 0..3 {
                    let [a, b, c, d] = texels.map(|texel| tables.to_linear(texel[channel]));
                    rgba.push(tables.to_srgb((a + b + c + d) * 0.25));
                }
                let alpha: u32 = texels.iter().map(|texel| u32::from(texel[3])).sum();
                rgba.push(((alpha + 2) / 4) as u8);
            }
        }
        Some(Self { width, height, rgba })
    }
}

/// Returns the two texels around coordinate `u` in a row of `count`, and the fraction from the first to the second.
fn texel_pair(u: f32, count: usize) -> (usize, usize, f32) {
    let wrapped = u - u.floor();
    let position = if (0.0..1.0).contains(&wrapped) { wrapped } else { 0.0 } * count as f32 - 0.5;
    let base = position.floor();
    let first = (base as i64).rem_euclid(count as i64) as usize;
    (first, (first + 1) % count, position - base)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texel_centres_are_exact_and_borders_repeat() {
        let tables = ColorTables::new();
        let texture = Texture::new(2, 1, vec![255, 0, 0, 255, 0, 0, 255, 255]).expect("2 × 1");
        assert_eq!(texture.sample(Vec2::new(0.25, 0.5), 0, &tables), [1.0, 0.0, 0.0]);
        assert_eq!(texture.sample(Vec2::new(-0.25, 3.5), 0, &tables), [0.0, 0.0, 1.0]);
        assert_eq!(texture.sample(Vec2::new(0.5, 0.5), 0, &tables), [0.5, 0.0, 0.5]);
        assert_eq!(texture.sample(Vec2::new(f32::NAN, f32::INFINITY), 0, &tables).len(), 3);
    }

    #[test]
    fn smaller_copies_keep_the_light() {
        let tables = ColorTables::new();
        let pixels = [[255, 255, 255, 255], [0, 0, 0, 255], [0, 0, 0, 255], [255, 255, 255, 255]].concat();
        let texture = Texture::new(2, 2, pixels).expect("2 × 2");
        assert_eq!(texture.level_for(4.0), 1);
        let gray = texture.sample(Vec2::new(0.5, 0.5), 1, &tables)[0];
        assert!((gray - 0.5).abs() < 0.01, "{gray}");
    }

    #[test]
    fn wrong_sizes_are_errors() {
        assert!(Texture::new(0, 4, vec![]).is_err());
        assert!(Texture::new(2, 2, vec![0; 15]).is_err());
        assert!(Texture::new(u32::MAX, u32::MAX, vec![0; 4]).is_err());
    }
}
