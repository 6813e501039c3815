//! Impacts transmitted by joints within the step. An impulse moves one body immediately, and its jointed bodies only
//! when joints are solved, after `pairs` has searched.

use super::tuning::{BLOW_PASSES, BLOW_SPEED};
use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::contact::proxies::Proxies;
use crate::joint::{Joint, TWIST, locks};
use sinew_math::max;

/// Bodies that an impact will reach through their joints.
#[derive(Clone, Debug, Default)]
pub(crate) struct Blows {
    reached: Vec<u32>,
    /// Largest speed that an impact may cause, m/s, by index of the body; all 0 between two steps.
    speeds: Vec<f32>,
}

impl Blows {
    /// Finds the joints whose anchors separate after an impact: the joint solver left them with equal velocity, and a
    /// hit has changed one since.
    pub fn find(&mut self, bodies: &Arena<Body>, joints: &Arena<Joint>, activity: &Activity) {
        let slots = bodies.slot_count();
        self.speeds.resize(slots, 0.0);
        self.reached.reserve(slots);
        for body in activity.active() {
            for &joint in activity.joints_of.body(body) {
                let joint = joints.at(joint);
                let other = joint.a + joint.b - body;
                let is_seen = other < body && bodies.at(other).is_active();
                let speed = if is_seen { 0.0 } else { parting_speed(bodies, joint) };
                if speed > BLOW_SPEED {
                    self.reach(bodies, joint.a, speed);
                    self.reach(bodies, joint.b, speed);
                }
            }
        }
        let mut first = 0;
        for _ in 0..BLOW_PASSES {
            let last = self.reached.len();
            for at in first..last {
                let body = self.reached[at];
                let speed = self.speeds[body as usize];
                for &joint in activity.joints_of.body(body) {
                    let joint = joints.at(joint);
                    self.reach(bodies, joint.a + joint.b - body, speed);
                }
            }
            first = last;
        }
    }

    fn reach(&mut self, bodies: &Arena<Body>, body: u32, speed: f32) {
        if !bodies.at(body).is_active() {
            return;
        }
        let most = &mut self.speeds[body as usize];
        if *most == 0.0 {
            self.reached.push(body);
        }
        *most = max(*most, speed);
    }

    /// Extends the contact search of the reached bodies by the speed of the impact.
    pub fn widen(&mut self, proxies: &mut Proxies, bodies: &Arena<Body>) {
        for index in self.reached.drain(..) {
            let speed = core::mem::take(&mut self.speeds[index as usize]);
            proxies.widen(index, bodies.at(index), speed);
        }
    }
}

/// Separation speed of the anchors of a joint that locks them together, m/s; 0 if they do not separate.
fn parting_speed(bodies: &Arena<Body>, joint: &Joint) -> f32 {
    let [a, b] = [joint.a, joint.b].map(|index| bodies.at(index));
    if locks(&joint.kind)[..TWIST] != [true; TWIST] {
        return 0.0;
    }
    let velocity = |body: &Body, anchor| body.velocity.at(body.world_from_principal.rotation * anchor);
    let (p, q) = (velocity(a, joint.frame_a.translation), velocity(b, joint.frame_b.translation));
    (p - q).length()
}
