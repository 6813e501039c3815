//! The 255 colours that best represent a frame: boxes in colour space, split along their widest axis.

/// Bits kept of each channel: boxes and look-ups work on 2¹⁸ cells of colour.
const BITS: u32 = 6;
const CELLS: usize = 1 << (3 * BITS);
const NO_ENTRY: u8 = 255;

/// A palette of up to 255 colours and, for each cell of colour, the nearest palette entry. Uses integers only.
pub(super) struct Palette {
    /// Colours of the entries, sRGB.
    pub(super) colors: Vec<[u8; 3]>,
    /// Nearest entry per cell; [`NO_ENTRY`] if no colour of the cell was requested yet.
    nearest: Vec<u8>,
}

/// Histogram of the colours: number of pixels in each cell.
pub(super) struct Histogram {
    counts: Vec<u32>,
    occupied: Vec<u32>,
}

/// Cells of similar colour that share one entry.
struct ColorBox {
    first: usize,
    last: usize,
    /// Channel along which the colours vary most.
    axis: usize,
    /// Sum of squared distances from the mean along `axis`.
    spread: u64,
    mean: [u8; 3],
}

fn cell(color: [u8; 3]) -> usize {
    let [r, g, b] = color.map(|channel| (channel >> (8 - BITS)) as usize);
    r << (2 * BITS) | g << BITS | b
}

/// Returns the colour at the centre of a cell.
fn color_of(cell: u32) -> [u8; 3] {
    let mask = (1 << BITS) - 1;
    [cell >> (2 * BITS), cell >> BITS, cell].map(|part| {
        let channel = (part & mask) as u8;
        channel << (8 - BITS) | channel >> (2 * BITS - 8)
    })
}

impl Histogram {
    pub(super) fn new() -> Self {
        Self { counts: vec![0; CELLS], occupied: Vec::new() }
    }

    pub(super) fn add(&mut self, color: [u8; 3]) {
        let cell = cell(color);
        if self.counts[cell] == 0 {
            self.occupied.push(cell as u32);
        }
        self.counts[cell] += 1;
    }

    /// Clears the counts.
    pub(super) fn clear(&mut self) {
        for &cell in &self.occupied {
            self.counts[cell as usize] = 0;
        }
        self.occupied.clear();
    }

    /// Returns at most `limit` boxes: the box with the largest spread is split at its mean until there are enough
    /// (after Heckbert, "Color Image Quantization for Frame Buffer Display", 1982, with Wu's choice of the box by
    /// variance).
    fn split(&mut self, limit: usize) -> Vec<ColorBox> {
        // Sorts the cells, so that the boxes depend on the colours alone, not on their order of occurrence.
        self.occupied.sort_unstable();
        let mut boxes = vec![ColorBox::around(&self.occupied, &self.counts, 0, self.occupied.len())];
        while boxes.len() < limit {
            let widest = (0..boxes.len()).rev().max_by_key(|&i| boxes[i].spread).unwrap_or(0);
            let ColorBox { first, last, axis, spread, mean } = boxes[widest];
            if spread == 0 {
                break;
            }
            let cells = &mut self.occupied[first..last];
            cells.sort_unstable_by_key(|&cell| (color_of(cell)[axis], cell));
            let low = cells.partition_point(|&cell| color_of(cell)[axis] <= mean[axis]);
            let middle = first + low.clamp(1, last - first - 1);
            boxes[widest] = ColorBox::around(&self.occupied, &self.counts, first, middle);
            boxes.push(ColorBox::around(&self.occupied, &self.counts, middle, last));
        }
        boxes
    }
}

impl ColorBox {
    fn around(occupied: &[u32], counts: &[u32], first: usize, last: usize) -> Self {
        let (mut weight, mut sum, mut squares) = (0u64, [0u64; 3], [0u64; 3]);
        for &cell in &occupied[first..last] {
            let count = u64::from(counts[cell as usize]);
            weight += count;
            for (axis, channel) in color_of(cell).into_iter().enumerate() {
                sum[axis] += count * u64::from(channel);
                squares[axis] += count * u64::from(channel) * u64::from(channel);
            }
        }
        let weight = weight.max(1);
        // The eye is most sensitive to green and least to blue.
        let spread = |axis: usize| [3, 5, 2][axis] * (squares[axis] - sum[axis] * sum[axis] / weight);
        let axis = (0..3).rev().max_by_key(|&axis| spread(axis)).unwrap_or(1);
        let mean = sum.map(|sum| ((sum + weight / 2) / weight) as u8);
        let spread = if last - first < 2 { 0 } else { spread(axis) };
        Self { first, last, axis, spread, mean }
    }
}

impl Palette {
    pub(super) fn new() -> Self {
        Self { colors: Vec::new(), nearest: vec![NO_ENTRY; CELLS] }
    }

    /// Chooses the colours for a histogram; black alone for an empty one.
    pub(super) fn fit(&mut self, histogram: &mut Histogram) {
        self.colors.clear();
        self.colors.extend(histogram.split(NO_ENTRY as usize).iter().map(|part| part.mean));
        self.nearest.fill(NO_ENTRY);
    }

    /// Returns the entry nearest to a colour, to the precision of a cell.
    pub(super) fn entry(&mut self, color: [u8; 3]) -> u8 {
        let cell = cell(color);
        if self.nearest[cell] == NO_ENTRY {
            let wanted = color_of(cell as u32);
            let nearest = (0..self.colors.len()).min_by_key(|&i| distance(self.colors[i], wanted));
            self.nearest[cell] = nearest.unwrap_or(0) as u8;
        }
        self.nearest[cell]
    }
}

fn distance(a: [u8; 3], b: [u8; 3]) -> u32 {
    let square = |i: usize| u32::from(a[i].abs_diff(b[i])) * u32::from(a[i].abs_diff(b[i]));
    3 * square(0) + 5 * square(1) + 2 * square(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn image_of_few_colours_keeps_them() {
        let mut histogram = Histogram::new();
        let wanted = [[0, 0, 0], [255, 255, 255], [200, 16, 40]];
        for (i, &color) in wanted.iter().enumerate() {
            (0..=1000 * i).for_each(|_| histogram.add(color));
        }
        let mut palette = Palette::new();
        palette.fit(&mut histogram);
        for color in wanted {
            let entry = palette.entry(color);
            let shown = palette.colors[entry as usize];
            assert!(distance(shown, color) <= 3 * 9 + 5 * 9 + 2 * 9, "{color:?} is shown as {shown:?}");
        }
    }

    #[test]
    fn a_gradient_gets_evenly_spread_entries() {
        let mut histogram = Histogram::new();
        for i in 0..=255u8 {
            histogram.add([i, i, 255 - i]);
        }
        let mut palette = Palette::new();
        palette.fit(&mut histogram);
        for i in 0..=255u8 {
            let entry = palette.entry([i, i, 255 - i]);
            let shown = palette.colors[entry as usize];
            assert!(shown[0].abs_diff(i) <= 3, "{i} became {shown:?}");
        }
        histogram.clear();
        palette.fit(&mut histogram);
        assert_eq!(palette.entry([9, 9, 9]), 0);
    }
}
