//! The file: operations, hashes and key frames, field by field.

use super::hands::Operation;
use crate::framework::acts::Act;
use sinew::formats::Error;
use sinew::math::hash::hash_bytes;
use sinew::math::{ReadError, Reader, Transform, Writer};
use sinew::physics::{BodyId, Quality, Sleeping};

/// First bytes of the file.
const MAGIC: &[u8; 8] = b"sinewrec";
/// Version of the format. It increases with each addition. 3 was skipped, because one flipped bit would turn it into 2.
pub const FORMAT: u32 = 4;
/// Version without instructions to characters and solver settings, which can still be read.
const WITHOUT_ACTS: u32 = 2;
/// Version without checksums, which can still be read.
const UNCHECKED: u32 = 1;
/// Largest number of steps in a block.
const STEPS_OF_BLOCK: usize = 64;

/// Operations on a scene and their results.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// Version of Sinew that made the recording: only this version is known to reproduce the bits.
    pub made_by: String,
    /// Name of the scene.
    pub scene: String,
    /// Settings that were not at their defaults, `key=value`.
    pub settings: Vec<String>,
    /// Length of a step, seconds.
    pub dt: f32,
    /// All steps, in order.
    pub steps: Vec<RecordedStep>,
    /// Poses at some steps, in order; the first is the start.
    pub key_frames: Vec<KeyFrame>,
}

/// A step of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedStep {
    /// Operations before the step.
    pub operations: Vec<Operation>,
    /// Hash of the world's state after the step.
    pub hash: u64,
}

/// Poses of all bodies at a time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeyFrame {
    /// Number of steps taken.
    pub step: u64,
    /// World from body, for each body in the order of ids.
    pub bodies: Vec<(BodyId, Transform)>,
}

impl Recording {
    /// Returns the bytes of the file: the head, blocks of steps, and blocks of key frames, each block with its
    /// checksum.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::new();
        out.raw(MAGIC);
        out.u32(FORMAT);
        write_checked(&mut out, |out| {
            self.write_head(out);
            out.count(self.steps.len());
            out.count(self.key_frames.len());
        });
        for steps in self.steps.chunks(STEPS_OF_BLOCK) {
            write_checked(&mut out, |out| steps.iter().for_each(|step| write_step(out, step)));
        }
        for frame in &self.key_frames {
            write_checked(&mut out, |out| write_key_frame(out, frame));
        }
        out.into_bytes()
    }

    fn write_head(&self, out: &mut Writer) {
        out.text(&self.made_by);
        out.text(&self.scene);
        out.count(self.settings.len());
        self.settings.iter().for_each(|setting| out.text(setting));
        out.f32(self.dt);
    }

    /// Reads a recording from the bytes of a file.
    ///
    /// # Errors
    /// If the bytes are no recording, fail their checksums, end too early, or have a later format.
    pub fn read(bytes: &[u8]) -> Result<Self, Error> {
        if bytes.get(..MAGIC.len()) != Some(MAGIC) {
            return Err(Error::malformed("is no recording", "byte 0"));
        }
        let mut reader = Reader::new(&bytes[MAGIC.len()..]);
        let format = reader.u32().map_err(|error| wrong(&error))?;
        let recording = match format {
            UNCHECKED => Self::read_unchecked(&mut reader),
            WITHOUT_ACTS | FORMAT => Self::read_checked(&mut reader),
            _ => {
                let what = format!(
                    "is a recording of format {format}; this version reads {UNCHECKED}, {WITHOUT_ACTS} and {FORMAT}"
                );
                return Err(Error::unsupported(what, "byte 8"));
            }
        };
        let recording = recording.map_err(|error| wrong(&error))?;
        reader.finish().map_err(|error| wrong(&error))?;
        Ok(recording)
    }

    fn read_checked(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut head = checked(reader)?;
        let mut recording = Self::read_head(&mut head)?;
        let (steps, key_frames) = (head.u32()? as usize, head.u32()? as usize);
        head.finish()?;
        while recording.steps.len() < steps {
            let mut block = checked(reader)?;
            let count = usize::min(steps - recording.steps.len(), STEPS_OF_BLOCK);
            for _ in 0..count {
                recording.steps.push(read_step(&mut block)?);
            }
            block.finish()?;
        }
        while recording.key_frames.len() < key_frames {
            let mut block = checked(reader)?;
            recording.key_frames.push(read_key_frame(&mut block)?);
            block.finish()?;
        }
        Ok(recording)
    }

    fn read_unchecked(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut recording = Self::read_head(reader)?;
        for _ in 0..reader.count(12)? {
            recording.steps.push(read_step(reader)?);
        }
        for _ in 0..reader.count(12)? {
            recording.key_frames.push(read_key_frame(reader)?);
        }
        Ok(recording)
    }

    fn read_head(reader: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut recording =
            Self { made_by: reader.text()?.to_owned(), scene: reader.text()?.to_owned(), ..Self::default() };
        for _ in 0..reader.count(4)? {
            recording.settings.push(reader.text()?.to_owned());
        }
        recording.dt = reader.f32()?;
        if !(recording.dt > 0.0 && recording.dt < 10.0) {
            return Err(reader.error("the length of a step is 0"));
        }
        Ok(recording)
    }
}

