//! Decodes PNG and JPEG pictures to RGBA.

use sinew_anim::TextureImage;
use std::io::Cursor;
use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Largest width and height of a picture, pixels.
const MAX_SIDE: usize = 4096;

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";
const JPEG: &[u8] = b"\xff\xd8\xff";

/// Decodes a PNG or JPEG to RGBA, within the limits of side and of `budget` bytes.
pub(crate) fn decode_picture(bytes: &[u8], budget: usize) -> Result<TextureImage, String> {
    let image = match bytes {
        _ if bytes.starts_with(PNG) => png(bytes, budget)?,
        _ if bytes.starts_with(JPEG) => jpeg(bytes, budget)?,
        _ => return Err("neither PNG nor JPEG".into()),
    };
    let expected = image.width as usize * image.height as usize * 4;
    if image.rgba.len() != expected {
        return Err(format!("{} bytes of pixels in place of {expected}", image.rgba.len()));
    }
    Ok(image)
}

fn png(bytes: &[u8], budget: usize) -> Result<TextureImage, String> {
    let limits = png::Limits { bytes: budget };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|e| one_line(&e))?;
    let (width, height) = (reader.info().width, reader.info().height);
    bounded(width as usize, height as usize, budget)?;
    let mut pixels = vec![0; reader.output_buffer_size().ok_or("too large")?];
    let frame = reader.next_frame(&mut pixels).map_err(|e| one_line(&e))?;
    pixels.truncate(frame.buffer_size());
    let rgba = match frame.color_type {
        png::ColorType::Rgba => pixels,
        png::ColorType::Rgb => rgb_as_rgba(&pixels),
        png::ColorType::GrayscaleAlpha => {
            pixels.chunks_exact(2).flat_map(|p| [p[0], p[0], p[0], p[1]]).collect()
        }
        png::ColorType::Grayscale => pixels.iter().flat_map(|&p| [p, p, p, 255]).collect(),
        // The decoder expands palettes to another format.
        png::ColorType::Indexed => return Err("a palette that cannot be read".into()),
    };
    Ok(TextureImage { width, height, rgba })
}

fn jpeg(bytes: &[u8], budget: usize) -> Result<TextureImage, String> {
    let options = DecoderOptions::default().set_strict_mode(false);
    let mut decoder = JpegDecoder::new_with_options(Cursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| one_line(&e))?;
    let (width, height) = decoder.dimensions().ok_or("no size")?;
    bounded(width, height, budget)?;
    // The JPEG decoder must not output RGBA: without intrinsics it copies the first byte to the fourth.
    decoder.set_options(options.jpeg_set_out_colorspace(ColorSpace::RGB));
    let rgba = rgb_as_rgba(&decoder.decode().map_err(|e| one_line(&e))?);
    Ok(TextureImage { width: width as u32, height: height as u32, rgba })
}

/// Checks the size before memory of the picture's size is allocated.
fn bounded(width: usize, height: usize, budget: usize) -> Result<(), String> {
    if width > MAX_SIDE || height > MAX_SIDE {
        return Err(format!("{width} x {height} pixels, more than {MAX_SIDE} a side"));
    }
    if width * height * 4 > budget {
        return Err(format!("{width} x {height} pixels, more than all pictures of a file may take"));
    }
    Ok(())
}

fn rgb_as_rgba(pixels: &[u8]) -> Vec<u8> {
    pixels.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect()
}

