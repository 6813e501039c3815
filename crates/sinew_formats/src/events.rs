//! Events of clips in files: `NAME.events.json` beside `NAME.bvh` (or `.glb`, …), and `extras.sinew_events` of a glTF
//! animation. Both have the same events:
//!
//! ```json
//! {"sinew": "events", "version": 1, "clips": [
//!   {"clip": "Walk", "events": [
//!     {"time": 0.25, "name": "footstep", "payload": "left"},
//!     {"time": 0.5, "name": "hit", "min_weight": 0.9, "fired_by": "leader", "on_interrupt": true}]}]}
//! ```
//!
//! `clip` is a name, or an index from 0 if clips have no names; times are seconds. `extras` have no list of clips, but
//! `"sinew_events": {"version": 1, "events": […]}`, or only the list.
//!
//! ```
//! use sinew_anim::ClipEvent;
//! use sinew_formats::{read_events, write_events};
//!
//! let clips = sinew::mannequin::mannequin().clips;
//! let mut events = vec![Vec::new(); clips.len()];
//! events[0] = vec![ClipEvent::new(0.25, "footstep")];
//! let text = write_events(&clips, &events);
//! assert_eq!(read_events(text.as_bytes(), &clips)?[0], Some(events[0].clone()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::container::json::{self, At, number};
use crate::error::{Result, quoted};
use serde_json::{Map, Value, json};
use sinew_anim::{Clip, ClipEvent, EventPolicy, FiredBy};

/// Version of both forms.
const VERSION: usize = 1;

/// Key of the events in an animation's `extras`.
const EXTRAS_KEY: &str = "sinew_events";

const FIRED_BY: [(&str, FiredBy); 3] =
    [("every", FiredBy::Every), ("leader", FiredBy::Leader), ("one_per_group", FiredBy::OnePerGroup)];

/// Reads an events file; returns the events of each of `clips` by time, `None` for a clip that the file does not
/// mention.
///
/// # Errors
/// Returns an error that names the location: invalid JSON, another kind of file or a newer version, an unknown key, a
/// clip that does not exist, is ambiguous or is listed twice, an event without a name or outside its clip, a weight
/// outside 0..=1.
pub fn read_events(bytes: &[u8], clips: &[Clip]) -> Result<Vec<Option<Vec<ClipEvent>>>> {
    let json = json::parse(bytes)?;
    let root = At::root(&json);
    json::check_header(root, "events", VERSION)?;
    root.only(&["sinew", "version", "clips"])?;
    let mut found = vec![None; clips.len()];
    for entry in root.need("clips")?.items()? {
        entry.only(&["clip", "events"])?;
        let clip_at = entry.need("clip")?;
        let clip = find_clip(clip_at, clips)?;
        let events = read_list(entry.need("events")?, clips[clip].duration)?;
        if found[clip].replace(events).is_some() {
            return Err(clip_at.malformed("the clip is listed twice"));
        }
    }
    Ok(found)
}

/// Returns the index of the clip with that name, or the number itself.
fn find_clip(at: At<'_>, clips: &[Clip]) -> Result<usize> {
    let Some(name) = at.value().as_str() else { return at.index(clips.len(), "clips") };
    let mut called = (0..clips.len()).filter(|&index| clips[index].name == name);
    match (called.next(), called.next()) {
        (Some(index), None) => Ok(index),
        (None, _) => Err(at.malformed(format!("no clip is called {}", quoted(name)))),
        (Some(_), Some(_)) => {
            Err(at.malformed(format!("several clips are called {}: use their numbers", quoted(name))))
        }
    }
}

/// Writes the events in the format of [`read_events`]; clips without events are omitted.
///
/// # Panics
/// If there is not one list of events per clip, or a number is not finite.
pub fn write_events(clips: &[Clip], events: &[Vec<ClipEvent>]) -> String {
    assert_eq!(clips.len(), events.len(), "a list of events for each clip");
    let is_unique = |name: &str| clips.iter().filter(|clip| clip.name == name).count() == 1;
    let entry = |(index, (clip, events)): (usize, (&Clip, &Vec<ClipEvent>))| {
        let is_named = !clip.name.is_empty() && is_unique(&clip.name);
        let called = if is_named { Value::from(clip.name.as_str()) } else { index.into() };
        (!events.is_empty()).then(|| json!({"clip": called, "events": write_list(events)}))
    };
    let entries: Vec<Value> = clips.iter().zip(events).enumerate().filter_map(entry).collect();
    json::to_text(&json!({"sinew": "events", "version": VERSION, "clips": entries}))
}

