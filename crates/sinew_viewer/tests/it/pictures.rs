//! Pictures by the GPU compared with pictures by the processor, which need no driver.

use sinew::math::{Rotation, Transform, Vec3};
use sinew::physics::{Hull, Shape};
use sinew_picture::world::Canvas;
use sinew_picture::{
    Camera, Image, Line, LineDepth, Model, PictureFormat, RenderMaterial, RenderSettings, Scene, Sun,
    Texture, draw, encode,
};
use sinew_viewer::{Gpu, Offscreen, Session, Stage, Subject, stage};
use std::sync::Arc;

const SIZE: [u32; 2] = [480, 270];

/// Returns a device, or prints why there is none.
pub fn gpu() -> Option<Gpu> {
    match Gpu::open() {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}

/// Returns the mean difference of two pictures over all channels, and the share of pixels that differ by more than 40 in one.
fn difference(a: &Image, b: &Image) -> (f64, f64) {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let sum: u64 = a.rgba.iter().zip(&b.rgba).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    let far = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 40);
    let pixels = a.rgba.chunks_exact(4).zip(b.rgba.chunks_exact(4));
    let count = pixels.filter(|&pair| far(pair)).count();
    (sum as f64 / a.rgba.len() as f64, count as f64 / (a.rgba.len() / 4) as f64)
}

/// Writes a picture to the folder of `SINEW_LOOK`, if it is set.
pub fn look(name: &str, image: &Image) {
    if let Some(folder) = std::env::var_os("SINEW_LOOK") {
        let bytes = encode::encode(PictureFormat::Png, std::slice::from_ref(image), 1)
            .expect("the picture can be encoded");
        std::fs::write(std::path::Path::new(&folder).join(format!("{name}.png")), bytes)
            .expect("the folder exists");
    }
}

/// Paints all shapes, a textured and a translucent surface, lines in front and behind, on a checkered floor.
pub fn paint(canvas: &mut dyn Canvas) {
    let corners = [[0.0; 3], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], [0.1, 0.6, 0.1]].map(Vec3::from_array);
    let shapes = [
        Shape::Box { half_extents: Vec3::new(0.3, 0.2, 0.25) },
        Shape::Sphere { radius: 0.3 },
        Shape::Capsule { half_height: 0.2, radius: 0.15 },
        Shape::TaperedCapsule { half_height: 0.2, radius_bottom: 0.2, radius_top: 0.1 },
        Shape::Cylinder { half_height: 0.3, radius: 0.2 },
        Shape::Cone { half_height: 0.3, radius: 0.25 },
        Shape::Hull(Arc::new(Hull::new(&corners).expect("a solid"))),
    ];
    for (i, shape) in shapes.iter().enumerate() {
        let place = Transform::new(
            Vec3::new(0.75 * i as f32 - 2.3, 0.4, 0.2 * (i % 2) as f32),
            Rotation::from_axis_angle(Vec3::new(1.0, 2.0, 0.5).normalize(), 0.4 * i as f32),
        );
        let hue = i as f32 / 7.0;
        canvas.solid(shape, place, [0.2 + 0.6 * hue, 0.5 - 0.4 * hue, 0.15 + 0.3 * hue]);
    }
    canvas.ball(
        0.25,
        Transform::new(Vec3::new(-1.2, 0.25, 1.1), Rotation::from_axis_angle(Vec3::X, 0.6)),
        [0.7, 0.1, 0.1],
    );
    canvas.rod(Vec3::new(-0.5, 0.1, 1.2), Vec3::new(0.6, 0.5, 0.9), 0.05, [0.1, 0.1, 0.4]);
    canvas.model(draw::floor(Vec3::ZERO, 20.0, [0.34, 0.36, 0.38], [0.27, 0.29, 0.31]));
    let texels =
        (0..64u8).flat_map(|i| [if (i / 8 + i) % 2 == 0 { 230 } else { 40 }, 90, 4 * i, 255]).collect();
    let texture = Arc::new(Texture::new(8, 8, texels).expect("64 texels"));
    canvas.model(Model {
        positions: [[1.2, 0.05, 1.4], [2.2, 0.05, 1.0], [2.2, 0.9, 0.8], [1.2, 0.9, 1.2]]
            .map(Vec3::from_array)
            .to_vec(),
        uvs: [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]].map(sinew::math::Vec2::from_array).to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
        material: RenderMaterial { texture: Some(texture), ..RenderMaterial::new([1.0; 3]) },
        ..Model::default()
    });
    let glass = RenderMaterial { opacity: 0.4, ..RenderMaterial::new([0.1, 0.5, 0.8]) };
    let pane = Transform::from_translation(Vec3::new(-2.0, 0.5, 1.5));
    canvas.model(draw::shape(&Shape::Box { half_extents: Vec3::new(0.4, 0.5, 0.02) }, pane, glass));
    for (y, depth) in [(0.35, LineDepth::OnTop), (0.55, LineDepth::Tested)] {
        let (from, to) = (Vec3::new(-3.0, y, -0.3), Vec3::new(3.0, y, -0.3));
        canvas.line(Line { from, to, color: [0.9, 0.8, 0.0], depth });
    }
}

