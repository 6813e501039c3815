//! Reads the drives of a character's bodies from JavaScript objects.

use crate::border::{Failure, Outcome};
use crate::values::Options;
use sinew::ragdoll::{DriveMode, Muscle, Pin};
use wasm_bindgen::JsValue;

/// Reads a mode: "limp", "keyed", or a muscle with or without a pin.
pub fn drive_mode(value: &JsValue) -> Outcome<DriveMode> {
    match value.as_string().as_deref() {
        Some("limp") => return Ok(DriveMode::Limp),
        Some("keyed") => return Ok(DriveMode::Keyed),
        Some(other) => {
            return Err(Failure(format!("a drive is limp, keyed or an object with a muscle, not '{other}'")));
        }
        None => {}
    }
    let options = Options::of(value, "drive", &["muscle", "pin"])?;
    let muscle = match options.get("muscle") {
        Some(value) => muscle(&value)?,
        None => return Err(Failure::new("drive.muscle is missing")),
    };
    Ok(match options.get("pin") {
        None => DriveMode::Powered(muscle),
        Some(value) => DriveMode::Pinned(muscle, pin(&value)?),
    })
}

fn muscle(value: &JsValue) -> Outcome<Muscle> {
    match value.as_string().as_deref() {
        Some("relaxed") => return Ok(Muscle::RELAXED),
        Some("alive") => return Ok(Muscle::ALIVE),
        Some("stiff") => return Ok(Muscle::STIFF),
        Some(other) => return Err(Failure(format!("a muscle is relaxed, alive or stiff, not '{other}'"))),
        None => {}
    }
    let options = Options::of(value, "muscle", &["hertz", "dampingRatio", "strength"])?;
    Ok(Muscle {
        hertz: options.needed_number("hertz")?,
        damping_ratio: options.number("dampingRatio")?.unwrap_or(Muscle::ALIVE.damping_ratio),
        strength: options.number("strength")?.unwrap_or(Muscle::ALIVE.strength),
    })
}

fn pin(value: &JsValue) -> Outcome<Pin> {
    match value.as_string().as_deref() {
        Some("soft") => return Ok(Pin::SOFT),
        Some("firm") => return Ok(Pin::FIRM),
        Some(other) => return Err(Failure(format!("a pin is soft or firm, not '{other}'"))),
        None => {}
    }
    let options = Options::of(value, "pin", &["hertz", "dampingRatio", "maxForce", "maxTorque"])?;
    Ok(Pin {
        hertz: options.needed_number("hertz")?,
        damping_ratio: options.number("dampingRatio")?.unwrap_or(Pin::SOFT.damping_ratio),
        max_force: options.needed_number("maxForce")?,
        max_torque: options.needed_number("maxTorque")?,
    })
}
