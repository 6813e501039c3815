//! Stages of a step, and the quantities counted in them. Function, module, profile zone and `docs/step.md` use the same
//! names.

/// A stage of the step, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Stage {
    /// Broad phase: finds candidate shape pairs.
    Pairs,
    /// Narrow phase: computes manifolds of near shapes.
    Collide,
    /// Finds the begin and end of touches; wakes bodies.
    Touch,
    /// Finds the islands of connected bodies.
    Islands,
    /// Determines the order in which an island's contacts are solved.
    Color,
    /// Steps bodies without contacts and joints.
    Flight,
    /// Converts bodies, joints and contacts to the solver's own arrays.
    Prepare,
    /// Applies forces to velocities.
    IntegrateVelocity,
    /// Applies the contact and limit impulses of the last substep.
    WarmStart,
    /// Solves joints exactly, contacts and limits with bias.
    Solve,
    /// Applies velocities to poses.
    IntegratePosition,
    /// Moves particles according to their constraints and shapes.
    Project,
    /// Solves joints, contacts and limits without bias, and friction.
    Relax,
    /// Bounces bodies hit in the substep.
    Restitution,
    /// Stores impulses for the next step.
    Store,
    /// Writes the new state to the bodies; quarantines non-finite bodies.
    Finalize,
    /// Stops fast bodies that would pass through static ones.
    Continuous,
    /// Puts islands at rest to sleep.
    Sleep,
    /// Reports sensor overlaps.
    Sensors,
    /// Moves character movers among bodies at their new poses.
    Movers,
}

/// Quantity that a step counts for a [`Profiler`] that requests it. [`Bodies`](Self::Bodies) and the quantities after
/// it are reported once per island by the thread that solves it, `Bodies` first. A free-flying body only has
/// [`BodySubsteps`](Self::BodySubsteps) after that.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Counter {
    /// Shapes of all bodies, awake or not.
    Shapes,
    /// Pairs of near shapes, at least one of them awake.
    Pairs,
    /// Pairs of near shapes, at least one of them awake, that have contact points.
    PairsWithPoints,
    /// Moving bodies of an island: one call per island.
    Bodies,
    /// Moving bodies, once per substep of their island.
    BodySubsteps,
    /// Joints of an island.
    Joints,
    /// Contacts that an island solves.
    Manifolds,
    /// Points of the contacts that an island solves.
    Points,
    /// Rows of joint limits in the island's last substep.
    LimitRows,
    /// Manifolds and limit rows of a pass, once per substep: the rows of one sweep.
    PassRows,
    /// Rows that all sweeps of `solve` visited. Divided by `PassRows`, this is the number of sweeps of a pass.
    SolveRows,
    /// Rows that all sweeps of `relax` visited.
    RelaxRows,
    /// Rows that sweeps solved, over all passes; inactive rows are only visited.
    Visits,
    /// Used bytes of the solver's arrays for the island. If they exceed the cache, the rest is read from memory.
    ResidentBytes,
    /// Bytes of these arrays that the step accessed: all of them in `prepare`, twice in each substep (poses change) and
    /// in `store`, and for each solved row the row and the velocities of its two bodies. Excludes the writes of sweeps
    /// to other bodies of a tree.
    TouchedBytes,
}

/// Receives stage times and counts from the step: the library itself reads no clock. Stages inside an island are reported
/// by the thread that runs it.
pub trait Profiler: Sync {
    /// Starts a stage.
    fn begin(&self, stage: Stage);
    /// Ends the stage last started on this thread.
    fn end(&self, stage: Stage);
    /// True if the profiler requests counts; otherwise the step counts nothing.
    fn is_counting(&self) -> bool {
        false
    }
    /// Adds `by` to a quantity of this step. The step calls this only for a counting profiler.
    fn count(&self, _counter: Counter, _by: u64) {}
}

/// A profiler that measures nothing.
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
