//! Pictures of the guide's page on symptoms: left the mistake, right its cure, both simulated. Redrawn, they must equal the committed ones;
//! `SINEW_BLESS=1 cargo test -p sinew_picture --test it symptoms` writes them.

use sinew::math::hash::hash_bytes;
use sinew::prelude::*;
use sinew_picture::world::{Frame, Kinematic, paint};
use sinew_picture::{
    Camera, Caption, Line, LineDepth, PictureFormat, RenderSettings, Renderer, Scene, encode,
};
use std::path::Path;

const FOLDER: &str = "../../docs/guide/src/symptoms";
const SETTINGS: RenderSettings = RenderSettings {
    width: 640,
    height: 270,
    antialiasing: sinew_picture::Antialiasing::Samples4,
    shadow_texels: 1024,
    threads: 1,
};
/// Linear colour of paths.
const TRAIL: [f32; 3] = [0.9, 0.75, 0.1];

/// A picture of two worlds in one, at `half` metres left and right of the centre.
struct Drawing {
    world: World,
    /// Paths that bodies took, world space, metres.
    trails: Vec<Vec<Vec3>>,
    /// Bodies with their own colour, linear.
    colors: Vec<(BodyId, [f32; 3])>,
    captions: [&'static str; 2],
    camera: Camera,
}

impl Drawing {
    fn bytes(&self) -> Vec<u8> {
        let frame = Frame {
            center: self.camera.target,
            radius: 2.0,
            kinematic: Kinematic::Solid,
            colors: &self.colors,
        };
        let mut scene = Scene::default();
        paint(&self.world, &frame, &mut scene);
        for pair in self.trails.iter().flat_map(|trail| trail.windows(2)) {
            let (from, to) = (pair[0], pair[1]);
            scene.lines.push(Line { from, to, color: TRAIL, depth: LineDepth::OnTop });
        }
        let [left, right] = self.captions.map(str::to_owned);
        scene.captions = vec![
            Caption { x: 12, y: -12, scale: 2, ..Caption::new(left) },
            Caption { x: -12, y: -12, scale: 2, ..Caption::new(right) },
        ];
        let image = Renderer::new(SETTINGS).render(&scene, &self.camera);
        encode::encode(PictureFormat::Png, &[image], 1).expect("one picture")
    }
}

fn ground() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    world
}

/// A crate on a lift that is placed elsewhere in each step, and one on a lift that moves there.
fn jitters() -> Drawing {
    let mut world = ground();
    let at = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let [put, moved] = [-1.6, 1.6].map(|x| {
        let lift = BodyDef::kinematic(Shape::cuboid(Vec3::new(0.6, 0.06, 0.5))).at(at(x - 0.5, 0.3));
        let lift = world.add_body(&lift);
        let load = BodyDef::dynamic(Shape::cuboid(Vec3::new(0.3, 0.25, 0.25))).at(at(x - 0.5, 0.61));
        (lift, world.add_body(&load))
    });
    let mut trails = vec![Vec::new(), Vec::new()];
    for step in 0..90 {
        // The lift moves up by 0.7 m and to the right by 1 m in 1.5 s.
        let share = step as f32 / 90.0;
        let way = Vec3::new(share - 0.5, 0.35 - 0.35 * trig::cos(share * core::f32::consts::PI), 0.0);
        world.set_transform(put.0, Transform::from_translation(at(-1.6, 0.3) + way));
        world.move_to(moved.0, Transform::from_translation(at(1.6, 0.3) + way), world.def().dt());
        world.step();
        for (trail, load) in trails.iter_mut().zip([put.1, moved.1]) {
            trail.push(world.transform(load) * Vec3::new(0.0, 0.25, 0.26));
        }
    }
    let camera = Camera::framing(at(0.0, 0.75), 1.3, Vec3::new(0.0, 0.25, 1.0));
    Drawing { world, trails, colors: Vec::new(), captions: ["set_transform in each step", "move_to"], camera }
}

