//! Pictures have the same bytes in every build, on every target, with any number of threads.

use crate::stairs;
use sinew::math::hash::hash_bytes;
use sinew_picture::{PictureFormat, RenderSettings, Renderer, encode};

const SMALL: RenderSettings = RenderSettings {
    width: 320,
    height: 180,
    antialiasing: sinew_picture::Antialiasing::Samples4,
    shadow_texels: 512,
    threads: 1,
};

#[test]
fn picture_of_the_stairs_has_the_recorded_hash() {
    let image = Renderer::new(SMALL).render(&stairs::scene(0.9), &stairs::camera(0.9));
    assert_eq!(format!("{:016x}", hash_bytes(&image.rgba)), "6e72deddc73c4ef1");
}

#[test]
fn movie_of_the_stairs_has_the_recorded_hash() {
    let mut renderer = Renderer::new(SMALL);
    let images = [0.0, 0.04, 0.08].map(|time| renderer.render(&stairs::scene(time), &stairs::camera(time)));
    let bytes = encode::encode(PictureFormat::Gif, &images, 25).expect("three images");
    assert_eq!(format!("{:016x}", hash_bytes(&bytes)), "774c0cd0c5de09f8");
}

#[test]
fn picture_is_independent_of_threads_and_earlier_pictures() {
    let scene = stairs::scene(0.5);
    let camera = stairs::camera(0.5);
    let alone = Renderer::new(SMALL).render(&scene, &camera);
    for threads in [2, 3, 7] {
        let mut renderer = Renderer::new(RenderSettings { threads, ..SMALL });
        renderer.render(&stairs::scene(1.4), &stairs::camera(0.1));
        assert!(renderer.render(&scene, &camera) == alone, "{threads} threads");
    }
}
