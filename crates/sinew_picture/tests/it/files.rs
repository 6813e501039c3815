//! Encoded files read back by common decoders.

use crate::stairs;
use sinew_picture::{EncodeError, Image, PictureFormat, RenderSettings, Renderer, encode};
use std::io::Cursor;

const FPS: u32 = 30;

/// Returns frames with movement, a repeated frame, one pixel of difference, and odd sides.
fn frames() -> Vec<Image> {
    let settings = RenderSettings { width: 161, height: 91, shadow_texels: 256, ..RenderSettings::default() };
    let mut renderer = Renderer::new(settings);
    let mut images: Vec<Image> =
        [0.0, 0.1, 0.2].map(|t| renderer.render(&stairs::scene(t), &stairs::camera(0.0))).to_vec();
    images.push(images[2].clone());
    let mut dot = images[2].clone();
    let last = dot.rgba.len() - 4;
    dot.rgba[last..].copy_from_slice(&[255, 0, 128, 255]);
    images.push(dot);
    images
}

fn rgb(image: &Image) -> Vec<u8> {
    image.rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect()
}

fn encoded(format: PictureFormat, images: &[Image]) -> Vec<u8> {
    encode::encode(format, images, FPS).expect("images of one size")
}

#[test]
fn a_still_png_and_webp_are_exact() {
    let image = &frames()[0];
    let png = encoded(PictureFormat::Png, core::slice::from_ref(image));
    let mut reader = png::Decoder::new(Cursor::new(png)).read_info().expect("PNG");
    assert!(reader.info().animation_control.is_none());
    let mut pixels = vec![0; reader.output_buffer_size().expect("the number fits")];
    reader.next_frame(&mut pixels).expect("pixels");
    assert!(pixels == rgb(image));

    let webp = encoded(PictureFormat::WebP, core::slice::from_ref(image));
    let mut decoder = image_webp::WebPDecoder::new(Cursor::new(webp)).expect("WebP");
    assert!(!decoder.is_animated() && decoder.dimensions() == (161, 91));
    let mut pixels = vec![0; decoder.output_buffer_size().expect("the number fits")];
    decoder.read_image(&mut pixels).expect("pixels");
    assert!(pixels == rgb(image));
}

#[test]
fn an_apng_is_exact_once_put_together() {
    let images = frames();
    let file = encoded(PictureFormat::Png, &images);
    let mut reader = png::Decoder::new(Cursor::new(file)).read_info().expect("PNG");
    assert_eq!(reader.info().animation_control.map(|a| (a.num_frames, a.num_plays)), Some((5, 0)));
    let mut canvas = vec![0; 161 * 91 * 3];
    for (number, image) in images.iter().enumerate() {
        let mut pixels = vec![0; reader.output_buffer_size().expect("the number fits")];
        reader.next_frame(&mut pixels).expect("frame");
        let control = *reader.info().frame_control().expect("animated");
        assert_eq!((control.delay_num, u32::from(control.delay_den)), (1, FPS));
        let [left, width] = [control.x_offset, control.width].map(|x| x as usize * 3);
        for (row, line) in pixels.chunks_exact(width).take(control.height as usize).enumerate() {
            let start = (control.y_offset as usize + row) * 161 * 3 + left;
            canvas[start..start + width].copy_from_slice(line);
        }
        assert!(canvas == rgb(image), "frame {number}");
        assert!(number < 3 || control.width * control.height == 1);
    }
}

#[test]
fn an_animated_webp_is_exact_and_keeps_time() {
    let images = frames();
    let mut decoder =
        image_webp::WebPDecoder::new(Cursor::new(encoded(PictureFormat::WebP, &images))).expect("WebP");
    assert!(decoder.is_animated());
    assert_eq!((decoder.num_frames(), decoder.dimensions()), (5, (161, 91)));
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let mut milliseconds = 0;
    for (number, image) in images.iter().enumerate() {
        let mut pixels = vec![0; decoder.output_buffer_size().expect("the number fits")];
        milliseconds += decoder.read_frame(&mut pixels).expect("frame");
        let shown: Vec<u8> = pixels.chunks_exact(channels).flat_map(|p| [p[0], p[1], p[2]]).collect();
        assert!(shown == rgb(image), "frame {number}");
    }
    assert_eq!(milliseconds, 167);
}

#[test]
fn a_gif_looks_like_its_images_and_keeps_time() {
    let images = frames();
    let file = encoded(PictureFormat::Gif, &images);
    let mut decoder = gif::DecodeOptions::new().read_info(Cursor::new(file)).expect("GIF");
    assert_eq!((decoder.width(), decoder.height(), decoder.repeat()), (161, 91, gif::Repeat::Infinite));
    let mut canvas = vec![[0u8; 3]; 161 * 91];
    let mut delays = Vec::new();
    for (number, image) in images.iter().enumerate() {
        let frame = decoder.read_next_frame().expect("frame").expect("as many frames as images");
        delays.push(frame.delay);
        let palette = frame.palette.as_deref().expect("each frame has its own");
        for (i, &index) in frame.buffer.iter().enumerate() {
            let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
            if Some(index) != frame.transparent {
                let place = (usize::from(frame.top) + y) * 161 + usize::from(frame.left) + x;
                canvas[place].copy_from_slice(&palette[usize::from(index) * 3..][..3]);
            }
        }
        let errors = canvas.as_flattened().iter().zip(rgb(image)).map(|(&a, b)| f64::from(a.abs_diff(b)));
        let squares: Vec<f64> = errors.map(|error| error * error).collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!(rms < 3.5, "frame {number}: {rms}");
    }
    assert!(decoder.read_next_frame().expect("end").is_none());
    assert_eq!(delays, [3, 4, 3, 3, 4]);
}

#[test]
fn unencodable_pictures_are_errors() {
    let image = Image::filled(4, 3, [9, 8, 7, 255]);
    let other = Image::filled(3, 4, [9, 8, 7, 255]);
    for format in [PictureFormat::Gif, PictureFormat::Png, PictureFormat::WebP] {
        assert!(matches!(encode::encode(format, &[], 25), Err(EncodeError::Empty)));
        let sizes = encode::encode(format, &[image.clone(), other.clone()], 25);
        assert!(matches!(sizes, Err(EncodeError::Size { first: (4, 3), other: (3, 4) })));
        let torn = Image { height: 4, ..image.clone() };
        assert!(matches!(encode::encode(format, &[torn], 25), Err(EncodeError::Malformed { .. })));
        let nothing = Image::default();
        assert!(matches!(encode::encode(format, &[nothing], 25), Err(EncodeError::Malformed { .. })));
    }
    let long = Image::filled(16_384, 1, [0; 4]);
    let too_large = encode::encode(PictureFormat::WebP, core::slice::from_ref(&long), 25);
    assert!(matches!(too_large, Err(EncodeError::TooLarge { most: 16_383, .. })));
    assert!(encode::encode(PictureFormat::Gif, &[long], 25).is_ok());
}

#[test]
fn the_file_name_selects_the_format() {
    for (extension, format) in [
        ("gif", Some(PictureFormat::Gif)),
        ("PNG", Some(PictureFormat::Png)),
        ("apng", Some(PictureFormat::Png)),
        ("WebP", Some(PictureFormat::WebP)),
        ("jpeg", None),
        ("", None),
    ] {
        assert_eq!(PictureFormat::from_extension(extension), format);
    }
}
