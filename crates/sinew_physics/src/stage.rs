//! Stages of a step, with the names that functions, modules, profile zones and `docs/step.md` use, and the quantities
//! that each step counts.

/// A stage of the step, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Stage {
    /// Broad phase: candidate shape pairs.
    Pairs,
    /// Narrow phase: manifolds of near shapes.
    Collide,
    /// Begin and end of touches; wakes bodies.
    Touch,
    /// Islands: sets of connected bodies.
    Islands,
    /// Order in which an island's contacts are solved.
    Color,
    /// Bodies without contacts and joints.
    Flight,
    /// Converts bodies, joints and contacts to the solver's own arrays.
    Prepare,
    /// Integrates forces to velocities.
    IntegrateVelocity,
    /// Applies the impulses of contacts and limits of the last substep.
    WarmStart,
    /// Solves joints exactly, contacts and limits with bias.
    Solve,
    /// Integrates velocities to poses.
    IntegratePosition,
    /// Projects particles onto constraints and out of shapes.
    Project,
    /// Solves joints, contacts and limits without bias, and friction.
    Relax,
    /// Makes bodies bounce that were hit in the substep.
    Restitution,
    /// Stores impulses for the next step.
    Store,
    /// Writes the new state to the bodies; quarantines bodies with numeric trouble.
    Finalize,
    /// Stops fast bodies that would pass through static ones.
    Continuous,
    /// Puts islands at rest to sleep.
    Sleep,
    /// Sensor overlaps.
    Sensors,
    /// Character movers, among bodies at their new poses.
    Movers,
}

/// Quantity that a step counts for a [`Profiler`] that requests counts. The thread that solves an island reports each
/// quantity from [`Bodies`](Self::Bodies) on, once per island, `Bodies` first. A free-flying body has only `Bodies` and
/// [`BodySubsteps`](Self::BodySubsteps).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Counter {
    /// Shapes of all bodies, awake or not.
    Shapes,
    /// Pairs of near shapes of which at least one is awake.
    Pairs,
    /// Pairs of near shapes, at least one of them awake, that have contact points.
    PairsWithPoints,
    /// Moving bodies of an island: one call per island.
    Bodies,
    /// Moving bodies of an island, counted in each substep.
    BodySubsteps,
    /// Joints of an island.
    Joints,
    /// Contacts that an island solves.
    Manifolds,
    /// Points of these contacts.
    Points,
    /// Rows of joint limits in the island's last substep.
    LimitRows,
    /// Manifolds and limit rows of one pass, counted in each substep: the work of one sweep.
    PassRows,
    /// Rows that all sweeps of `solve` visited. Divided by `PassRows`, the number of sweeps of a pass.
    SolveRows,
    /// Rows that all sweeps of `relax` visited.
    RelaxRows,
    /// Rows that sweeps solved, over all passes; excludes inactive rows, which sweeps only visit.
    Visits,
    /// Used bytes of the solver's arrays for the island. Bytes beyond the size of the cache come from memory.
    ResidentBytes,
    /// Bytes of these arrays that the step accessed: all of them in `prepare`, twice in each substep (poses change) and
    /// in `store`, and for each solved row the row and the velocities of its two bodies. Excludes the bytes that sweeps
    /// write to other bodies of a tree.
    TouchedBytes,
}

/// Receives stage times and counts from the step: the library reads no clock. The thread that runs an island reports
/// the stages inside the island.
pub trait Profiler: Sync {
    /// A stage starts.
    fn begin(&self, stage: Stage);
    /// The stage last started on this thread ends.
    fn end(&self, stage: Stage);
    /// True if the profiler requests counts; otherwise the step does not count.
    fn is_counting(&self) -> bool {
        false
    }
    /// Adds `by` to a quantity of this step; only called for a counting profiler.
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
