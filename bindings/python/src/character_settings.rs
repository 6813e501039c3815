//! Settings of characters beyond their ragdoll: hits, falls, getting up, motions.

use crate::drive::Drive;
use crate::errors::bad;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::anim::{Clip, ClipEvent};
use sinew::physics::{MoverDef, Quality, Yields};
use sinew::ragdoll::{
    AfterSettling, CharacterDef, FootPlanting, GettingReady, GroundContact, HitBodies, InWorld, Locomotion,
    MotionSet, Opening, Toughness,
};

type Value<'a, 'py> = &'a Bound<'py, PyAny>;

/// Returns a copy with changed settings.
pub fn edited(def: &CharacterDef, settings: Option<&Bound<'_, PyDict>>) -> PyResult<CharacterDef> {
    let mut made = def.clone();
    let mut motions = None;
    for (key, value) in settings.into_iter().flatten() {
        let key: String = key.extract()?;
        let is_known = of_fall(&mut made, &key, &value)?
            || of_world(&mut made, &key, &value)?
            || of_motions(motions.get_or_insert_with(|| def.motions().clone()), &key, &value)?;
        if !is_known {
            let what = format!("edited() got an unexpected keyword argument '{key}'");
            return Err(PyTypeError::new_err(what));
        }
    }
    if let Some(motions) = motions.filter(|motions| motions != def.motions()) {
        made.set_motions(motions).map_err(|what| bad(what.to_string()))?;
    }
    Ok(made)
}

/// Reads a number that is at least 0; `finite`: infinity is refused.
fn number(value: Value<'_, '_>, name: &str, finite: bool) -> PyResult<f32> {
    let number: f32 = value.extract()?;
    if number >= 0.0 && (!finite || number < f32::INFINITY) {
        return Ok(number);
    }
    let bound = if finite { "finite and at least 0" } else { "at least 0" };
    Err(bad(format!("{name} must be {bound}, not {number}")))
}

fn of_fall(def: &mut CharacterDef, key: &str, value: Value<'_, '_>) -> PyResult<bool> {
    let finite = |value| number(value, key, true);
    match key {
        "gets_up" => {
            let gets_up: bool = value.extract()?;
            def.after_settling = if gets_up { AfterSettling::GetUp } else { AfterSettling::StayDown };
        }
        "rolls_over" => {
            let rolls: bool = value.extract()?;
            def.getting_ready = if rolls { GettingReady::RollOver } else { GettingReady::AtOnce };
        }
        "keeps_out_of_floor" => {
            let keeps: bool = value.extract()?;
            def.ground_contact = if keeps { GroundContact::Enforced } else { GroundContact::AsBlended };
        }
        "falling" => def.falling = value.extract::<PyRef<'_, Drive>>()?.mode,
        "patience" => def.patience = finite(value)?,
        "max_speed" => def.speed_bound.linear = finite(value)?,
        "max_turn_speed" => def.speed_bound.angular = finite(value)?,
        "friction" => def.body_settings.material.friction = finite(value)?,
        "rolling" => def.body_settings.material.rolling = finite(value)?,
        "restitution" => def.body_settings.material.restitution = finite(value)?,
        "angular_damping" => def.body_settings.angular_damping = finite(value)?,
        "quality" => {
            def.body_settings.quality = match value.extract::<Option<String>>()?.as_deref() {
                None => None,
                Some("fast") => Some(Quality::Fast),
                Some("balanced") => Some(Quality::Balanced),
                Some("exact") => Some(Quality::Exact),
                Some(other) => {
                    return Err(bad(format!("quality is fast, balanced, exact or None, not '{other}'")));
                }
            }
        }
        _ => return Ok(false),
    }
    Ok(true)
}