/// Writes a block, then the hash of its content.
fn write_checked(out: &mut Writer, write: impl FnOnce(&mut Writer)) {
    let mut content = Writer::new();
    write(&mut content);
    out.block(|out| out.raw(content.as_bytes()));
    out.u64(hash_bytes(content.as_bytes()));
}

/// Reads a block and verifies the checksum of its content.
fn checked<'a>(reader: &mut Reader<'a>) -> Result<Reader<'a>, ReadError> {
    let block = reader.block()?;
    let content = block.clone().raw(block.remaining())?;
    if reader.u64()? != hash_bytes(content) {
        return Err(block.error("is damaged: the checksum of a block does not match its content"));
    }
    Ok(block)
}

fn write_step(out: &mut Writer, step: &RecordedStep) {
    out.u64(step.hash);
    out.count(step.operations.len());
    // Write each operation in a block, so that a reader can skip unknown kinds.
    step.operations.iter().for_each(|operation| out.block(|out| write_operation(out, operation)));
}

fn read_step(reader: &mut Reader<'_>) -> Result<RecordedStep, ReadError> {
    let mut step = RecordedStep { hash: reader.u64()?, operations: Vec::new() };
    for _ in 0..reader.count(5)? {
        step.operations.extend(read_operation(&mut reader.block()?)?);
    }
    Ok(step)
}

fn write_key_frame(out: &mut Writer, frame: &KeyFrame) {
    out.u64(frame.step);
    out.count(frame.bodies.len());
    for (body, place) in &frame.bodies {
        out.u64(body.to_bits());
        out.transform(*place);
    }
}

fn read_key_frame(reader: &mut Reader<'_>) -> Result<KeyFrame, ReadError> {
    let step = reader.u64()?;
    let mut bodies = Vec::new();
    for _ in 0..reader.count(36)? {
        bodies.push((BodyId::from_bits(reader.u64()?), transform(reader)?));
    }
    Ok(KeyFrame { step, bodies })
}

/// Reads a finite pose.
fn transform(reader: &mut Reader<'_>) -> Result<Transform, ReadError> {
    let place = reader.transform()?;
    let rotation = place.rotation;
    let is_sound = place.translation.is_finite() && rotation.vector().is_finite() && rotation.w.is_finite();
    if is_sound { Ok(place) } else { Err(reader.error("a pose is not finite")) }
}

fn wrong(error: &ReadError) -> Error {
    Error::malformed(error.what, format!("byte {}", error.at + MAGIC.len()))
}

/// Kinds of operations in the file. A number is never reused.
mod kind {
    pub const GRAB: u8 = 1;
    pub const LEAD: u8 = 2;
    pub const RELEASE: u8 = 3;
    pub const PUSH: u8 = 4;
    pub const THROW: u8 = 5;
    pub const PUT: u8 = 6;
    pub const STEER: u8 = 7;
    pub const PLAY: u8 = 8;
    pub const LIMP: u8 = 9;
    pub const POWERED: u8 = 10;
    pub const GET_UP: u8 = 11;
    pub const GRAVITY: u8 = 12;
    pub const SOLVE: u8 = 13;
    pub const SLEEP: u8 = 14;
}

