//! The stages of a step, by the one name that function, module, profile zone and `docs/step.md` share, and what can be
//! counted in them.

/// A stage of the step, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Stage {
    /// Broad phase: shapes that may meet.
    Pairs,
    /// Narrow phase: manifolds of shapes that meet.
    Collide,
    /// Who began and who stopped touching; who wakes.
    Touch,
    /// Islands: bodies that hang together.
    Islands,
    /// In which order an island's contacts are solved.
    Color,
    /// Bodies that nothing touches or holds.
    Flight,
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
    /// Character movers, among bodies that have come to where they are.
    Movers,
}

/// Quantity that a step counts for a [`Profiler`] that asks for it. From [`Bodies`](Self::Bodies) on each is told once for every
/// island by the thread that solves it, `Bodies` first; of a body in flight, [`BodySubsteps`](Self::BodySubsteps) alone follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Counter {
    /// Shapes of all bodies, awake or not.
    Shapes,
    /// Pairs of shapes near each other of which one is awake.
    Pairs,
    /// Pairs of shapes near each other, one of them awake, that have contact points.
    PairsWithPoints,
    /// Moving bodies of an island: as many calls as there are islands.
    Bodies,
    /// Moving bodies, once for each substep that their island took.
    BodySubsteps,
    /// Joints of an island.
    Joints,
    /// Contacts that an island solves.
    Manifolds,
    /// Points of these contacts.
    Points,
    /// Rows of joint limits in the island's last substep.
    LimitRows,
    /// Manifolds and limit rows of a pass, once for each substep: what one sweep goes through.
    PassRows,
    /// Rows that all sweeps of `solve` went through: over `PassRows`, it is the sweeps of a pass.
    SolveRows,
    /// Rows that all sweeps of `relax` went through.
    RelaxRows,
    /// Rows that sweeps visited, of all passes: those that lay still were gone through only.
    Visits,
    /// Bytes of the solver's arrays for the island, as they are filled: more than the cache holds comes from memory.
    ResidentBytes,
    /// Bytes of these that the step went over: all of them in `prepare`, twice in each substep (poses change) and in `store`,
    /// and for each visit a row and the velocities of its two bodies. What sweeps push onto other bodies of a tree is not in it.
    TouchedBytes,
}

/// Receives stage times and counts from the step: the library reads no clock itself. Stages inside an island are reported
/// by the thread that runs it.
pub trait Profiler: Sync {
    /// A stage begins.
    fn begin(&self, stage: Stage);
    /// The stage that began last on this thread ends.
    fn end(&self, stage: Stage);
    /// True if it wants counts; else none are made.
    fn is_counting(&self) -> bool {
        false
    }
    /// There are `by` more of what is counted in this step; only told to one that is counting.
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
