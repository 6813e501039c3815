//! Measurements of the physics for Bevy's `DiagnosticsStore`.

use crate::{Physics, PhysicsSystems};
use bevy_app::{App, FixedPostUpdate, Plugin};
use bevy_diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic};
use bevy_ecs::prelude::*;
use bevy_platform::time::Instant;

/// Measures each step: its time, the number of awake bodies, and the number of contacts. Needs Bevy's
/// `DiagnosticsPlugin`, included in `DefaultPlugins`; its `LogDiagnosticsPlugin` prints them.
#[derive(Clone, Copy, Debug, Default)]
pub struct SinewDiagnosticsPlugin;

impl SinewDiagnosticsPlugin {
    /// Time of a step of the world, ms.
    pub const STEP: DiagnosticPath = DiagnosticPath::const_new("sinew/step");
    /// Number of dynamic bodies that are awake.
    pub const AWAKE: DiagnosticPath = DiagnosticPath::const_new("sinew/awake");
    /// Number of contacts, including near ones without touch.
    pub const CONTACTS: DiagnosticPath = DiagnosticPath::const_new("sinew/contacts");
}

impl Plugin for SinewDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        app.register_diagnostic(Diagnostic::new(Self::STEP).with_suffix(" ms"));
        app.register_diagnostic(Diagnostic::new(Self::AWAKE).with_suffix(" bodies"));
        app.register_diagnostic(Diagnostic::new(Self::CONTACTS).with_suffix(" contacts"));
        app.insert_resource(Began(Instant::now()));
        let begin = begin.after(PhysicsSystems::Prepare).before(PhysicsSystems::Step);
        let measure = measure.after(PhysicsSystems::Step).before(PhysicsSystems::Tell);
        app.add_systems(FixedPostUpdate, (begin, measure));
    }
}

/// Start time of the step.
#[derive(Resource)]
struct Began(Instant);

fn begin(mut began: ResMut<Began>) {
    began.0 = Instant::now();
}

fn measure(physics: Res<Physics>, began: Res<Began>, mut diagnostics: Diagnostics) {
    let time = began.0.elapsed();
    let is_awake = |body: &sinew_physics::BodyRef<'_>| {
        body.kind() == sinew_physics::BodyKind::Dynamic && body.is_awake()
    };
    diagnostics.add_measurement(&SinewDiagnosticsPlugin::STEP, || time.as_secs_f64() * 1e3);
    diagnostics
        .add_measurement(&SinewDiagnosticsPlugin::AWAKE, || physics.bodies().filter(is_awake).count() as f64);
    diagnostics.add_measurement(&SinewDiagnosticsPlugin::CONTACTS, || physics.contacts().count() as f64);
}
