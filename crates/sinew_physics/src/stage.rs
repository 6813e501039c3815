//! The stages of a step, by the one name that function, module, profile zone and `docs/step.md` share.

/// A stage of the step, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Stage {
    /// Which shapes may meet.
    Pairs,
    /// Where they meet: manifolds.
    Collide,
    /// Who began and who stopped touching; who wakes.
    Touch,
    /// Which bodies hang together.
    Islands,
    /// In which order an island's contacts are solved.
    Color,
    /// From bodies, joints and contacts to the solver's own arrays.
    Prepare,
    /// Forces to velocities.
    IntegrateVelocity,
    /// Last substep's contact and limit impulses.
    WarmStart,
    /// Joints exactly, contacts and limits with bias.
    Solve,
    /// Velocities to poses.
    IntegratePosition,
    /// Particles against constraints and shapes.
    Project,
    /// Joints, contacts and limits without bias; friction.
    Relax,
    /// Bounce of what was hit in the substep.
    Restitution,
    /// Impulses kept for the next step.
    Store,
    /// Bodies take their new state; numeric trouble is quarantined.
    Finalize,
    /// Fast bodies are stopped at what they would pass.
    Continuous,
    /// Islands at rest fall asleep.
    Sleep,
    /// Who is inside whom.
    Sensors,
}

/// Receives stage times from the step: the library reads no clock itself. Stages inside an island are reported by
/// the thread that runs it.
pub trait Profiler: Sync {
    /// A stage begins.
    fn begin(&self, stage: Stage);
    /// The stage that began last on this thread ends.
    fn end(&self, stage: Stage);
}

/// Measures nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProfiler;

impl Profiler for NoProfiler {
    fn begin(&self, _: Stage) {}
    fn end(&self, _: Stage) {}
}

/// Runs `work` as a zone of `stage`.
pub(crate) fn zone<R>(profiler: &dyn Profiler, stage: Stage, work: impl FnOnce() -> R) -> R {
    profiler.begin(stage);
    let result = work();
    profiler.end(stage);
    result
}