fn of_world(def: &mut CharacterDef, key: &str, value: Value<'_, '_>) -> PyResult<bool> {
    let usual = InWorld::of(&def.ragdoll);
    let in_world = &mut def.in_world;
    match key {
        "hit_bodies" => {
            let has: bool = value.extract()?;
            in_world.hit_bodies = if has { HitBodies::Present(Yields::default()) } else { HitBodies::Absent };
        }
        "yields" => {
            let (max_force, max_impulse): (f32, f32) = value.extract()?;
            if !(max_force >= 0.0 && max_impulse >= 0.0) {
                return Err(bad("a force and a momentum must be at least 0"));
            }
            in_world.hit_bodies = HitBodies::Present(Yields { max_force, max_impulse });
        }
        "mover" => in_world.mover = if value.extract()? { usual.mover } else { None },
        "step_height" => changed_mover(in_world, |mover| {
            mover.step_height = number(value, key, true)?;
            Ok(())
        })?,
        "slope_limit" => changed_mover(in_world, |mover| {
            mover.slope_limit = number(value, key, true)?;
            Ok(())
        })?,
        "turn_speed" => in_world.turn_speed = number(value, key, true)?,
        "jump_speed" => in_world.jump_speed = number(value, key, true)?,
        "air_time" => in_world.air_time = number(value, key, false)?,
        "landing_speed" => in_world.landing_speed = number(value, key, false)?,
        "plants_feet" => {
            let plants: bool = value.extract()?;
            in_world.foot_planting = if plants { FootPlanting::OnGround } else { FootPlanting::AsClips };
        }
        "toughness" => {
            in_world.toughness = match value.is_none() {
                true => Toughness::None,
                false => Toughness::Impulse(number(value, key, false)?),
            }
        }
        "most_steps" => in_world.most_steps = value.extract()?,
        "feels" => in_world.feels = number(value, key, false)?,
        "tells_contacts" => in_world.tells_contacts = value.extract()?,
        _ => return Ok(false),
    }
    Ok(true)
}

fn changed_mover(in_world: &mut InWorld, change: impl FnOnce(&mut MoverDef) -> PyResult<()>) -> PyResult<()> {
    let Some(mover) = &mut in_world.mover else {
        return Err(bad("a character without a mover has no steps and slopes"));
    };
    change(mover)?;
    mover.check().map_err(|what| bad(what.to_string()))
}

fn of_motions(motions: &mut MotionSet, key: &str, value: Value<'_, '_>) -> PyResult<bool> {
    let clips = &motions.clips;
    let named = |value: Value<'_, '_>| -> PyResult<Option<usize>> {
        value.extract::<Option<String>>()?.map(|name| clip_named(clips, &name)).transpose()
    };
    match key {
        "clip" => motions.looped = named(value)?,
        "idle" => motions.idle = named(value)?,
        "faster" => {
            let names: Vec<String> = value.extract()?;
            let faster = names.iter().map(|name| Ok((clip_named(clips, name)?, Locomotion::ByClip)));
            motions.faster = faster.collect::<PyResult<_>>()?;
        }
        "get_ups" => {
            let names: Vec<String> = value.extract()?;
            motions.get_ups = names.iter().map(|name| clip_named(clips, name)).collect::<PyResult<_>>()?;
        }
        "clip_events" => {
            let given: Vec<(String, f32, String)> = value.extract()?;
            let events = given.iter().map(|(clip, time, name)| {
                let index = clip_named(clips, clip)?;
                let length = clips[index].duration;
                if (0.0..=length).contains(time) {
                    Ok((index, ClipEvent::new(*time, name)))
                } else {
                    Err(bad(format!("an event of {clip} is at 0 to {length} s, not {time}")))
                }
            });
            motions.events = events.collect::<PyResult<_>>()?;
        }
        "locomotion" => motions.locomotion = locomotion(value)?,
        "opening" => {
            motions.opening = match value.extract::<String>()?.as_str() {
                "clip" => Opening::Looped,
                "rest" => Opening::Rest,
                other => return Err(bad(format!("an opening is clip or rest, not '{other}'"))),
            }
        }
        _ => return Ok(false),
    }
    Ok(true)
}

/// Reads a locomotion: a name, or the speed of a clip that walks on the spot.
fn locomotion(value: Value<'_, '_>) -> PyResult<Locomotion> {
    if let Ok(speed) = value.extract::<f32>() {
        let is_finite = speed.is_finite();
        return if is_finite {
            Ok(Locomotion::Forward { speed })
        } else {
            Err(bad("a speed must be finite"))
        };
    }
    Ok(match value.extract::<String>()?.as_str() {
        "in_place" => Locomotion::InPlace,
        "by_clip" => Locomotion::ByClip,
        "exact" => Locomotion::Exact,
        other => {
            let known = "in_place, by_clip, exact or a speed in m/s";
            return Err(bad(format!("locomotion is {known}, not '{other}'")));
        }
    })
}

/// Returns the index of the clip with a name.
fn clip_named(clips: &[Clip], name: &str) -> PyResult<usize> {
    clips.iter().position(|clip| clip.name == name).ok_or_else(|| {
        let names: Vec<&str> = clips.iter().map(|clip| clip.name.as_str()).collect();
        let known = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        bad(format!("no clip is called '{name}'; there are {known}"))
    })
}
