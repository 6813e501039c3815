//! Tests of events in files beside clips and inside glTF.

use crate::data::bar;
use sinew_anim::{Clip, ClipEvent, EventPolicy, FiredBy};
use sinew_formats::{
    ErrorKind, ReadOptions, append_clip, events_extras, no_files, read_events, read_gltf, write_events,
    write_motion,
};

fn clips() -> Vec<Clip> {
    let clip = |name: &str, duration| Clip { name: name.into(), duration, channels: Vec::new() };
    vec![clip("walk", 1.0), clip("run", 0.5), clip("", 2.0), clip("run", 0.75)]
}

fn punch() -> ClipEvent {
    ClipEvent {
        time: 0.1,
        name: "punch".into(),
        payload: "{\"damage\": 3}".into(),
        policy: EventPolicy { min_weight: 0.25, fired_by: FiredBy::OnePerGroup, on_interrupt: true },
    }
}

#[test]
fn written_text_reads_back_equal() {
    let left = ClipEvent { payload: "left".into(), ..ClipEvent::new(0.3, "footstep") };
    let events = vec![vec![punch(), left], Vec::new(), vec![ClipEvent::new(2.0, "end")], vec![punch()]];
    let text = write_events(&clips(), &events);
    assert!(text.starts_with("{\n  \"sinew\": \"events\",\n  \"version\": 1,"), "{text}");
    let read = read_events(text.as_bytes(), &clips()).unwrap();
    let wanted = [Some(events[0].clone()), None, Some(events[2].clone()), Some(events[3].clone())];
    assert_eq!(read, wanted);
}

#[test]
fn events_are_sorted_by_time() {
    let text = r#"{"sinew":"events","version":1,"clips":[{"clip":0,"events":[
        {"time":0.5,"name":"b"},{"time":0.25,"name":"a"},{"time":0.5,"name":"c"}]}]}"#;
    let read = read_events(text.as_bytes(), &clips()).unwrap();
    let names: Vec<&str> = read[0].as_ref().unwrap().iter().map(|event| event.name.as_str()).collect();
    assert_eq!(names, ["a", "b", "c"]);
}

#[test]
fn invalid_values_are_rejected_with_their_place() {
    let refused = |text: &str, what: &str, place: &str| {
        let error = read_events(text.as_bytes(), &clips()).unwrap_err();
        assert!(error.what.contains(what) && error.where_ == place, "{text}: {error}");
    };
    let of_walk = |event: &str| {
        format!(r#"{{"sinew":"events","version":1,"clips":[{{"clip":"walk","events":[{event}]}}]}}"#)
    };
    let at = |field: &str| format!("clips[0].events[0].{field}");
    refused(&of_walk(r#"{"time":1.5,"name":"a"}"#), "after the end of the clip", &at("time"));
    refused(&of_walk(r#"{"time":-1,"name":"a"}"#), "negative", &at("time"));
    refused(&of_walk(r#"{"time":1e99,"name":"a"}"#), "too large", &at("time"));
    refused(&of_walk(r#"{"time":0,"name":""}"#), "needs a name", &at("name"));
    refused(&of_walk(r#"{"time":0,"name":"a","min_weight":2}"#), "between 0 and 1", &at("min_weight"));
    refused(&of_walk(r#"{"time":0,"name":"a","fired_by":"me"}"#), "`me` is none of", &at("fired_by"));
    refused(&of_walk(r#"{"time":0,"name":"a","wieght":1}"#), "unknown key `wieght`", "clips[0].events[0]");
    refused(&of_walk(r#"{"name":"a"}"#), "`time` is missing", "clips[0].events[0]");
    let of_clip =
        |clip: &str| format!(r#"{{"sinew":"events","version":1,"clips":[{{"clip":{clip},"events":[]}}]}}"#);
    refused(&of_clip("\"swim\""), "no clip is called `swim`", "clips[0].clip");
    refused(&of_clip("\"run\""), "several clips are called `run`", "clips[0].clip");
    refused(&of_clip("4"), "out of range", "clips[0].clip");
    refused(r#"{"sinew":"world","version":1,"clips":[]}"#, "this is a `world` file", "sinew");
    refused(r#"{"sinew":"events","version":2,"clips":[]}"#, "newer", "version");
}

#[test]
fn every_truncation_is_rejected() {
    let text = write_events(&clips(), &[vec![punch()], vec![], vec![], vec![]]);
    for length in 0..text.trim_end().len() {
        let error = read_events(&text.as_bytes()[..length], &clips()).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Malformed);
        assert_ne!(error.where_, "");
    }
}

#[test]
fn events_in_animation_extras_are_read() {
    let (rig, clip) = bar();
    let bytes = write_motion(&rig, std::slice::from_ref(&clip), &[vec![punch()]]).unwrap();
    let document = read_gltf(&bytes, ReadOptions::default(), &mut no_files).unwrap();
    assert_eq!(document.events, [vec![punch()]]);
    let more =
        append_clip(&document, &document.clips[0], "again", events_extras(&[ClipEvent::new(0.2, "clap")]));
    let document = read_gltf(&more.unwrap(), ReadOptions::default(), &mut no_files).unwrap();
    assert_eq!(document.events, [vec![punch()], vec![ClipEvent::new(0.2, "clap")]]);
    // Unknown extras are ignored.
    let foreign = append_clip(&document, &document.clips[0], "x", Some("text".into())).unwrap();
    assert!(read_gltf(&foreign, ReadOptions::default(), &mut no_files).unwrap().events[2].is_empty());
    let bare = serde_json::json!({"sinew_events": [{"time": 0.25, "name": "tap"}]});
    let bare = append_clip(&document, &document.clips[0], "x", Some(bare)).unwrap();
    let read = read_gltf(&bare, ReadOptions::default(), &mut no_files).unwrap();
    assert_eq!(read.events[2], [ClipEvent::new(0.25, "tap")]);
    let late = append_clip(&document, &document.clips[0], "x", events_extras(&[ClipEvent::new(9.0, "late")]));
    let error = read_gltf(&late.unwrap(), ReadOptions::default(), &mut no_files).unwrap_err();
    assert_eq!(error.where_, "animations[2].extras.sinew_events.events[0].time");
}
