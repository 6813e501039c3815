/// A finished picture: 8-bit sRGB with alpha, rows from the top.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width × height × 4` bytes, RGBA. Images of a [`Renderer`](crate::Renderer) are opaque.
    pub rgba: Vec<u8>,
}

impl Image {
    /// Creates a picture of one colour.
    pub fn filled(width: u32, height: u32, rgba: [u8; 4]) -> Self {
        Self { width, height, rgba: rgba.repeat(width as usize * height as usize) }
    }

    /// Returns RGBA of the pixel in column `x` from the left and row `y` from the top.
    ///
    /// # Panics
    /// If the pixel is outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 4] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y}) of {} × {}", self.width, self.height);
        let start = (y as usize * self.width as usize + x as usize) * 4;
        [self.rgba[start], self.rgba[start + 1], self.rgba[start + 2], self.rgba[start + 3]]
    }

    /// Mixes a colour (sRGB bytes) into a pixel, with the weight `amount`, 0..=255. Ignores pixels outside the
    /// picture.
    pub(crate) fn blend(&mut self, x: i32, y: i32, srgb: [u8; 3], amount: u8) {
        if x < 0 || y < 0 || x >= self.width as i32 || y >= self.height as i32 {
            return;
        }
        let start = (y as usize * self.width as usize + x as usize) * 4;
        for (channel, &wanted) in self.rgba[start..start + 3].iter_mut().zip(&srgb) {
            let mixed =
                u32::from(*channel) * (255 - u32::from(amount)) + u32::from(wanted) * u32::from(amount);
            *channel = ((mixed + 127) / 255) as u8;
        }
    }
}
