//! The staged demo, which runs in a loop and carries out a user's instructions.

use sinew::math::{Reader, Vec3, Writer};
use sinew::ragdoll::State;
use sinew_scenes::fallen::fall_of_character;
use sinew_scenes::scenes::{Act, Instance, Metric};
use sinew_scenes::staged::{Sample, staged};

/// Every sample is pushed, falls, gets up, walks on, and begins again at the start, twice.
#[test]
fn samples_fall_get_up_and_begin_again() {
    for sample in Sample::ALL {
        let mut stage = staged(sample.character());
        let start = stage.steered().expect("the stage can be steered");
        let (mut lowest, mut begins) = (start.y, Vec::new());
        let mut before = start;
        for step in 0..60 * 40 {
            stage.step();
            let place = stage.steered().expect("the stage can be steered");
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

/// Takes steps for a time, seconds.
fn run(stage: &mut Instance, seconds: u32) {
    (0..60 * seconds).for_each(|_| stage.step());
}

fn state(stage: &Instance) -> State {
    stage.directed().expect("the stage carries out instructions").state()
}

/// Returns true if the character plays the clip of that index.
fn plays(stage: &Instance, clip: usize) -> bool {
    let character = stage.directed().expect("the stage carries out instructions");
    let id = character.def().clip(clip);
    character.animator().tracks().any(|track| track.def().clip == id)
}

/// The character on the stage goes limp and stays down, plays a clip where it lies, falls with muscles, gets up, and
/// walks as the user leads it.
#[test]
fn a_character_carries_out_instructions() {
    for mut stage in [staged(Sample::Mannequin.character()), fall_of_character(Sample::Mannequin.character())]
    {
        run(&mut stage, 1);
        stage.act(Act::Limp);
        run(&mut stage, 14);
        assert_eq!(state(&stage), State::Limp, "the character must stay down");
        stage.act(Act::Powered);
        run(&mut stage, 1);
        assert_ne!(state(&stage), State::Animated);
        stage.act(Act::Limp);
        let clips = stage.directed().expect("the stage carries out instructions").def().motions().clips.len();
        stage.act(Act::Play(clips as u32 - 1));
        run(&mut stage, 2);
        assert_eq!(state(&stage), State::Animated);
        assert!(plays(&stage, clips - 1), "the character must play its last clip");
        stage.act(Act::Powered);
        run(&mut stage, 1);
        assert_ne!(state(&stage), State::Animated);
        stage.act(Act::GetUp);
        run(&mut stage, 10);
        assert_eq!(state(&stage), State::Animated, "the character must be up");
        let before = stage.steered().expect("the stage can be steered");
        stage.steer(Vec3::X * 1.2);
        run(&mut stage, 3);
        let way = stage.steered().expect("the stage can be steered") - before;
        assert!(way.x > 1.5 && way.z.abs() < 1.0, "the character walked by {way}");
        // An instruction that does not exist changes nothing.
        stage.act(Act::Play(9999));
        run(&mut stage, 1);
        assert!(
            stage
                .metrics()
                .iter()
                .filter(|it| ["nan", "energy_gain_max"].contains(&it.name))
                .all(Metric::is_met)
        );
    }
}

/// An instruction is a part of a saved state.
#[test]
fn instructions_are_saved() {
    let mut stage = staged(Sample::Mannequin.character());
    run(&mut stage, 1);
    stage.act(Act::Limp);
    run(&mut stage, 2);
    stage.act(Act::Play(0));
    let mut out = Writer::new();
    stage.save(&mut out);
    let bytes = out.into_bytes();
    run(&mut stage, 3);
    let hash = stage.world().hash();
    stage.load(&mut Reader::new(&bytes)).expect("the saved state must load");
    run(&mut stage, 3);
    assert_eq!(stage.world().hash(), hash);
    assert!(plays(&stage, 0));
}
