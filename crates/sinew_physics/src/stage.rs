//! The stages of a step, under the one name that function, module, profile zone and `docs/step.md` share, and the
//! quantities counted in them.

/// A stage of the step, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Stage {
    /// Broad phase: candidate shape pairs.
    Pairs,
    /// Narrow phase: manifolds of near shapes.
    Collide,
    /// Begin and end of touches; waking.
    Touch,
    /// Islands: connected bodies.
    Islands,
    /// Determines the order in which an island's contacts are solved.
    Color,
    /// Bodies that nothing touches or holds.
    Flight,
    /// Converts bodies, joints and contacts to the solver's own arrays.
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
    /// Bounce of bodies hit in the substep.
    Restitution,
    /// Impulses stored for the next step.
    Store,
    /// Bodies take their new state; numeric trouble is quarantined.
    Finalize,
    /// Stops fast bodies that would pass through static ones.
    Continuous,
    /// Islands at rest fall asleep.
    Sleep,
    /// Sensor overlaps.
    Sensors,
    /// Character movers, among bodies at their new poses.
    Movers,
}

/// Quantity that a step counts for a [`Profiler`] that requests it. From [`Bodies`](Self::Bodies) on each is reported
/// once per island by the thread that solves it, `Bodies` first; a free-flying body only has
/// [`BodySubsteps`](Self::BodySubsteps) after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Counter {
    /// Shapes of all bodies, awake or not.
    Shapes,
    /// Pairs of near shapes of which one is awake.
    Pairs,
    /// Pairs of near shapes, one of them awake, that have contact points.
    PairsWithPoints,
    /// Moving bodies of an island: one call per island.
    Bodies,
    /// Moving bodies, once per substep of their island.
    BodySubsteps,
    /// Joints of an island.
    Joints,
    /// Contacts that an island solves.
    Manifolds,
    /// Points of these contacts.
    Points,
    /// Rows of joint limits in the island's last substep.
    LimitRows,
    /// Manifolds and limit rows of a pass, once per substep: the work of one sweep.
    PassRows,
    /// Rows that all sweeps of `solve` went through: over `PassRows`, it is the sweeps of a pass.
    SolveRows,
    /// Rows that all sweeps of `relax` went through.
    RelaxRows,
    /// Rows that sweeps solved, over all passes: inactive rows were only visited.
    Visits,
    /// Used bytes of the solver's arrays for the island: more than the cache holds comes from memory.
    ResidentBytes,
    /// Bytes of these that the step accessed: all of them in `prepare`, twice in each substep (poses change) and in
    /// `store`, and for each solved row the row and the velocities of its two bodies. Excludes what sweeps write to
    /// other bodies of a tree.
    TouchedBytes,
}

/// Receives stage times and counts from the step: the library reads no clock itself. Stages inside an island are reported
/// by the thread that runs it.
pub trait Profiler: Sync {
    /// A stage starts.
    fn begin(&self, stage: Stage);
    /// The stage last started on this thread ends.
    fn end(&self, stage: Stage);
    /// True if it requests counts; else none are made.
    fn is_counting(&self) -> bool {
        false
    }
    /// Adds `by` to a quantity of this step; only called for a counting profiler.
    fn count(&self, _counter: Counter, _by: u64) {}
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
