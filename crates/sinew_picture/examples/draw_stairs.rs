//! Draws a character on stairs: `cargo run --release -p sinew_picture --example draw_stairs -- DIR` writes `stairs.png`
//! and a movie as `stairs.gif` there, and prints the times.

#[path = "../tests/it/stairs.rs"]
mod stairs;

use sinew_picture::{FollowCamera, Movie, PictureFormat, RenderSettings, Renderer, encode};
use std::error::Error;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const FPS: u32 = 25;
const FRAMES: u32 = 75;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    let threads = std::thread::available_parallelism()?.get();
    let mut renderer = Renderer::new(RenderSettings { threads, ..RenderSettings::default() });
    let still = renderer.render(&stairs::scene(0.9), &stairs::camera(0.9));
    std::fs::write(folder.join("stairs.png"), encode::encode(PictureFormat::Png, &[still], FPS)?)?;

    let start = stairs::camera(0.0);
    let mut follow = FollowCamera::new(stairs::hips(0.0), 1.5, start.position - start.target);
    let mut movie = Movie::new(PictureFormat::Gif, FPS);
    let (mut rendering, mut encoding) = (Duration::ZERO, Duration::ZERO);
    for frame in 0..FRAMES {
        let time = frame as f32 / FPS as f32;
        follow.update(stairs::hips(time), 1.0 / FPS as f32);
        let before = Instant::now();
        let image = renderer.render(&stairs::scene(time), &follow.camera());
        rendering += before.elapsed();
        let before = Instant::now();
        movie.push(&image)?;
        encoding += before.elapsed();
    }
    let bytes = movie.finish()?;
    println!(
        "{FRAMES} frames: {:.1} ms a frame to draw, {:.1} ms to encode, {} bytes a frame",
        rendering.as_secs_f64() * 1e3 / f64::from(FRAMES),
        encoding.as_secs_f64() * 1e3 / f64::from(FRAMES),
        bytes.len() / FRAMES as usize
    );
    std::fs::write(folder.join("stairs.gif"), bytes)?;
    Ok(())
}