fn one_line(error: &dyn core::fmt::Display) -> String {
    error.to_string().lines().next().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use png::{BitDepth, ColorType};

    /// 8 × 8 pixels of (200, 40, 20) in colour, of 90 in grey, as JPEGs.
    const RED: &str = "\
         ffd8ffe000104a46494600010100000100010000ffdb00430002010101010102010101020202020204030202020205040403\
         04060506060605060606070908060709070606080b08090a0a0a0a0a06080b0c0b0a0c090a0a0affdb004301020202020202\
         050303050a0706070a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a0a\
         0a0a0a0a0a0a0a0affc00011080008000803012200021101031101ffc4001500010100000000000000000000000000000008\
         ffc40014100100000000000000000000000000000000ffc4001501010100000000000000000000000000000809ffc4001411\
         0100000000000000000000000000000000ffda000c03010002110311003f0095c01ad521ffd9";
    const GREY: &str = "\
         ffd8ffe000104a46494600010100000100010000ffdb00430002010101010102010101020202020204030202020205040403\
         04060506060605060606070908060709070606080b08090a0a0a0a0a06080b0c0b0a0c090a0a0affc0000b08000800080101\
         1100ffc40014000100000000000000000000000000000008ffc40014100100000000000000000000000000000000ffda0008\
         010100003f0033bfffd9";

    fn bytes(hex: &str) -> Vec<u8> {
        (0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()).collect()
    }

    /// Encodes one row of two pixels.
    fn written(color: ColorType, depth: BitDepth, palette: Option<&[u8]>, data: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, 2, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if let Some(palette) = palette {
            encoder.set_palette(palette.to_vec());
        }
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(data).unwrap();
        writer.finish().unwrap();
        out
    }

    #[test]
    fn every_kind_of_png_decodes_to_rgba() {
        let (eight, sixteen) = (BitDepth::Eight, BitDepth::Sixteen);
        type Case = (ColorType, BitDepth, Option<&'static [u8]>, &'static [u8], [u8; 8]);
        let cases: &[Case] = &[
            (ColorType::Rgba, eight, None, &[1, 2, 3, 4, 5, 6, 7, 8], [1, 2, 3, 4, 5, 6, 7, 8]),
            (ColorType::Rgb, eight, None, &[1, 2, 3, 5, 6, 7], [1, 2, 3, 255, 5, 6, 7, 255]),
            (ColorType::Grayscale, eight, None, &[9, 8], [9, 9, 9, 255, 8, 8, 8, 255]),
            (ColorType::Grayscale, BitDepth::One, None, &[0b0100_0000], [0, 0, 0, 255, 255, 255, 255, 255]),
            (ColorType::GrayscaleAlpha, eight, None, &[9, 1, 8, 2], [9, 9, 9, 1, 8, 8, 8, 2]),
            (ColorType::Indexed, eight, Some(&[1, 2, 3, 4, 5, 6]), &[1, 0], [4, 5, 6, 255, 1, 2, 3, 255]),
            (ColorType::Grayscale, sixteen, None, &[9, 0, 8, 0], [9, 9, 9, 255, 8, 8, 8, 255]),
        ];
        for (color, depth, palette, data, expected) in cases {
            let image = decode_picture(&written(*color, *depth, *palette, data), 1000).unwrap();
            assert_eq!(
                (image.width, image.height, &image.rgba[..]),
                (2, 1, &expected[..]),
                "{color:?} {depth:?}"
            );
        }
    }

    #[test]
    fn colour_and_grey_jpegs_decode_to_rgba() {
        for (hex, expected) in [(RED, [200, 40, 20, 255]), (GREY, [90, 90, 90, 255])] {
            let image = decode_picture(&bytes(hex), 1000).unwrap();
            assert_eq!((image.width, image.height), (8, 8));
            let is_near = |pixel: &[u8]| pixel.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 4);
            assert!(image.rgba.chunks_exact(4).all(is_near), "{:?}", &image.rgba[..4]);
        }
    }

    #[test]
    fn oversized_and_invalid_pictures_are_rejected() {
        let refused = |bytes: &[u8], budget| decode_picture(bytes, budget).unwrap_err();
        assert_eq!(refused(&bytes(RED), 255), "8 x 8 pixels, more than all pictures of a file may take");
        assert_eq!(refused(b"BM", 1000), "neither PNG nor JPEG");
        // The header claims a width of 5000 pixels.
        let mut wide = bytes(RED);
        let frame = wide.windows(2).position(|two| two == [0xff, 0xc0]).unwrap();
        wide[frame + 7..frame + 9].copy_from_slice(&5000_u16.to_be_bytes());
        assert_eq!(refused(&wide, 1 << 30), "5000 x 8 pixels, more than 4096 a side");
        let png = written(ColorType::Grayscale, BitDepth::Eight, None, &[9, 8]);
        assert!(decode_picture(&png[..20], 1000).is_err());
        assert!(decode_picture(&bytes(RED)[..100], 1000).is_err());
    }
}
