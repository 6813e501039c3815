//! Test of the printed programs: they have the same effect as their lives.

use crate::deeds;
use crate::life::{Act, Ground, Life};
use crate::numbers::{Numbers, Taste, Temper};
use crate::run::{program, run};
use sinew_physics::WorldDef;
use std::path::Path;

/// The stored program.
#[allow(
    unused,
    clippy::all,
    reason = "the printed program imports names that it may not use, and is not formatted"
)]
mod kept {
    include!("program.txt");
}

/// Seed of a life with few particles.
const SEED: u64 = 8;

/// Returns a life that does each deed before its first step, so that the printed text does not depend on steps.
fn of_each_deed() -> Life {
    let mut n = Numbers::new(SEED, Taste::Any, Temper::Calm);
    let is_maker = |name| deeds::MAKERS.contains(&name) && name != "add_particles";
    let all = deeds::all();
    let made = all.iter().filter(|deed| is_maker(deed.name)).cycle().take(10);
    let acts = made.chain(&all).map(|deed| Act { step: 0, number: n.bits(), deed }).collect();
    let (taste, temper, ground) = (Taste::Any, Temper::Calm, Ground::HalfSpace);
    Life { taste, temper, ground, def: WorldDef::default(), acts, steps: 45 }
}

/// The file `program.txt`, which this test compiles, equals the printed text and has the effect of the life. With
/// `SINEW_BLESS` set, the test writes the file.
#[test]
fn printed_program_has_the_effect_of_its_life() {
    let life = of_each_deed();
    let outcome = run(&life, None, true);
    assert_eq!(outcome.result, Ok(()));
    let lines = outcome.program.expect("the run must return the requested program");
    let text = program(&life, &lines);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/lives/program.txt");
    if std::env::var_os("SINEW_BLESS").is_some() {
        std::fs::write(&path, text).expect("`program.txt` must be writable");
        return;
    }
    let kept = std::fs::read_to_string(&path).expect("`program.txt` must be readable");
    assert!(kept == text, "the printed program differs from `program.txt`; SINEW_BLESS=1 writes it anew");
    assert_eq!(kept::program().hash(), outcome.hash, "the program must end in the same state");
}