/// Returns the `extras` of a glTF animation with these events, for [`append_clip`](crate::append_clip); `None` without
/// events.
///
/// # Panics
/// If a number is not finite.
pub fn events_extras(events: &[ClipEvent]) -> Option<Value> {
    let list = || json!({EXTRAS_KEY: {"version": VERSION, "events": write_list(events)}});
    (!events.is_empty()).then(list)
}

/// Reads the events of a glTF animation of `duration` seconds. `extras` may be any value; only Sinew's key is read.
pub(crate) fn read_extras(animation: At<'_>, duration: f32) -> Result<Vec<ClipEvent>> {
    let Some(extras) = animation.get("extras")?.filter(|extras| extras.value().is_object()) else {
        return Ok(Vec::new());
    };
    let Some(at) = extras.get(EXTRAS_KEY)? else { return Ok(Vec::new()) };
    if at.value().is_array() {
        return read_list(at, duration);
    }
    at.only(&["version", "events"])?;
    json::check_version(at, VERSION)?;
    read_list(at.need("events")?, duration)
}

fn read_list(list: At<'_>, duration: f32) -> Result<Vec<ClipEvent>> {
    let mut events =
        list.items()?.into_iter().map(|at| read_event(at, duration)).collect::<Result<Vec<ClipEvent>>>()?;
    // The sort is stable, so events at one time keep the file's order.
    events.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(events)
}

fn read_event(at: At<'_>, duration: f32) -> Result<ClipEvent> {
    at.only(&["time", "name", "payload", "min_weight", "fired_by", "on_interrupt"])?;
    let time_at = at.need("time")?;
    let time = time_at.not_negative()?;
    if time > duration {
        return Err(time_at.malformed(format!("{time} s is after the end of the clip, {duration} s")));
    }
    let name_at = at.need("name")?;
    let name = name_at.str()?.to_owned();
    if name.is_empty() {
        return Err(name_at.malformed("an event needs a name"));
    }
    let payload = at.get("payload")?.map_or(Ok(""), At::str)?.to_owned();
    Ok(ClipEvent { time, name, payload, policy: read_policy(at)? })
}

fn read_policy(at: At<'_>) -> Result<EventPolicy> {
    let mut policy = EventPolicy::default();
    if let Some(weight_at) = at.get("min_weight")? {
        policy.min_weight = weight_at.f32()?;
        if !(0.0..=1.0).contains(&policy.min_weight) {
            return Err(weight_at.malformed("a weight is between 0 and 1"));
        }
    }
    if let Some(by_at) = at.get("fired_by")? {
        let text = by_at.str()?;
        let known = FIRED_BY.iter().find(|(name, _)| *name == text);
        let unknown = || format!("{} is none of every, leader, one_per_group", quoted(text));
        policy.fired_by = known.ok_or_else(|| by_at.malformed(unknown()))?.1;
    }
    policy.on_interrupt = at.get("on_interrupt")?.map_or(Ok(false), At::bool)?;
    Ok(policy)
}

/// Converts events to JSON, without default values.
fn write_list(events: &[ClipEvent]) -> Value {
    let usual = EventPolicy::default();
    let write = |event: &ClipEvent| {
        let mut object = Map::new();
        object.insert("time".into(), number(event.time));
        object.insert("name".into(), event.name.as_str().into());
        if !event.payload.is_empty() {
            object.insert("payload".into(), event.payload.as_str().into());
        }
        let policy = event.policy;
        if policy.min_weight.to_bits() != usual.min_weight.to_bits() {
            object.insert("min_weight".into(), number(policy.min_weight));
        }
        if let Some((name, by)) = FIRED_BY.iter().find(|(_, by)| *by == policy.fired_by)
            && *by != usual.fired_by
        {
            object.insert("fired_by".into(), (*name).into());
        }
        if policy.on_interrupt {
            object.insert("on_interrupt".into(), true.into());
        }
        Value::from(object)
    };
    events.iter().map(write).collect()
}
