//! The demo in a loop.

use sinew_scenes::staged::{Sample, staged};

/// Every sample is pushed, falls, gets up, walks on, and begins again at the start, twice.
#[test]
fn samples_fall_get_up_and_begin_again() {
    for sample in Sample::ALL {
        let mut stage = staged(sample.character());
        let start = stage.steered().expect("it can be led");
        let (mut lowest, mut begins) = (start.y, Vec::new());
        let mut before = start;
        for step in 0..60 * 40 {
            stage.step();
            let place = stage.steered().expect("it can be led");
            lowest = f32::min(lowest, place.y);
            if (place - start).length() < 0.1 && (before - start).length() > 1.0 {
                begins.push(step / 60);
            }
            before = place;
        }
        println!("{}: begins again after {begins:?} s", sample.name());
        assert!(begins.len() >= 2, "{}: {begins:?}", sample.name());
        assert!(lowest < start.y - 1.0, "{} does not leave the porch", sample.name());
    }
}
