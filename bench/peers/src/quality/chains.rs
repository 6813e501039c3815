//! Finds chains: bodies in a row.

use super::worse;
use sinew::physics::BodyKind;
use sinew_scenes::blueprint::Blueprint;

/// Connected dynamic bodies, none with more than two joints.
pub(super) struct Chain {
    /// Indices of the chain's joints.
    joints: Vec<usize>,
    /// Number of bodies between two joints.
    links: usize,
    /// Sum of the distances between the two joints of each link in the start pose, metres.
    length: f32,
}

impl Chain {
    /// Returns all chains of a scene.
    pub fn find(scene: &Blueprint) -> Vec<Self> {
        let mut joints_of = vec![Vec::new(); scene.bodies.len()];
        for (place, joint) in scene.joints.iter().enumerate() {
            joints_of[joint.a].push(place);
            joints_of[joint.b].push(place);
        }
        let mut is_seen = vec![false; scene.bodies.len()];
        let mut chains = Vec::new();
        for start in scene.dynamic() {
            if !is_seen[start] {
                let bodies = together_with(start, scene, &joints_of, &mut is_seen);
                chains.extend(Self::new(&bodies, scene, &joints_of));
            }
        }
        chains
    }

    /// Returns `None` if the bodies branch, or all of their joints coincide.
    fn new(bodies: &[usize], scene: &Blueprint, joints_of: &[Vec<usize>]) -> Option<Self> {
        let anchor = |joint: usize| scene.joints[joint].world_from_joint.translation;
        let mut chain = Self { joints: Vec::new(), links: 0, length: 0.0 };
        for &body in bodies {
            match joints_of[body][..] {
                [end] => chain.joints.push(end),
                [a, b] => {
                    chain.joints.extend([a, b]);
                    chain.links += 1;
                    chain.length += (anchor(b) - anchor(a)).length();
                }
                _ => return None,
            }
        }
        chain.joints.sort_unstable();
        chain.joints.dedup();
        (chain.length > 0.0).then_some(chain)
    }

    /// Returns the sum of the gaps as a share of the chain's length.
    pub fn stretch(&self, gaps: &[f32]) -> f32 {
        self.joints.iter().map(|&joint| gaps[joint]).sum::<f32>() / self.length
    }

    /// Returns the largest gap as a share of a link's mean length.
    pub fn gap_per_link(&self, gaps: &[f32]) -> f32 {
        let largest = self.joints.iter().map(|&joint| gaps[joint]).fold(0.0, worse);
        largest * self.links as f32 / self.length
    }
}

/// Returns the dynamic bodies that joints connect to `start`, directly or through others.
fn together_with(
    start: usize,
    scene: &Blueprint,
    joints_of: &[Vec<usize>],
    is_seen: &mut [bool],
) -> Vec<usize> {
    let mut found = vec![start];
    is_seen[start] = true;
    let mut next = 0;
    while next < found.len() {
        for &joint in &joints_of[found[next]] {
            for body in [scene.joints[joint].a, scene.joints[joint].b] {
                if !is_seen[body] && scene.bodies[body].kind == BodyKind::Dynamic {
                    is_seen[body] = true;
                    found.push(body);
                }
            }
        }
        next += 1;
    }
    found
}
