//! Level of detail of springs: distant springs ease to the pose, then cost nothing, and resume with the pose's own
//! motion.

use super::step::Mode;
use super::tuning::{EASE, GONE};
use super::{SpringStep, SpringSwing, TICK};
use sinew_anim::LocalTransform;
use sinew_math::{Affine, Rotation, Vec3, trig};

impl SpringSwing {
    /// Moves the springs one step nearer to the pose, instead of [`step`](Self::step): each bone's rotation from the
    /// pose falls to 1/e in 0.3 s. Once the remaining rotation is negligible, nothing is computed
    /// ([`is_away`](Self::is_away)). Springs that have not been stepped yet are away immediately.
    ///
    /// # Panics
    /// If the pose does not have one transform per joint of the springs' rig.
    pub fn ease(&mut self, step: &SpringStep<'_>) {
        let pose = |joint: usize| step.pose[joint].rotation;
        match self.mode {
            Mode::Away => return,
            Mode::Fresh => return self.go_away(),
            Mode::Swinging => {
                let turned = step.rig.joints().zip(&self.turns);
                let offset = |(joint, &turn): (usize, &Rotation)| {
                    let offset = (pose(joint).inverse() * turn).to_scaled_axis();
                    // A non-finite rotation would never decay.
                    if offset.is_finite() { offset } else { Vec3::ZERO }
                };
                self.offsets.clear();
                self.offsets.extend(turned.map(offset));
                self.mode = Mode::Easing;
            }
            Mode::Easing => {}
        }
        let keeps = trig::exp(-step.seconds / EASE);
        self.offsets.iter_mut().for_each(|offset| *offset *= keeps);
        if self.offsets.iter().all(|offset| offset.length_squared() < GONE * GONE) {
            return self.go_away();
        }
        for ((joint, turn), &offset) in step.rig.joints().zip(&mut self.turns).zip(&self.offsets) {
            *turn = (pose(joint) * Rotation::from_scaled_axis(offset)).normalize();
        }
    }

    fn go_away(&mut self) {
        self.mode = Mode::Away;
        self.turns.clear();
    }

    /// Returns true if the springs equal the pose and nothing is computed, because they have been eased for long
    /// enough.
    pub fn is_away(&self) -> bool {
        self.mode == Mode::Away
    }

    /// Returns true if the last update eased the springs, whether or not a rotation remains.
    pub fn is_eased(&self) -> bool {
        matches!(self.mode, Mode::Easing | Mode::Away)
    }

    /// Resumes eased springs, instead of the first [`step`](Self::step): they start at the eased rotations, with the
    /// motion of pose and root since the previous step.
    ///
    /// # Panics
    /// If a pose does not have one transform per joint of the springs' rig.
    pub fn take_up(&mut self, step: &SpringStep<'_>, earlier: &[LocalTransform], earlier_root: Affine) {
        self.ease(step);
        let rig = step.rig;
        if self.turns.is_empty() {
            self.turns.extend(rig.joints().map(|joint| step.pose[joint].rotation));
        }
        self.place_all(rig, earlier_root, |node| earlier[node.joint]);
        self.tips.clear();
        for index in 0..rig.bones.len() {
            let tip = self.placed_tip(rig, index);
            self.tips.push(tip);
        }
        self.earlier.clear();
        self.earlier.extend_from_slice(&self.at[..rig.stills]);
        let turns = core::mem::take(&mut self.turns);
        self.place_all(rig, step.world_from_model, |node| {
            let local = step.pose[node.joint];
            LocalTransform { rotation: node.bone.map_or(local.rotation, |bone| turns[bone]), ..local }
        });
        self.turns = turns;
        self.before.clear();
        self.before.extend_from_slice(&self.at[..rig.stills]);
        let ticks = if step.seconds > 0.0 { TICK / step.seconds } else { 0.0 };
        self.ways.clear();
        for index in 0..rig.bones.len() {
            let tip = self.placed_tip(rig, index);
            self.ways.push((tip - self.tips[index]) * ticks);
            self.tips[index] = tip;
        }
        (self.phase, self.stride) = (0.0, step.seconds);
        let finite = self.tips.iter().chain(&self.ways).all(|v: &Vec3| v.is_finite());
        self.mode = if finite { Mode::Swinging } else { Mode::Fresh };
    }
}
