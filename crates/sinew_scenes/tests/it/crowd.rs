//! The scene `crowd`: a restored run continues with the same bits, and steps of a walking crowd allocate nothing.

use sinew::math::{Reader, Writer};
use sinew_scenes::scenes::{Instance, find};

fn started(assignments: &[&str]) -> Instance {
    let scene = find("crowd").expect("the scene is registered");
    let mut settings = scene.settings();
    assignments.iter().for_each(|assignment| settings.assign(assignment).expect("the scene has the setting"));
    scene.start(&settings)
}

fn bytes(run: &Instance) -> Vec<u8> {
    let mut saved = Writer::new();
    run.save(&mut saved);
    saved.into_bytes()
}

fn metric_value(run: &Instance, name: &str) -> f64 {
    let metrics = run.metrics();
    let metric = metrics.iter().find(|metric| metric.name == name).expect("the scene has the metric");
    metric.value.expect("the metric has a value")
}

#[test]
fn saved_crowd_continues_equally() {
    let mut run = started(&["n=6", "waves=2"]);
    let mut seen = [0.0; 4];
    for moment in [20, 60, 130, 190, 240, 300, 330, 400, 460] {
        while run.world().step_count() < moment {
            run.step();
            for (most, state) in seen.iter_mut().zip(["animated", "limp", "preparing", "getting_up"]) {
                *most = f64::max(*most, metric_value(&run, state));
            }
        }
        let saved = bytes(&run);
        let mut other = started(&["n=6", "waves=2"]);
        other.load(&mut Reader::new(&saved)).expect("the saved state must load");
        assert_eq!(bytes(&other), saved, "at step {moment}");
        for _ in 0..90 {
            run.step();
            other.step();
        }
        assert_eq!(bytes(&other), bytes(&run), "from step {moment}");
        run.load(&mut Reader::new(&saved)).expect("the saved state must load");
        for length in (0..saved.len()).step_by(1_009) {
            assert!(other.load(&mut Reader::new(&saved[..length])).is_err(), "{length} bytes");
        }
    }
    assert!(seen.iter().all(|&most| most > 0.0), "a state did not occur: {seen:?}");
}

#[test]
fn walking_crowd_allocates_nothing() {
    // The run ends before the first hit.
    let mut run = started(&["n=5"]);
    (0..14).for_each(|_| run.step());
    let counted = allocation_counter::measure(|| (0..30).for_each(|_| run.step()));
    assert_eq!(counted.count_total, 0, "steps of a walking crowd must allocate nothing: {counted:?}");
}
