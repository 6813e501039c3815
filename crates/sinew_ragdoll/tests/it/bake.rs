//! A whole run, from walk to walk.

use crate::actor::{floor, shared, walker};
use sinew_math::Vec3;
use sinew_ragdoll::{BakeInput, Hit, bake, drop_test};

#[test]
fn look() {
    let def = shared(walker());
    let bodies = [floor()];
    let chest = def.body_named("chest").expect("it has a chest");
    let hits = [Hit { time: 1.0, body: chest, impulse: Vec3::new(0.0, 0.0, -80.0) }];
    let start = std::time::Instant::now();
    let baked =
        bake(&BakeInput { bodies: &bodies, hits: &hits, seconds: 14.0, ..BakeInput::new(def.clone()) });
    eprintln!("{:?} {:#?}", start.elapsed(), baked.quality);
    for (t, e) in &baked.events {
        eprintln!("{t:.3} {e:?}");
    }
    let start = std::time::Instant::now();
    let report = drop_test(&def.ragdoll);
    eprintln!("{:?} {:#?}", start.elapsed(), report);
}
