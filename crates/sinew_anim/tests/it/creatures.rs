//! Bodies that are not human, with numbers for names: each limb is one chain, on one side, attached to the
//! trunk.

use crate::wild::rig_of;
use sinew_anim::{RigAnalysis, Role, analyze};
use sinew_math::Vec3;

/// Joints of a body: parent and position (metres).
#[derive(Default)]
struct Body(Vec<(Option<usize>, Vec3)>);

impl Body {
    /// Adds a line of joints and returns the last joint.
    fn line(&mut self, on: Option<usize>, places: &[[f32; 3]]) -> usize {
        let mut parent = on;
        for &place in places {
            self.0.push((parent, Vec3::from_array(place)));
            parent = Some(self.0.len() - 1);
        }
        self.0.len() - 1
    }

    /// Adds a line of joints on the left and its mirror image on the right.
    fn pair(&mut self, on: usize, places: &[[f32; 3]]) {
        for side in [1.0, -1.0] {
            let places: Vec<_> = places.iter().map(|&[x, y, z]| [side * x, y, z]).collect();
            self.line(Some(on), &places);
        }
    }

    fn analyzed(&self) -> RigAnalysis {
        let names: Vec<String> = (0..self.0.len()).map(|i| i.to_string()).collect();
        self.analyzed_as(&names)
    }

    fn analyzed_as(&self, names: &[String]) -> RigAnalysis {
        let place = |i: usize| self.0[i].1;
        let bone = |i: usize| {
            let next = (0..self.0.len()).find(|&k| self.0[k].0 == Some(i));
            let on = self.0[i].0.map_or(place(i) - Vec3::Z * 0.1, place);
            (i, place(i), next.map_or(place(i) + (place(i) - on) * 0.5, place))
        };
        let bones: Vec<_> = (0..self.0.len()).map(bone).collect();
        analyze(&rig_of(names.iter().map(String::as_str), &|i| self.0[i].0, &place, &bones)).expect("a skin")
    }
}

/// Returns the numbers of segments of the limbs; checks that each limb is a single chain.
fn limbs(name: &str, found: &RigAnalysis) -> Vec<usize> {
    assert!(!found.humanoid, "{name}");
    let side = |joint: usize| {
        let x = found.character_from_file().point(found.bind_model[joint].translation).x;
        if x.abs() < 1e-3 { 0.0 } else { x.signum() }
    };
    let mut counts: Vec<usize> = Vec::new();
    for bone in &found.kept {
        let Role::LimbSegment { limb, .. } = bone.role else {
            assert_eq!(side(bone.joint), 0.0, "{name}: {} must belong to the trunk", bone.role.name());
            continue;
        };
        counts.resize(counts.len().max(usize::from(limb) + 1), 0);
        counts[usize::from(limb)] += 1;
        let on = &found.kept[bone.parent.expect("a limb has a parent")];
        match on.role {
            Role::LimbSegment { limb: other, .. } => {
                assert_eq!(limb, other, "{name}: a limb is attached to another limb");
            }
            _ => assert_eq!(side(on.joint), 0.0, "{name}"),
        }
        let own = found
            .kept
            .iter()
            .filter(|other| matches!(other.role, Role::LimbSegment { limb: other, .. } if other == limb));
        assert!(own.map(|other| side(other.joint)).all(|of| of == side(bone.joint)), "{name}: of two sides");
    }
    counts
}

