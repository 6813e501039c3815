//! Visible surfaces, against rays shot one by one and against hidden surfaces.

use sinew::math::{Random, Transform, Vec2, Vec3};
use sinew::physics::Shape;
use sinew_picture::draw;
use sinew_picture::{
    Antialiasing, Camera, Caption, Faces, Image, Line, LineDepth, Model, RenderMaterial, RenderSettings,
    Renderer, Scene, ShadowCasting, Sky, Sun, Texture,
};
use std::sync::Arc;

const WIDTH: u32 = 96;
const HEIGHT: u32 = 64;
const CAMERA: Camera = Camera { position: Vec3::ZERO, target: Vec3::NEG_Z, fov_y: 1.2 };

/// Returns a scene with equal light from all sides, and a white sky: a surface shows its own colour.
fn plain(models: Vec<Model>) -> Scene {
    // Surfaces get 0.55 of the sky's light, and all of the ground's.
    let sky = Sky { zenith: [1.0 / 0.55; 3], horizon: [1.0 / 0.55; 3], ground: [1.0; 3], haze_distance: 1e6 };
    let sun = Sun { color: [0.0; 3], ..Sun::default() };
    Scene { models, sky, sun, ..Scene::default() }
}

fn draw(scene: &Scene, antialiasing: Antialiasing) -> Image {
    let settings =
        RenderSettings { width: WIDTH, height: HEIGHT, antialiasing, shadow_texels: 64, threads: 1 };
    Renderer::new(settings).render(scene, &CAMERA)
}

fn triangle(points: [Vec3; 3], color: [f32; 3]) -> Model {
    Model {
        positions: points.to_vec(),
        indices: vec![0, 1, 2],
        material: RenderMaterial::new(color),
        ..Model::default()
    }
}

fn is_sky(image: &Image, x: u32, y: u32) -> bool {
    image.pixel(x, y)[..3] == [255, 255, 255]
}

/// Returns the ray through the centre of a pixel at depth 1, by the definition of a pinhole camera.
fn ray(x: u32, y: u32) -> Vec3 {
    let half = sinew::math::trig::tan(0.5 * CAMERA.fov_y);
    let across = (x as f32 + 0.5) / WIDTH as f32 * 2.0 - 1.0;
    let down = (y as f32 + 0.5) / HEIGHT as f32 * 2.0 - 1.0;
    Vec3::new(across * half * WIDTH as f32 / HEIGHT as f32, -down * half, -1.0)
}

/// Returns the depth at which a ray from the origin hits a triangle, and its least barycentric coordinate.
fn shoot(ray: Vec3, [a, b, c]: [Vec3; 3]) -> Option<(f32, f32)> {
    let normal = (b - a).cross(c - a);
    let depth = a.dot(normal) / ray.dot(normal);
    let at = ray * depth;
    let share = |p: Vec3, q: Vec3| (q - p).cross(at - p).dot(normal) / normal.dot(normal);
    let least = [share(a, b), share(b, c), share(c, a)].into_iter().fold(f32::INFINITY, sinew::math::min);
    (depth >= 0.05).then_some((depth, least))
}

#[test]
fn every_pixel_shows_the_nearest_triangle() {
    let mut random = Random::new(2);
    let mut disputed = 0;
    for _ in 0..40 {
        // Corners in front of, beside and behind the camera: many triangles cross the near plane.
        let mut corner =
            || Vec3::new(random.range(-4.0, 4.0), random.range(-4.0, 4.0), random.range(-6.0, 1.5));
        let triangles: Vec<[Vec3; 3]> = (0..12).map(|_| [corner(), corner(), corner()]).collect();
        let color = |i: usize| [(i + 1) as f32 / 13.0, 0.5, 1.0 - i as f32 / 13.0];
        let models = triangles.iter().enumerate().map(|(i, &points)| triangle(points, color(i))).collect();
        let image = draw(&plain(models), Antialiasing::Off);
        for (x, y) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
            let hits: Vec<(usize, f32, f32)> = triangles
                .iter()
                .enumerate()
                .filter_map(|(i, &points)| shoot(ray(x, y), points).map(|(depth, least)| (i, depth, least)))
                .collect();
            let nearest = hits.iter().filter(|hit| hit.2 >= 0.0).min_by(|a, b| a.1.total_cmp(&b.1));
            let shown = image.pixel(x, y);
            let agrees = match nearest {
                None => is_sky(&image, x, y),
                Some(&(i, ..)) => (f32::from(shown[2]) - srgb(color(i)[2])).abs() < 2.0,
            };
            // Within 1/256 pixel of an edge rounding decides, and at equal depths either triangle is right.
            let on_edge = hits.iter().any(|hit| hit.2.abs() < 2e-2);
            let tie =
                nearest.is_some_and(|n| hits.iter().any(|h| h.0 != n.0 && (h.1 / n.1 - 1.0).abs() < 1e-3));
            if !agrees {
                assert!(on_edge || tie, "pixel {x} {y}: drawn {shown:?}, ray hits {hits:?}");
                disputed += 1;
            }
        }
    }
    assert!(disputed < 40 * 30, "{disputed} pixels on edges differ");
}

