//! Sheets of many pictures.

use super::Row;
use anyhow::{Context, Result, ensure};
use std::fs;
use std::io::{BufReader, BufWriter};
use std::path::Path;

/// Size of a picture, pixels.
pub const SIZE: [usize; 2] = [480, 300];
/// Number of pictures on a sheet, across and down.
const GRID: [usize; 2] = [3, 3];
/// Bytes of a pixel.
const RGB: usize = 3;

/// Writes sheet-1.png and so on, in the order of the rows, each picture with its file's name.
///
/// # Errors
/// If a picture cannot be read, or a sheet cannot be written.
pub fn write(rows: &[Row], out: &Path) -> Result<()> {
    let drawn: Vec<&Row> = rows.iter().filter(|row| row.report["refused"].is_null()).collect();
    for (number, rows) in drawn.chunks(GRID[0] * GRID[1]).enumerate() {
        let mut pixels = vec![0; GRID[0] * SIZE[0] * GRID[1] * SIZE[1] * RGB];
        for (index, row) in rows.iter().enumerate() {
            let picture = read(&row.picture).with_context(|| row.picture.display().to_string())?;
            place(&picture, [index % GRID[0], index / GRID[0]], &mut pixels);
        }
        let path = out.join(format!("sheet-{}.png", number + 1));
        save(&path, &pixels).with_context(|| path.display().to_string())?;
        let files: Vec<&str> = rows.iter().map(|row| row.file.as_str()).collect();
        eprintln!("{}: {}", path.display(), files.join(", "));
    }
    Ok(())
}

/// Copies a picture into a cell of the sheet.
fn place(picture: &[u8], cell: [usize; 2], sheet: &mut [u8]) {
    let (line, width) = (SIZE[0] * RGB, GRID[0] * SIZE[0] * RGB);
    for (y, row) in picture.chunks_exact(line).enumerate() {
        let at = (cell[1] * SIZE[1] + y) * width + cell[0] * line;
        sheet[at..at + line].copy_from_slice(row);
    }
}

fn read(path: &Path) -> Result<Vec<u8>> {
    let mut decoder = png::Decoder::new(BufReader::new(fs::File::open(path)?));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info()?;
    let mut pixels = vec![0; reader.output_buffer_size().context("too large")?];
    let info = reader.next_frame(&mut pixels)?;
    ensure!([info.width as usize, info.height as usize] == SIZE, "{} × {} pixels", info.width, info.height);
    pixels.truncate(info.buffer_size());
    Ok(match info.color_type {
        png::ColorType::Rgb => pixels,
        png::ColorType::Rgba => {
            pixels.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
        }
        other => anyhow::bail!("{other:?} pixels"),
    })
}

fn save(path: &Path, pixels: &[u8]) -> Result<()> {
    let [width, height] = [0, 1].map(|axis| (GRID[axis] * SIZE[axis]) as u32);
    let mut encoder = png::Encoder::new(BufWriter::new(fs::File::create(path)?), width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_form_a_grid() {
        let mut sheet = vec![0; GRID[0] * SIZE[0] * GRID[1] * SIZE[1] * RGB];
        place(&vec![7; SIZE[0] * SIZE[1] * RGB], [1, 2], &mut sheet);
        let at = |x: usize, y: usize| sheet[(y * GRID[0] * SIZE[0] + x) * RGB];
        assert_eq!([at(SIZE[0], 2 * SIZE[1]), at(2 * SIZE[0] - 1, 3 * SIZE[1] - 1)], [7, 7]);
        assert_eq!(
            [at(SIZE[0] - 1, 2 * SIZE[1]), at(2 * SIZE[0], 2 * SIZE[1]), at(SIZE[0], 2 * SIZE[1] - 1)],
            [0; 3]
        );
    }
}