pub fn camera() -> Camera {
    Camera { position: Vec3::new(0.8, 2.1, 5.2), target: Vec3::new(0.0, 0.4, 0.2), fov_y: 0.7 }
}

#[test]
fn gpu_and_cpu_draw_the_same_picture() {
    let Some(gpu) = gpu() else { return };
    let sun = Sun { shadow_radius: 4.0, ..Sun::default() };
    let mut scene = Scene { sun, ..Scene::default() };
    paint(&mut scene);
    let settings =
        RenderSettings { width: SIZE[0], height: SIZE[1], shadow_texels: 2048, ..RenderSettings::default() };
    let expected = sinew_picture::Renderer::new(settings).render(&scene, &camera());
    let mut stage = Stage::of(Scene { sun, ..Scene::default() });
    paint(&mut stage);
    let mut offscreen = Offscreen::new(gpu, SIZE);
    let found = offscreen.render(&stage, &camera()).expect("the card draws");
    look("card", &found);
    look("processor", &expected);
    // Edges and the borders of shadows are smoothed differently.
    let (mean, far) = difference(&expected, &found);
    println!("mean difference {mean:.3} of 255, {:.2} % of pixels far off", 100.0 * far);
    assert!(mean < 3.0 && far < 0.02, "mean difference {mean}, share of pixels far off {far}");
    // The test can fail: the pictures without shapes and without shadows differ.
    let bare = offscreen.render(&Stage::of(Scene { sun, ..Scene::default() }), &camera());
    assert!(difference(&expected, &bare.expect("the card draws")).0 > 10.0);
    let again = offscreen.render(&stage, &camera()).expect("the card draws");
    assert_eq!(again, found, "the same stage must give the same picture");
}

#[test]
fn skin_is_drawn_at_its_joints() {
    let Some(gpu) = gpu() else { return };
    let subject = Subject::scene("two_tracks", &[]).expect("the scene exists");
    let mut session = Session::start(subject).expect("the scene can be opened");
    for _ in 0..40 {
        session.step();
    }
    let bounds = sinew_viewer::bounds(session.instance());
    let camera = Camera::framing_box(&bounds.expand(0.3), Vec3::new(0.4, 0.2, 1.0), 16.0 / 9.0);
    let stage = stage(&session, &camera, &[]);
    assert!(!stage.figures.is_empty(), "the scene has figures");
    let mut offscreen = Offscreen::new(gpu, SIZE);
    let found = offscreen.render(&stage, &camera).expect("the card draws");
    look("skin_card", &found);
    // The same characters as models skinned by the processor.
    let mut skinned = self::stage(&session, &camera, &[]);
    let figures = std::mem::take(&mut skinned.figures);
    for figure in &figures {
        for (mesh, of) in figure.rig.meshes.iter().enumerate() {
            for (part, primitive) in of.primitives.iter().enumerate() {
                let mut model = Model { indices: primitive.indices.clone(), ..Model::default() };
                let joints = figure.world_from_joint;
                sinew::anim::skin_vertices(
                    figure.rig,
                    mesh,
                    part,
                    joints,
                    &mut model.positions,
                    &mut model.normals,
                );
                let [r, g, b, _] = primitive.base_color;
                model.material = RenderMaterial::new([r, g, b]);
                model.colors = primitive.colors.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
                skinned.scene.models.push(model);
            }
        }
    }
    let expected = offscreen.render(&skinned, &camera).expect("the card draws");
    look("skin_processor", &expected);
    let (mean, far) = difference(&expected, &found);
    println!("mean difference {mean:.3} of 255, {:.2} % of pixels far off", 100.0 * far);
    assert!(mean < 0.5 && far < 0.002, "mean difference {mean}, share of pixels far off {far}");
    let mut empty = self::stage(&session, &camera, &[]);
    empty.figures.clear();
    let (mean, _) = difference(&offscreen.render(&empty, &camera).expect("the card draws"), &found);
    assert!(mean > 0.3, "without characters the picture must differ; mean difference {mean}");
}