fn srgb(linear: f32) -> f32 {
    255.0 * (1.055 * sinew::math::trig::pow(linear, 1.0 / 2.4) - 0.055)
}

#[test]
fn a_ground_of_many_triangles_has_no_hole() {
    let mut random = Random::new(8);
    let side = 24;
    // Jittered corners from far behind the camera to far in front of it.
    let mut model = triangle([Vec3::ZERO; 3], [0.5; 3]);
    model.positions = (0..side * side)
        .map(|i| {
            let [x, z] = [i % side, i / side].map(|k| (k as f32 - 11.5) * 3.0 + random.range(-0.9, 0.9));
            Vec3::new(x, -1.0, z)
        })
        .collect();
    model.indices = (0..side * side)
        .filter(|i| i % side < side - 1 && i / side < side - 1)
        .flat_map(|i| [i, i + side, i + 1, i + 1, i + side, i + side + 1].map(|v| v as u32))
        .collect();
    for antialiasing in [Antialiasing::Off, Antialiasing::Samples4] {
        let image = draw(&plain(vec![model.clone()]), antialiasing);
        let lit = image.pixel(WIDTH / 2, HEIGHT - 1);
        for (x, y) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
            // Rays that hit the ground within 30 m to each side.
            let at = ray(x, y) / -ray(x, y).y;
            if ray(x, y).y < -0.04 && at.x.abs() < 30.0 && at.z.abs() < 30.0 {
                assert_eq!(image.pixel(x, y), lit, "pixel {x} {y}");
            }
        }
    }
}

#[test]
fn smoothed_edges_show_the_share_that_is_covered() {
    // An upright edge at a quarter of the way through a column of pixels, at depth 1.
    let edge = ray(40, 0).x + 0.25 * (ray(41, 0).x - ray(40, 0).x);
    let far = 50.0;
    let points = [Vec3::new(edge, -far, -1.0), Vec3::new(edge + far, 0.0, -1.0), Vec3::new(edge, far, -1.0)];
    let image = draw(&plain(vec![triangle(points, [0.0; 3])]), Antialiasing::Samples4);
    assert!(is_sky(&image, 39, 32));
    assert_eq!(image.pixel(41, 32)[0], 0);
    let sky = f32::from(image.pixel(40, 32)[0]);
    assert!((sky - srgb(0.75)).abs() < 2.0, "{sky}");
}

#[test]
fn invalid_triangles_are_skipped() {
    let good = [Vec3::new(-1.0, -1.0, -3.0), Vec3::new(1.0, -1.0, -3.0), Vec3::new(0.0, 1.0, -3.0)];
    let expected = draw(&plain(vec![triangle(good, [0.5; 3])]), Antialiasing::Samples4);
    let mut models = vec![triangle(good, [0.5; 3]), Model::default()];
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, f32::MAX] {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            models.push(triangle([good[0], good[1], good[2] * 0.3 + axis * bad], [1.0; 3]));
        }
    }
    let mut dangling = triangle(good, [1.0; 3]);
    dangling.indices = vec![0, 1, 3, 7, 8];
    models.push(dangling);
    models.push(triangle([good[0]; 3], [1.0; 3]));
    models.push(Model {
        material: RenderMaterial { opacity: 0.0, ..RenderMaterial::default() },
        ..triangle(good.map(|p| p * 0.5), [1.0; 3])
    });
    let scene = plain(models);
    assert!(draw(&scene, Antialiasing::Samples4) == expected);
    let empty = draw(&plain(vec![]), Antialiasing::Samples4);
    assert!((0..WIDTH).all(|x| is_sky(&empty, x, 3)));
}

#[test]
fn extreme_cameras_lines_and_lights_do_not_panic() {
    let mut renderer = Renderer::new(RenderSettings { width: 1, height: 1, ..RenderSettings::default() });
    let mut scene =
        Scene { models: vec![draw::floor(Vec3::ZERO, 1e6, [0.5; 3], [0.2; 3])], ..Scene::default() };
    for bad in [f32::NAN, f32::INFINITY, 1e30, 0.0] {
        let to = Vec3::new(bad, -bad, bad);
        scene.lines.push(Line { from: Vec3::NEG_Z, to, color: [bad; 3], depth: LineDepth::OnTop });
        scene.sun = Sun { direction: to, color: [bad; 3], shadow_radius: bad };
        for (position, target) in [(to, Vec3::ZERO), (Vec3::ONE, to), (to, to), (Vec3::Y, Vec3::ZERO)] {
            renderer.render(&scene, &Camera { position, target, fov_y: bad });
        }
    }
}

#[test]
fn a_floor_of_thousands_of_kilometres_reaches_the_horizon() {
    let mut model = triangle(
        [Vec3::new(-9e6, -1.0, 9e6), Vec3::new(9e6, -1.0, 9e6), Vec3::new(0.0, -1.0, -9e6)],
        [0.5; 3],
    );
    model.material.shadow = ShadowCasting::No;
    let image = draw(&plain(vec![model]), Antialiasing::Off);
    assert!((0..WIDTH).all(|x| is_sky(&image, x, HEIGHT / 2 - 1)));
    assert!((0..WIDTH).all(|x| !is_sky(&image, x, HEIGHT / 2 + 1)));
}

