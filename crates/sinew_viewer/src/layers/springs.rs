//! Springs of characters and backstops of cloth: swinging bones, their hit radii, and their colliders.

use sinew::anim::Springs;
use sinew::anim::springs::{ColliderShape, SpringBone};
use sinew::math::{Affine, Rotation, Transform, Vec3, normalize_or};
use sinew::physics::{Shape, World};
use sinew_picture::{Line, LineDepth, draw};
use sinew_scenes::scenes::Figure;

/// Linear colours of swinging bones and their hit radii, of colliders, and of the distance of a particle to its backstop.
const SWINGS: [f32; 3] = [0.85, 0.10, 0.55];
const COLLIDER: [f32; 3] = [0.05, 0.60, 0.75];
const BACKSTOP: [f32; 3] = [0.10, 0.65, 0.15];
/// Colour of the line from a particle to the backstop that stops it.
const STOPPED: [f32; 3] = [0.95, 0.15, 0.05];
/// Gap below which a particle rests on its backstop, metres.
const LIES: f32 = 1e-3;
/// Half the side of the square that shows a plane, in lengths of a file's unit.
const PLANE: f32 = 0.25;

/// Adds the springs of the rigs of characters.
pub(super) fn add_springs(figures: &[Figure<'_>], lines: &mut Vec<Line>) {
    for figure in figures {
        let Springs { chains, colliders, .. } = &figure.rig.springs;
        for bone in chains.iter().flat_map(|chain| &chain.bones) {
            figure
                .world_from_joint
                .get(bone.joint)
                .into_iter()
                .for_each(|frame| add_bone(bone, frame, lines));
        }
        for collider in colliders {
            let frame = figure.world_from_joint.get(collider.joint);
            frame.into_iter().for_each(|frame| add_collider(&collider.shape, frame, lines));
        }
    }
}

/// Returns the length of a unit of a joint's space, metres.
fn scale(frame: &Affine) -> f32 {
    frame.vector(Vec3::Y).length()
}

fn ball(center: Vec3, radius: f32, color: [f32; 3], lines: &mut Vec<Line>) {
    let place = Transform::from_translation(center);
    lines.extend(draw::wire(&Shape::Sphere { radius }, place, color, LineDepth::OnTop));
}

/// Adds a bone from its joint to its tip, with its hit radius about the tip.
fn add_bone(bone: &SpringBone, frame: &Affine, lines: &mut Vec<Line>) {
    let (from, to) = (frame.translation, frame.point(bone.tail));
    lines.push(Line { from, to, color: SWINGS, depth: LineDepth::OnTop });
    if bone.radius > 0.0 {
        ball(to, bone.radius * scale(frame), SWINGS, lines);
    }
}

fn add_collider(shape: &ColliderShape, frame: &Affine, lines: &mut Vec<Line>) {
    match *shape {
        ColliderShape::Sphere { offset, radius, .. } => {
            ball(frame.point(offset), radius * scale(frame), COLLIDER, lines);
        }
        ColliderShape::Capsule { offset, tail, radius, .. } => {
            let [a, b] = [offset, tail].map(|end| frame.point(end));
            let turn = Rotation::from_arc(Vec3::Y, normalize_or(b - a, Vec3::Y));
            let shape = Shape::Capsule { half_height: 0.5 * (b - a).length(), radius: radius * scale(frame) };
            let place = Transform::new((a + b) * 0.5, turn);
            lines.extend(draw::wire(&shape, place, COLLIDER, LineDepth::OnTop));
        }
        ColliderShape::Plane { offset, normal } => {
            let turn = Rotation::from_arc(Vec3::Y, normalize_or(frame.vector(normal), Vec3::Y));
            let (place, half) = (frame.point(offset), PLANE * scale(frame));
            let corner = |x: f32, z: f32| place + turn * (Vec3::new(x, 0.0, z) * half);
            let corners = [corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)];
            let up = [[place, place + turn * Vec3::Y * half]];
            let sides = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]);
            let line = |[from, to]: [Vec3; 2]| Line { from, to, color: COLLIDER, depth: LineDepth::OnTop };
            lines.extend(sides.chain(up).map(line));
        }
    }
}