/// Qualities of the solver, by their number in the file.
const QUALITIES: [Quality; 3] = [Quality::Fast, Quality::Balanced, Quality::Exact];

fn write_operation(out: &mut Writer, operation: &Operation) {
    match *operation {
        Operation::Grab { body, point } => {
            out.u8(kind::GRAB);
            out.u64(body.to_bits());
            out.vec3(point);
        }
        Operation::Lead { to } => {
            out.u8(kind::LEAD);
            out.vec3(to);
        }
        Operation::Release => out.u8(kind::RELEASE),
        Operation::Steer { way } => {
            out.u8(kind::STEER);
            out.vec3(way);
        }
        Operation::Act { act: Act::Play(clip) } => {
            out.u8(kind::PLAY);
            out.u32(clip);
        }
        Operation::Act { act: Act::Limp } => out.u8(kind::LIMP),
        Operation::Act { act: Act::Powered } => out.u8(kind::POWERED),
        Operation::Act { act: Act::GetUp } => out.u8(kind::GET_UP),
        Operation::Gravity { gravity } => {
            out.u8(kind::GRAVITY);
            out.vec3(gravity);
        }
        Operation::Solve { quality } => {
            out.u8(kind::SOLVE);
            out.u8(QUALITIES.iter().position(|&it| it == quality).unwrap_or(0) as u8);
        }
        Operation::Sleep { sleeping } => {
            out.u8(kind::SLEEP);
            out.u8(u8::from(sleeping == Sleeping::On));
        }
        Operation::Push { body, impulse, point } => {
            out.u8(kind::PUSH);
            out.u64(body.to_bits());
            out.vec3(impulse);
            out.vec3(point);
        }
        Operation::Throw { position, velocity, radius, density } => {
            out.u8(kind::THROW);
            out.vec3(position);
            out.vec3(velocity);
            out.f32(radius);
            out.f32(density);
        }
        Operation::Put { position, half_extents, density } => {
            out.u8(kind::PUT);
            out.vec3(position);
            out.vec3(half_extents);
            out.f32(density);
        }
    }
}

/// Reads an operation; returns `None` for a kind that this version does not support.
fn read_operation(reader: &mut Reader<'_>) -> Result<Option<Operation>, ReadError> {
    let body = |reader: &mut Reader<'_>| reader.u64().map(BodyId::from_bits);
    Ok(Some(match reader.u8()? {
        kind::GRAB => Operation::Grab { body: body(reader)?, point: reader.vec3()? },
        kind::LEAD => Operation::Lead { to: reader.vec3()? },
        kind::RELEASE => Operation::Release,
        kind::PUSH => Operation::Push { body: body(reader)?, impulse: reader.vec3()?, point: reader.vec3()? },
        kind::THROW => Operation::Throw {
            position: reader.vec3()?,
            velocity: reader.vec3()?,
            radius: reader.f32()?,
            density: reader.f32()?,
        },
        kind::STEER => Operation::Steer { way: reader.vec3()? },
        kind::PLAY => Operation::Act { act: Act::Play(reader.u32()?) },
        kind::LIMP => Operation::Act { act: Act::Limp },
        kind::POWERED => Operation::Act { act: Act::Powered },
        kind::GET_UP => Operation::Act { act: Act::GetUp },
        kind::GRAVITY => Operation::Gravity { gravity: reader.vec3()? },
        kind::SLEEP => {
            let sleeping = if reader.u8()? == 0 { Sleeping::Off } else { Sleeping::On };
            Operation::Sleep { sleeping }
        }
        kind::SOLVE => {
            let number = usize::from(reader.u8()?);
            let quality = QUALITIES.get(number).ok_or_else(|| reader.error("no such quality"))?;
            Operation::Solve { quality: *quality }
        }
        kind::PUT => {
            Operation::Put { position: reader.vec3()?, half_extents: reader.vec3()?, density: reader.f32()? }
        }
        _ => return Ok(None),
    }))
}
