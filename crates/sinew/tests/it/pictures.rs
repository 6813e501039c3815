//! Checks the SVG pictures of the documentation: redrawn, they must equal the committed ones.
//! `SINEW_BLESS=1 cargo test -p sinew --test it pictures` writes them.

use sinew::anim::local_to_model;
use sinew::math::Affine;
use sinew::prelude::*;
use std::fmt::Write;
use std::sync::Arc;

/// Pixels per metre.
const METRE: f32 = 100.0;

/// A drawing in the colour of the page's text, with width and height in metres; the ground is 0.1 m above its lower
/// edge.
struct Drawing {
    text: String,
    height: f32,
}

impl Drawing {
    fn new(label: &str, width: f32, height: f32) -> Self {
        let [w, h] = [width, height].map(|side| (side * METRE) as i32);
        let ground = h - (0.1 * METRE) as i32;
        let text = format!(
            "<svg viewBox=\"0 0 {w} {h}\" width=\"{w}\" style=\"max-width:100%\" role=\"img\" aria-label=\"{label}\" \
             stroke=\"currentColor\" fill=\"none\" stroke-linecap=\"round\">\n\
             <path d=\"M0 {ground}H{w}\" stroke-width=\"1\" opacity=\"0.5\"/>\n"
        );
        Self { text, height }
    }

    /// Converts a point (x to the right and y up, metres) to pixels.
    fn place(&self, [x, y]: [f32; 2]) -> [i32; 2] {
        [x * METRE, (self.height - 0.1 - y) * METRE].map(|at| at.round() as i32)
    }

    /// Draws lines with a thickness in metres.
    fn lines(&mut self, thickness: f32, opacity: f32, lines: impl Iterator<Item = [[f32; 2]; 2]>) {
        let mut path = String::new();
        for [from, to] in lines {
            let ([a, b], [c, d]) = (self.place(from), self.place(to));
            write!(path, "M{a} {b}L{c} {d}").expect("a string takes it");
        }
        let width = (thickness * METRE).round() as i32;
        writeln!(self.text, "<path d=\"{path}\" stroke-width=\"{width}\" opacity=\"{opacity}\"/>")
            .expect("a string takes it");
    }

    /// Draws a disc with a radius in metres.
    fn ball(&mut self, at: [f32; 2], radius: f32) {
        let ([x, y], radius) = (self.place(at), (radius * METRE).round() as i32);
        writeln!(
            self.text,
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"currentColor\" stroke=\"none\"/>"
        )
        .expect("a string takes it");
    }

    fn end(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }
}

/// Steps of the fall at which a character is drawn, and position of its pelvis from the left edge, metres.
const FALL: [(u32, f32); 7] = [(40, 0.5), (58, 1.3), (66, 2.3), (74, 3.4), (82, 4.6), (92, 6.0), (180, 7.7)];

/// Draws the mannequin, hit while it walks, from the side; the characters are side by side.
fn fall() -> String {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let def = Arc::new(sinew::mannequin::character());
    let mut hero = Character::spawn(&mut world, &def, Transform::IDENTITY);
    hero.set_move(Vec3::Z * 1.2);
    let mut drawing = Drawing::new("A walking figure is hit, falls and lies", 9.1, 2.0);
    for step in 0..=180 {
        if step == 60 {
            let chest = def.body_named("chest").expect("the character has this body");
            hero.hit(&mut world, chest, Vec3::new(20.0, 0.0, -80.0));
        }
        world.step();
        hero.update(&mut world);
        if let Some((_, place)) = FALL.iter().find(|(at, _)| *at == step) {
            let mut model = Vec::new();
            local_to_model(&def.rig, hero.pose(), &hero.world_from_model(), &mut model);
            let pelvis = model[def.ragdoll.bodies[0].joint].translation.z;
            figure(&mut drawing, &def, &model, Vec3::Z * (place - pelvis));
        }
    }
    drawing.end()
}

/// Draws bones and head of a character, seen from its left: +Z to the right.
fn figure(drawing: &mut Drawing, def: &CharacterDef, model: &[Affine], way: Vec3) {
    let at = |joint: usize| {
        let place = model[joint].translation + way;
        [place.z, place.y]
    };
    let joints = def.rig.joints.iter().enumerate().filter(|(_, joint)| joint.parent.is_some_and(|of| of > 0));
    let bones = joints.map(|(joint, of)| [at(of.parent.expect("the joint has a parent")), at(joint)]);
    drawing.lines(0.07, 0.75, bones);
    let head = def.rig.joints.iter().position(|joint| joint.name == "head").expect("the rig has this joint");
    let middle = model[head].point(Vec3::Y * 0.1) + way;
    drawing.ball([middle.z, middle.y], 0.11);
}

/// Draws the mannequin's skeleton, and the bodies of its ragdoll, from the front.
fn ragdoll() -> String {
    let def = sinew::mannequin::character();
    let mut drawing = Drawing::new("A skeleton with the shapes of its ragdoll", 1.9, 2.0);
    let right = |at: Vec3| [0.95 - at.x, at.y];
    for body in &def.ragdoll.bodies {
        let mut world = World::new(WorldDef::default());
        let id = world.add_body(&BodyDef::dynamic(body.shape.clone()));
        world.set_transform(id, body.character_from_body);
        let mut wires = Wires::default();
        world.draw(&mut wires);
        drawing.lines(0.01, 0.45, wires.0.iter().map(|&[a, b]| [right(a), right(b)]));
    }
    let mut model = Vec::new();
    local_to_model(&def.rig, def.rest(), &def.mapping().character_from_model(), &mut model);
    let joints = def.rig.joints.iter().enumerate().filter(|(_, joint)| joint.parent.is_some_and(|of| of > 0));
    let bones = joints.map(|(joint, of)| [of.parent.expect("the joint has a parent"), joint]);
    let bones = bones.map(|bone| bone.map(|joint| right(model[joint].translation)));
    drawing.lines(0.03, 1.0, bones);
    drawing.end()
}

/// Collects the debug lines of shapes.
#[derive(Default)]
struct Wires(Vec<[Vec3; 2]>);

impl DebugDraw for Wires {
    fn line(&mut self, from: Vec3, to: Vec3, kind: DrawKind) {
        if kind == DrawKind::Awake {
            self.0.push([from, to]);
        }
    }
}

#[test]
fn saved_pictures_match_drawn_ones() {
    let pictures = [("doc/fall.svg", fall()), ("../sinew_ragdoll/doc/ragdoll.svg", ragdoll())];
    for (path, due) in pictures {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        if std::env::var_os("SINEW_BLESS").is_some() {
            std::fs::write(&path, &due).expect("the file can be written");
        }
        let is = std::fs::read_to_string(&path).expect("the file can be read");
        assert!(is == due, "{}: bless it, and look at it", path.display());
        assert!(
            due.len() < 40_000 && !due.contains("\n\n"),
            "the page has {} bytes; expected one block of HTML",
            due.len()
        );
    }
}
