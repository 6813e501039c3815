//! Scales a kind of character.

use super::{CharacterDef, HitBodies, Locomotion, MotionSet, Toughness};
use crate::def::RagdollDef;
use crate::doctor::scaled;
use sinew_anim::garments::Backstop;
use sinew_anim::{Animator, Garment, LocalTransform, local_to_model};
use sinew_math::{Affine, Transform, Vec3, max, max3};
use sinew_physics::Yields;

/// Number of times within a clip at which the distance of the bodies from the mover's axis is measured.
const MOMENTS: u16 = 64;

impl CharacterDef {
    /// Returns the radius of a mover that keeps all of the character's bodies on its side of a wall while the looped
    /// clip plays, metres: the largest distance of the bodies from the mover's vertical axis. 0 without such a clip.
    /// The default mover is narrower so that it passes doors; beside a wall a hand may therefore be in the wall for
    /// part of each swing.
    pub fn swept_radius(&self) -> f32 {
        let Some(looped) = self.motions().looped else { return 0.0 };
        let duration = self.set().clip(self.clip(looped)).clip.duration();
        let (mut model, mut bodies, mut farthest) = (Vec::new(), Vec::new(), 0.0);
        for moment in 0..MOMENTS {
            let mut animator = Animator::new(self.set());
            self.play_looped(&mut animator, duration * f32::from(moment) / f32::from(MOMENTS));
            animator.update(self.set(), 0.0);
            let pose: Vec<LocalTransform> = animator.pose().iter().collect();
            local_to_model(&self.rig, &pose, &Affine::IDENTITY, &mut model);
            self.mapping().bodies_from_model(&model, Transform::IDENTITY, &mut bodies);
            for (pose, body) in bodies.iter().zip(&self.ragdoll.bodies) {
                let bounds = body.shape.aabb(pose);
                let far = max3(-bounds.min, bounds.max);
                farthest = max(farthest, Vec3::new(far.x, 0.0, far.z).length());
            }
        }
        farthest
    }

    /// Returns this definition scaled by `factor` (1: unchanged), for instance for a child or a giant. Lengths and the
    /// speeds of walk and springs scale with `factor`, masses and forces with its third power, torques with its fourth.
    /// All characters of that size can share the definition.
    ///
    /// # Panics
    /// If the factor is not above 0 and finite.
    pub fn scaled(&self, factor: f32) -> Self {
        assert!(
            factor > 0.0 && factor < f32::INFINITY,
            "the scale factor must be positive and finite, not {factor}"
        );
        let mut def = Self::new(self.rig.clone(), larger(&self.ragdoll, factor), &self.bind_model());
        def.set_springs(self.springs().source());
        let wider = |garment: &Garment| Garment {
            radius: garment.radius * factor,
            spacing: garment.spacing * factor,
            thickness: garment.thickness * factor,
            backstop: garment.backstop.map(|backstop| Backstop {
                distance: backstop.distance * factor,
                radius: backstop.radius * factor,
            }),
            // The garment then stretches and bends under its own weight by the same share of its size as before.
            stretching: garment.stretching * factor,
            shearing: garment.shearing * factor,
            bending: garment.bending * factor * factor * factor,
            ..garment.clone()
        };
        def.set_garments(&self.garments().source().iter().map(wider).collect::<Vec<_>>());
        def.after_settling = self.after_settling;
        def.getting_ready = self.getting_ready;
        def.falling = self.falling;
        def.patience = self.patience;
        def.body_settings = self.body_settings;
        def.body_settings.material.rolling *= factor;
        def.speed_bound = self.speed_bound;
        def.in_world = self.in_world.clone();
        let cube = factor * factor * factor;
        if let Some(mover) = &mut def.in_world.mover {
            mover.radius *= factor;
            mover.height *= factor;
            mover.step_height *= factor;
            mover.skin *= factor;
            mover.mass *= cube;
            mover.push_force *= cube;
            mover.lets_pass *= cube;
        }
        if let HitBodies::Present(Yields { max_force, max_impulse }) = &mut def.in_world.hit_bodies {
            *max_force *= cube;
            *max_impulse *= cube;
        }
        if let Toughness::Impulse(least) = &mut def.in_world.toughness {
            *least *= cube;
        }
        def.in_world.feels *= cube;
        let mut motions: MotionSet = self.motions().clone();
        if let Locomotion::Forward { speed } = &mut motions.locomotion {
            *speed *= factor;
        }
        def.set_motions(motions).expect("scaling does not make a clip invalid");
        def
    }
}

fn larger(def: &RagdollDef, factor: f32) -> RagdollDef {
    let (square, mut def) = (factor * factor, def.clone());
    let cube = square * factor;
    let place = |at: Transform| Transform { translation: at.translation * factor, ..at };
    for body in &mut def.bodies {
        body.character_from_body = place(body.character_from_body);
        body.shape = scaled(&body.shape, factor);
        body.mass.mass *= cube;
        body.mass.center *= factor;
        body.mass.inertia = body.mass.inertia * (cube * square);
    }
    for joint in &mut def.joints {
        joint.frame_parent = place(joint.frame_parent);
        joint.frame_child = place(joint.frame_child);
        joint.friction_torque *= square * square;
    }
    def.total_mass *= cube;
    def.height *= factor;
    def.unit_scale *= factor;
    def.character_from_model = place(def.character_from_model);
    def
}
