//! Snapshots as values, and the deltas between them.

use crate::body::library::LoadError;
use crate::world::World;
use sinew_math::hash::hash_bytes;
use sinew_math::{ReadError, Reader, Writer};

/// State of a world as bytes. A later state can be stored as a delta against it: for network rollback, late joiners and
/// replays.
///
/// ```
/// use sinew_physics::{BodyDef, Shape, Snapshot, World, WorldDef};
///
/// let mut world = World::new(WorldDef::default());
/// (0..100).for_each(|i| _ = world.add_body(&BodyDef::fixed(Shape::sphere(0.5)).at([i as f32, 0.0, 0.0].into())));
/// world.add_body(&BodyDef::dynamic(Shape::sphere(0.5)));
/// let earlier = Snapshot::of(&world);
/// world.step();
/// let later = Snapshot::of(&world);
/// let delta = later.delta(&earlier);
/// assert!(100 * delta.len() < later.as_bytes().len());
/// let back = Snapshot::from_delta(&earlier, &delta)?;
/// assert_eq!(back, later);
/// # Ok::<(), sinew_math::ReadError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Snapshot {
    bytes: Vec<u8>,
}

/// Magic bytes at the start of a delta; the last byte is the version.
const MAGIC: &[u8; 8] = b"sinew-d\x01";
/// Length of a byte sequence that is searched in the earlier snapshot, and the shortest match worth storing, bytes.
const PIECE: usize = 16;
const WORTH: usize = 6;

impl Snapshot {
    /// Returns the state of a world: the bytes that [`World::save`] writes.
    pub fn of(world: &World) -> Self {
        let mut snapshot = Self::default();
        snapshot.take(world);
        snapshot
    }

    /// Stores the state of a world, reusing the memory of the old state.
    pub fn take(&mut self, world: &World) {
        let mut w = Writer::reuse(core::mem::take(&mut self.bytes));
        world.save(&mut w);
        self.bytes = w.into_bytes();
    }

    /// Returns a snapshot with bytes written earlier, by a world or other code with the same format.
    pub fn from_bytes(bytes: Vec<u8>) -> Self {
        Self { bytes }
    }

    /// Returns the bytes of the state.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Restores the state of a world.
    ///
    /// # Errors
    /// Like [`World::load`].
    pub fn load_into(&self, world: &mut World) -> Result<(), LoadError> {
        world.load(&mut Reader::new(&self.bytes))
    }

    /// Returns bytes from which this snapshot can be rebuilt if the earlier one is available. Unchanged parts are not
    /// stored, only referenced.
    pub fn delta(&self, earlier: &Self) -> Vec<u8> {
        let (old, new) = (&earlier.bytes[..], &self.bytes[..]);
        let mut w = Writer::new();
        w.raw(MAGIC);
        w.u64(hash_bytes(old));
        w.u64(hash_bytes(new));
        number(&mut w, new.len());
        let pieces = Pieces::of(old);
        // `new` has been written up to `told`; `with` is the position in the old snapshot that corresponds to `at`.
        let (mut at, mut told, mut with) = (0, 0, 0);
        while at < new.len() {
            let here = common(&old[usize::min(with, old.len())..], &new[at..]);
            let (from, length) = if here >= WORTH { (with, here) } else { pieces.find(old, &new[at..]) };
            if length < WORTH {
                (at, with) = (at + 1, with + 1);
                continue;
            }
            change(&mut w, &new[told..at], from as i64 - with as i64, length);
            (at, with) = (at + length, from + length);
            told = at;
        }
        if told < at {
            change(&mut w, &new[told..], 0, 0);
        }
        w.into_bytes()
    }

