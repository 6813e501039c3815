//! Every scene of the registry: its figures, and what they depend on.

use sinew_scenes::scenes::{Metric, Scene, find, registry};

fn metrics_after(scene: &Scene, gravity_factor: f32) -> Vec<Metric> {
    let mut run = scene.start_under(&scene.settings(), gravity_factor);
    for _ in 0..scene.steps {
        run.step();
    }
    run.metrics()
}

fn unmet(metrics: &[Metric]) -> Vec<&Metric> {
    metrics.iter().filter(|metric| !metric.is_met()).collect()
}

fn check(name: &str) {
    let scene = find(name).expect("the registry has it");
    let metrics = metrics_after(scene, 1.0);
    for metric in &metrics {
        println!("{name}: {} = {:?}, {:?}", metric.name, metric.value, metric.expected);
    }
    assert!(unmet(&metrics).is_empty(), "{name}: {:#?}", unmet(&metrics));
    for factor in [0.99, 1.01] {
        let wrong = metrics_after(scene, factor);
        let noticed = !unmet(&wrong).is_empty();
        // Weightless, it is the only one that gravity has no part in.
        assert_eq!(noticed, name != "zero_gravity_pile", "{name} under {factor} g: {wrong:#?}");
    }
}

/// One test for each scene of the registry, and one that none is forgotten.
macro_rules! scenes {
    ($($name:ident),* $(,)?) => {
        $(#[test] fn $name() { check(stringify!($name)); })*

        #[test]
        fn all_are_checked() {
            let names: Vec<_> = registry().iter().map(|scene| scene.name).collect();
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

scenes!(
    free_fall,
    projectile,
    bounce,
    pendulum,
    double_pendulum,
    chain,
    incline_holds,
    incline_slides,
    spring,
    spring_chain,
    zero_gravity_pile,
    stack,
    pyramid,
    dominoes,
    rope_on_box,
    ragdoll_drop,
    ragdoll_wall,
    stairs,
);