#[test]
fn back_faces_are_drawn_only_if_both_sides_are() {
    let front = [Vec3::new(-1.0, -1.0, -2.0), Vec3::new(1.0, -1.0, -2.0), Vec3::new(0.0, 1.0, -2.0)];
    let back = [front[0], front[2], front[1]];
    let seen = |points: [Vec3; 3], faces: Faces| {
        let mut model = triangle(points, [0.5; 3]);
        model.material.faces = faces;
        !is_sky(&draw(&plain(vec![model]), Antialiasing::Off), WIDTH / 2, HEIGHT / 2)
    };
    assert!(seen(front, Faces::Outside) && seen(front, Faces::Both) && seen(back, Faces::Both));
    assert!(!seen(back, Faces::Outside));
}

#[test]
fn glass_blends_with_the_background() {
    let at = |z: f32| [Vec3::new(-9.0, -9.0, z), Vec3::new(9.0, -9.0, z), Vec3::new(0.0, 9.0, z)];
    let wall = triangle(at(-4.0), [0.0, 0.0, 1.0]);
    let mut glass = triangle(at(-2.0), [1.0, 0.0, 0.0]);
    glass.material.opacity = 0.25;
    let mut hidden = triangle(at(-5.0), [0.0, 1.0, 0.0]);
    hidden.material.opacity = 0.5;
    let image = draw(&plain(vec![glass, wall, hidden]), Antialiasing::Samples4);
    let [red, green, blue, _] = image.pixel(WIDTH / 2, HEIGHT / 2).map(f32::from);
    assert!(
        (red - srgb(0.25)).abs() < 2.0 && green == 0.0 && (blue - srgb(0.75)).abs() < 2.0,
        "{red} {blue}"
    );
}

#[test]
fn texture_is_drawn_upright_with_its_origin_at_the_top_left() {
    let quadrants = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
    let rgba = (0..64).flat_map(|i| quadrants[(i / 32) * 2 + (i % 8) / 4]).collect();
    let corner = |x: f32, y: f32| Vec3::new(x, y, -1.0);
    let model = Model {
        positions: vec![corner(-0.5, 0.5), corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5)],
        uvs: vec![Vec2::new(0.0, 0.0), Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0)],
        indices: vec![0, 1, 2, 0, 2, 3],
        material: RenderMaterial {
            texture: Some(Arc::new(Texture::new(8, 8, rgba).expect("8 × 8"))),
            ..RenderMaterial::new([1.0; 3])
        },
        ..Model::default()
    };
    let image = draw(&plain(vec![model]), Antialiasing::Samples4);
    let quarter = 12;
    for (i, wanted) in quadrants.into_iter().enumerate() {
        let x = if i % 2 == 0 { WIDTH / 2 - quarter } else { WIDTH / 2 + quarter };
        let y = if i / 2 == 0 { HEIGHT / 2 - quarter } else { HEIGHT / 2 + quarter };
        assert_eq!(image.pixel(x, y), wanted, "quadrant {i}");
    }
}

#[test]
fn lines_hide_behind_surfaces_unless_on_top() {
    let half_extents = Vec3::splat(0.5);
    let place = Transform::from_translation(Vec3::new(0.0, 0.0, -3.0));
    let cube = draw::shape(&Shape::Box { half_extents }, place, RenderMaterial::new([0.5; 3]));
    let middle = |line_z: f32, depth: LineDepth| {
        let mut scene = plain(vec![cube.clone()]);
        let (from, to) = (Vec3::new(-1.0, 0.01, line_z), Vec3::new(1.0, 0.01, line_z));
        scene.lines = vec![Line { from, to, color: [0.0, 1.0, 0.0], depth }];
        draw(&scene, Antialiasing::Samples4).pixel(WIDTH / 2, HEIGHT / 2 - 1)[1] > 200
    };
    assert!(middle(-2.0, LineDepth::Tested));
    assert!(!middle(-4.0, LineDepth::Tested));
    assert!(middle(-4.0, LineDepth::OnTop));
}

#[test]
fn captions_appear_at_their_positions() {
    let mut scene = plain(vec![]);
    scene.captions = vec![
        Caption { x: 4, y: 4, scale: 1, ..Caption::new("I") },
        Caption { x: -4, y: -4, scale: 2, ..Caption::new("_") },
        Caption { x: 90, y: 20, ..Caption::new("beyond the edge") },
    ];
    let image = draw(&scene, Antialiasing::Off);
    let stem = (0..7).all(|row| image.pixel(6, 4 + row) == [255; 4]);
    assert!(stem && image.pixel(4, 7) != [255; 4]);
    let underline = (0..10).all(|column| image.pixel(WIDTH - 4 - 12 + column, HEIGHT - 8) == [255; 4]);
    assert!(underline);
}