    /// Rebuilds a snapshot from an earlier one and a delta.
    ///
    /// # Errors
    /// If the bytes are no delta of this version, are damaged, or were made against another snapshot.
    pub fn from_delta(earlier: &Self, delta: &[u8]) -> Result<Self, ReadError> {
        let old = &earlier.bytes[..];
        let mut r = Reader::new(delta);
        if r.raw(MAGIC.len())? != MAGIC {
            return Err(ReadError { at: 0, what: "is no delta of a snapshot of this version" });
        }
        if r.u64()? != hash_bytes(old) {
            return Err(r.error("was made against another snapshot"));
        }
        let (hash, length) = (r.u64()?, read_number(&mut r)?);
        let mut bytes = Vec::with_capacity(usize::min(length, old.len() + delta.len()));
        let mut with = 0;
        while bytes.len() < length {
            let fresh = read_number(&mut r)?;
            bytes.extend_from_slice(r.raw(fresh)?);
            with += fresh;
            let (step, copied) = (read_number(&mut r)?, read_number(&mut r)?);
            let from = with as i64 + ((step >> 1) as i64 ^ -((step & 1) as i64));
            // At the end nothing is copied, so the offset has no meaning.
            let from = if copied == 0 { 0 } else { from };
            let piece = usize::try_from(from).ok().and_then(|from| old.get(from..from.checked_add(copied)?));
            let Some(piece) = piece.filter(|_| fresh + copied > 0 && bytes.len() + copied <= length) else {
                return Err(r.error("names bytes that are not there"));
            };
            bytes.extend_from_slice(piece);
            with = from as usize + copied;
        }
        if bytes.len() != length || hash_bytes(&bytes) != hash {
            return Err(r.error("is damaged"));
        }
        r.finish()?;
        Ok(Self { bytes })
    }
}

/// Writes literal bytes, then a copy from an offset relative to the current position in the old snapshot.
fn change(w: &mut Writer, fresh: &[u8], step: i64, copied: usize) {
    number(w, fresh.len());
    w.raw(fresh);
    number(w, ((step << 1) ^ (step >> 63)) as u64 as usize);
    number(w, copied);
}

/// Writes a number, seven bits per byte.
fn number(w: &mut Writer, mut value: usize) {
    while value >= 0x80 {
        w.u8(value as u8 | 0x80);
        value >>= 7;
    }
    w.u8(value as u8);
}

fn read_number(r: &mut Reader<'_>) -> Result<usize, ReadError> {
    let mut value = 0u64;
    for shift in (0..63).step_by(7) {
        let byte = r.u8()?;
        value |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            // Lengths and offsets do not exceed the snapshot's length.
            return Some(value)
                .filter(|&value| value < 1 << 40)
                .and_then(|value| usize::try_from(value).ok())
                .ok_or_else(|| r.error("a number is too large"));
        }
    }
    Err(r.error("a number is too long"))
}

/// Returns the length of the common prefix.
fn common(p: &[u8], q: &[u8]) -> usize {
    let words = p.chunks_exact(8).zip(q.chunks_exact(8)).take_while(|(p, q)| p == q).count();
    let rest = p[8 * words..].iter().zip(&q[8 * words..]).take_while(|(p, q)| p == q).count();
    8 * words + rest
}

/// Index of a snapshot's byte sequences.
struct Pieces {
    /// Position plus one of a sequence, by its hash; 0 for none.
    places: Vec<u32>,
}

impl Pieces {
    fn of(old: &[u8]) -> Self {
        let size = usize::max(old.len() / 4, 1).next_power_of_two();
        let mut places = vec![0; size];
        for at in (0..old.len().saturating_sub(PIECE - 1)).step_by(4) {
            places[Self::slot(size, &old[at..])] = at as u32 + 1;
        }
        Self { places }
    }

    fn slot(size: usize, bytes: &[u8]) -> usize {
        let word = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap_or_default());
        let mixed =
            (word(0).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ word(8)).wrapping_mul(0xff51_afd7_ed55_8ccd);
        (mixed >> 32) as usize & (size - 1)
    }

    /// Returns the position and length of a match for the next bytes; length 0 if there is none.
    fn find(&self, old: &[u8], new: &[u8]) -> (usize, usize) {
        if new.len() < PIECE {
            return (0, 0);
        }
        match self.places[Self::slot(self.places.len(), new)] {
            0 => (0, 0),
            place => {
                let at = place as usize - 1;
                let length = common(&old[at..], new);
                if length < PIECE { (0, 0) } else { (at, length) }
            }
        }
    }
}
