//! Measurements in `DiagnosticsStore`.

use super::*;
use bevy_diagnostic::{DiagnosticPath, DiagnosticsPlugin, DiagnosticsStore};

#[test]
fn step_time_is_measured() {
    let mut app = app();
    app.add_plugins((DiagnosticsPlugin, SinewDiagnosticsPlugin));
    ground(&mut app);
    for i in 0..3 {
        app.world_mut().spawn(ball(Vec3::new(i as f32, 1.0, 0.0)));
    }
    let value = |app: &App, path: &DiagnosticPath| {
        let store = app.world().resource::<DiagnosticsStore>();
        store.get(path).and_then(|diagnostic| diagnostic.value()).expect("the value was measured")
    };
    run(&mut app, 5);
    let counts = |app: &App| {
        [SinewDiagnosticsPlugin::AWAKE, SinewDiagnosticsPlugin::CONTACTS].map(|path| value(app, &path))
    };
    assert_eq!(counts(&app), [3.0, 0.0], "they fall");
    let step = value(&app, &SinewDiagnosticsPlugin::STEP);
    assert!(step > 0.0 && step < 1e3, "{step} ms");
    run(&mut app, 25);
    assert_eq!(counts(&app), [3.0, 3.0], "they lie");
    run(&mut app, 300);
    assert_eq!(counts(&app)[0], 0.0, "they sleep");
}