/// A sheet of triangles, one up and one down, each with a ball on it.
fn sinks() -> Drawing {
    let mut world = ground();
    let mut colors = Vec::new();
    let corners = [[-0.9, -0.6], [0.9, -0.6], [0.9, 0.6], [-0.9, 0.6]].map(|[x, z]| Vec3::new(x, 0.0, z));
    for (x, triangles) in [(-1.6, [[0, 1, 2], [0, 2, 3]]), (1.6, [[0, 2, 1], [0, 3, 2]])] {
        let sheet = Shape::mesh(&corners, &triangles).expect("two triangles");
        let sheet = world.add_body(&BodyDef::fixed(sheet).at(Vec3::new(x, 0.8, 0.0)));
        colors.push((sheet, [0.1, 0.25, 0.4]));
        world.add_body(&BodyDef::dynamic(Shape::sphere(0.3)).at(Vec3::new(x, 1.6, 0.0)));
    }
    let balls: Vec<BodyId> = world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic).collect();
    let mut trails = vec![Vec::new(); balls.len()];
    for _ in 0..60 {
        for (trail, &ball) in trails.iter_mut().zip(&balls) {
            trail.push(world.transform(ball).translation);
        }
        world.step();
    }
    let camera = Camera::framing(Vec3::Y * 0.85, 1.2, Vec3::new(0.0, 0.3, 1.0));
    Drawing {
        world,
        trails,
        colors,
        captions: ["clockwise triangles", "counter-clockwise triangles"],
        camera,
    }
}

/// A weight of 40 kg on a rope of soft particles, and on links of bodies.
fn stretches() -> Drawing {
    const LINKS: usize = 10;
    const WEIGHT: f32 = 40.0;
    let mut world = ground();
    let beam = BodyDef::fixed(Shape::cuboid(Vec3::new(2.4, 0.06, 0.1))).at(Vec3::Y * 2.9);
    let beam = world.add_body(&beam);
    let weight = |world: &mut World, x: f32, y: f32| {
        let side = 0.2;
        let density = WEIGHT / (8.0 * side * side * side);
        let shape = ShapeDef { density, ..ShapeDef::new(Shape::cuboid(Vec3::splat(side))) };
        world.add_body(&BodyDef { shapes: vec![shape], ..BodyDef::dynamic(Shape::HalfSpace) }.at(Vec3::new(
            x,
            y - side,
            0.0,
        )))
    };
    let (from, to) = (Vec3::new(-1.3, 2.84, 0.0), Vec3::new(-1.3, 1.84, 0.0));
    let mut rope =
        RopeDef { from, to, links: LINKS as u32, mass: 0.5, stiffness: 500.0, radius: 0.02 }.build();
    let load = weight(&mut world, -1.3, 1.84);
    rope.group.hold(
        rope.first,
        AttachmentTarget::Body { body: beam, point: world.transform(beam).inverse_point(from) },
    );
    rope.group.hold(rope.last, AttachmentTarget::Body { body: load, point: Vec3::Y * 0.2 });
    world.add_particles(&rope.group);
    let mut above = beam;
    for link in 0..LINKS {
        let top = Vec3::new(1.3, 2.84 - 0.1 * link as f32, 0.0);
        let body = BodyDef::dynamic(Shape::capsule(0.03, 0.02)).at(top - Vec3::Y * 0.05);
        let body = world.add_body(&body);
        world.add_joint(&world.ball(above, body, top));
        above = body;
    }
    let load = weight(&mut world, 1.3, 1.84);
    world.add_joint(&world.ball(above, load, Vec3::new(1.3, 1.84, 0.0)));
    (0..600).for_each(|_| world.step());
    let camera = Camera::framing(Vec3::Y * 1.55, 1.7, Vec3::new(0.0, 0.1, 1.0));
    Drawing {
        world,
        trails: Vec::new(),
        colors: Vec::new(),
        captions: ["particles, 500 N/m", "ten bodies with joints"],
        camera,
    }
}

#[test]
fn pictures_of_the_guide_are_up_to_date() {
    for (name, drawing) in [("jitters", jitters()), ("sinks", sinks()), ("stretches", stretches())] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER).join(format!("{name}.png"));
        let due = drawing.bytes();
        if std::env::var_os("SINEW_BLESS").is_some() {
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("the folder can be created");
            std::fs::write(&path, &due).expect("the picture can be written");
        }
        let is = std::fs::read(&path).expect("the named item exists");
        assert_eq!(
            hash_bytes(&is),
            hash_bytes(&due),
            "{} differs from the drawn picture: run with SINEW_BLESS set, and check the new picture",
            path.display()
        );
        assert!(due.len() < 100_000, "{} bytes", due.len());
    }
}