#[test]
fn birds_insects_snakes_and_carts_get_their_limbs() {
    let mut bird = Body::default();
    let hips = bird.line(None, &[[0.0, 0.3, 0.0]]);
    bird.line(Some(hips), &[[0.0, 0.32, 0.1], [0.0, 0.36, 0.2], [0.0, 0.44, 0.3], [0.0, 0.46, 0.36]]);
    bird.line(Some(hips), &[[0.0, 0.3, -0.1], [0.0, 0.29, -0.25]]);
    bird.pair(hips, &[[0.05, 0.26, 0.0], [0.05, 0.16, 0.05], [0.05, 0.06, -0.02], [0.05, 0.01, 0.05]]);
    bird.pair(hips + 1, &[[0.07, 0.35, 0.1], [0.25, 0.36, 0.06], [0.45, 0.36, 0.0]]);
    let mut segments = limbs("bird", &bird.analyzed());
    segments.sort_unstable();
    assert_eq!(segments, [3, 3, 4, 4], "expected two legs and two wings");

    let mut ant = Body::default();
    let thorax = ant.line(None, &[[0.0, 0.1, 0.0]]);
    ant.line(Some(thorax), &[[0.0, 0.11, 0.15], [0.0, 0.12, 0.22]]);
    ant.line(Some(thorax), &[[0.0, 0.11, -0.12], [0.0, 0.12, -0.3]]);
    for z in [0.08, 0.0, -0.08] {
        ant.pair(thorax, &[[0.04, 0.1, z], [0.15, 0.16, 2.0 * z], [0.25, 0.01, 3.0 * z]]);
    }
    assert_eq!(limbs("ant", &ant.analyzed()), [3; 6]);

    let mut snake = Body::default();
    let places: Vec<_> = (0..14).map(|i| [0.0, 0.05, 0.1 * i as f32]).collect();
    snake.line(None, &places);
    let found = snake.analyzed();
    assert!(limbs("snake", &found).is_empty() && found.kept.len() == 14, "{} bodies", found.kept.len());

    let mut cart = Body::default();
    let chassis = cart.line(None, &[[0.0, 0.5, 0.0]]);
    cart.line(Some(chassis), &[[0.0, 0.9, 0.1]]);
    for z in [0.8, -0.8] {
        cart.pair(chassis, &[[0.6, 0.3, z]]);
    }
    assert_eq!(limbs("cart", &cart.analyzed()), [1; 4], "each wheel is its own limb");
}

/// Numbered names of a pair do not distinguish left from right, but head and tail are still recognised by
/// name.
#[test]
fn numbered_pairs_keep_the_named_head_and_tail() {
    let mut raptor = Body::default();
    let body = raptor.line(None, &[[0.0, 0.5, 0.0]]);
    raptor.line(Some(body), &[[0.0, 0.52, 0.15], [0.0, 0.62, 0.35], [0.0, 0.7, 0.55]]);
    raptor.line(Some(body), &[[0.0, 0.5, -0.3], [0.0, 0.49, -0.7], [0.0, 0.48, -1.1], [0.0, 0.47, -1.5]]);
    raptor.pair(body, &[[0.1, 0.45, 0.0], [0.1, 0.25, 0.06], [0.1, 0.04, -0.02]]);
    let names = |left: &str, right: &str| {
        let trunk = ["Body", "Torso", "Neck", "Head", "Back", "Tail1", "Tail2", "Tail3"].map(str::to_owned);
        let leg = |side: &str| ["Leg", "LowLeg", "Foot"].map(|part| format!("{part}{side}"));
        [trunk.to_vec(), leg(left).to_vec(), leg(right).to_vec()].concat()
    };
    let role = |found: &RigAnalysis, joint: usize| {
        found.kept.iter().find(|bone| bone.joint == joint).map(|bone| bone.role)
    };
    for [left, right] in [[".L", ".R"], [".1", ".2"], [".2", ".1"], ["", ".001"]] {
        let found = raptor.analyzed_as(&names(left, right));
        assert!(!found.humanoid);
        assert!(
            matches!(role(&found, 3), Some(Role::SpineSegment(3))),
            "{left} {right}: {:?}",
            role(&found, 3)
        );
        assert!(
            matches!(role(&found, 5), Some(Role::TailSegment(1))),
            "{left} {right}: {:?}",
            role(&found, 5)
        );
        assert!(
            matches!(role(&found, 8), Some(Role::LimbSegment { .. })),
            "{left} {right}: {:?}",
            role(&found, 8)
        );
    }
    // By shape alone the longer end would be the trunk; names decide otherwise.
    assert!(matches!(role(&raptor.analyzed(), 5), Some(Role::SpineSegment(_))));
}
