//! Cloth worn by a character during a fall: its measurements, and the state of its wearer.

use crate::framework::metric::{Expected, Metric};
use sinew::math::{ReadError, Reader, Writer, max};
use sinew::physics::World;
use sinew::physics::particles::{AttachmentTarget, ParticleGroup};
use sinew::ragdoll::{Character, CharacterEvent};

/// Metrics of a wearer and its cloth since the start.
#[derive(Clone, Copy, Default)]
pub(super) struct Wear {
    /// Largest value over the steps of the threads' mean relative length error.
    stretch: f32,
    /// Sum over the steps of the threads' mean relative length error.
    stretch_sum: f32,
    /// Largest distance of an attached particle from its attachment, metres.
    pub torn: f32,
    /// Number of times that the wearer went limp.
    falls: u32,
    /// Time at which the wearer was up again, seconds; 0 before that.
    up: f32,
    /// Work of drives and of bodies that clips move, J.
    pub work_in: f32,
}

impl Wear {
    /// Adds the work of a step, updates the wearer, and records falls and get-ups.
    pub fn follow(&mut self, world: &mut World, wearer: &mut Character) {
        self.work_in += world.work().total();
        wearer.update(world);
        for event in wearer.events() {
            self.falls += u32::from(*event == CharacterEvent::WentLimp);
            if *event == CharacterEvent::Up {
                self.up = world.time() as f32;
            }
        }
    }

    /// Records the stretch of a step.
    pub fn note_stretch(&mut self, mean: f32) {
        self.stretch = max(self.stretch, mean);
        self.stretch_sum += mean;
    }

    /// Metrics of stretch and attachment, then of the wearer, which must be up within `up_within` seconds.
    pub fn metrics(&self, world: &World, up_within: f64) -> [Vec<Metric>; 2] {
        let mean = (world.step_count() > 0).then_some(self.stretch_sum / world.step_count() as f32);
        let up = (self.up > 0.0).then_some(self.up);
        [
            vec![
                Metric::awaited("stretch_mean", mean, Expected::AtMost(0.03)),
                Metric::new("stretch_mean_worst", self.stretch, Expected::Anything),
                Metric::new("held_off_m", self.torn, Expected::AtMost(1e-3)),
            ],
            vec![
                Metric::new("falls", self.falls, Expected::Near { value: 1.0, tolerance: 0.0 }),
                Metric::awaited("up_s", up, Expected::AtMost(up_within)),
            ],
        ]
    }

    pub fn save(&self, out: &mut Writer) {
        let Self { stretch, stretch_sum, torn, falls, up, work_in } = *self;
        [stretch, stretch_sum, torn, up, work_in].into_iter().for_each(|x| out.f32(x));
        out.u32(falls);
    }

    pub fn load(bytes: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut number = || bytes.f32();
        let (stretch, stretch_sum, torn) = (number()?, number()?, number()?);
        let (up, work_in) = (number()?, number()?);
        Ok(Self { stretch, stretch_sum, torn, falls: bytes.u32()?, up, work_in })
    }
}

/// Mean relative length error of the first `threads` springs, which are the threads.
pub(super) fn stretch(group: &ParticleGroup, threads: usize) -> f32 {
    let positions = group.positions();
    let off = group.springs()[..threads].iter().map(|thread| {
        let length = (positions[thread.b as usize] - positions[thread.a as usize]).length();
        (length / thread.rest_length - 1.0).abs()
    });
    off.sum::<f32>() / threads as f32
}

/// Largest distance of an attached particle from its attachment, metres.
pub(super) fn torn(world: &World, group: &ParticleGroup) -> f32 {
    let off = group.attachments().iter().map(|held| match held.target {
        AttachmentTarget::Body { body, point } => {
            (world.transform(body).point(point) - group.positions()[held.particle as usize]).length()
        }
        AttachmentTarget::World(_) => f32::INFINITY,
    });
    off.fold(0.0, max)
}