/// Adds a line from each particle to its backstop, red if the particle rests on it.
pub(super) fn add_backstops(world: &World, lines: &mut Vec<Line>) {
    for group in world.group_ids().map(|id| world.particles(id)) {
        for stop in group.backstops() {
            let (at, radius) =
                (group.positions()[stop.particle as usize], group.radii()[stop.particle as usize]);
            let center = world.transform(stop.body).point(stop.center);
            let out = normalize_or(at - center, Vec3::Y);
            let gap = (at - center).length() - stop.radius;
            let color = if gap - radius < LIES { STOPPED } else { BACKSTOP };
            lines.push(Line { from: at, to: center + out * stop.radius, color, depth: LineDepth::OnTop });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::anim::springs::Side;
    use sinew::anim::{Joint, LocalTransform, Rig, SpringChain};
    use sinew::physics::particles::{BackstopDef, GroupDef, ParticleDef};
    use sinew::physics::{BodyDef, WorldDef};

    /// Returns the lines of a joint that is moved aside, rotated and twice as large, with a bone and a collider.
    fn lines_of(shape: ColliderShape) -> Vec<Line> {
        let joint = Joint { name: "hair".into(), parent: None, rest: LocalTransform::default(), source: 0 };
        let bone = SpringBone {
            joint: 0,
            tail: Vec3::X * 0.5,
            stiffness: 1.0,
            gravity: Vec3::ZERO,
            drag: 0.4,
            radius: 0.1,
            limit: None,
        };
        let mut rig = Rig { joints: vec![joint], ..Rig::default() };
        rig.springs.chains.push(SpringChain { bones: vec![bone], ..SpringChain::default() });
        rig.springs.colliders.push(sinew::anim::springs::SpringCollider { joint: 0, shape });
        let turn = Rotation::from_axis_angle(Vec3::Z, core::f32::consts::FRAC_PI_2);
        let frames = [Affine::from_scale_rotation_translation(Vec3::splat(2.0), turn, Vec3::Z)];
        let mut lines = Vec::new();
        add_springs(&[Figure { rig: &rig, world_from_joint: &frames }], &mut lines);
        lines
    }

    fn ends(lines: &[Line], color: [f32; 3]) -> impl Iterator<Item = Vec3> {
        lines.iter().filter(move |line| line.color == color).flat_map(|line| [line.from, line.to])
    }

    #[test]
    fn bones_and_colliders_are_drawn_at_their_joint() {
        let keeps = Side::Outside;
        let (tip, offset) = (Vec3::new(0.0, 1.0, 1.0), Vec3::NEG_X);
        let lines = lines_of(ColliderShape::Sphere { offset, radius: 0.3, keeps });
        assert!((lines[0].from - Vec3::Z).length() < 1e-6 && (lines[0].to - tip).length() < 1e-6);
        let rings = ends(&lines[1..], SWINGS);
        assert!(rings.map(|at| ((at - tip).length() - 0.2).abs()).fold(0.0, f32::max) < 1e-5);
        let middle = Vec3::new(0.0, -2.0, 1.0);
        assert!(ends(&lines, COLLIDER).count() > 20);
        let rings = ends(&lines, COLLIDER);
        assert!(rings.map(|at| ((at - middle).length() - 0.6).abs()).fold(0.0, f32::max) < 1e-5);
        // A capsule from that ball to one beyond the joint.
        let tail = Vec3::X;
        let lines = lines_of(ColliderShape::Capsule { offset, tail, radius: 0.1, keeps });
        let (low, high) = ends(&lines, COLLIDER)
            .fold((9.0, -9.0), |(low, high), at| (f32::min(low, at.y), f32::max(high, at.y)));
        assert!((low + 2.2).abs() < 1e-5 && (high - 2.2).abs() < 1e-5, "{low} to {high}");
        // A plane with its normal.
        let lines = lines_of(ColliderShape::Plane { offset, normal: Vec3::Y });
        let last = lines.last().expect("the normal is drawn");
        assert!((last.to - last.from).normalize().dot(Vec3::NEG_X) > 0.999, "{last:?}");
    }

    #[test]
    fn particle_on_its_backstop_is_red() {
        let mut world = World::new(WorldDef::default());
        let body = world.add_body(&BodyDef::fixed(Shape::Sphere { radius: 0.1 }).at(Vec3::Z));
        let at = |height: f32| ParticleDef {
            position: Vec3::new(0.0, height, 1.0),
            velocity: Vec3::ZERO,
            mass: 0.1,
            radius: 0.02,
        };
        let stop = |particle| BackstopDef { particle, body, center: Vec3::Y, radius: 0.2 };
        world.add_particles(&GroupDef {
            particles: vec![at(1.22), at(1.5)],
            backstops: vec![stop(0), stop(1)],
            ..GroupDef::default()
        });
        let mut lines = Vec::new();
        add_backstops(&world, &mut lines);
        assert_eq!(lines.iter().map(|line| line.color).collect::<Vec<_>>(), [STOPPED, BACKSTOP]);
        for line in &lines {
            assert!((line.to - Vec3::new(0.0, 1.2, 1.0)).length() < 1e-5, "on the ball: {}", line.to);
        }
    }
}
