//! Objects in snapshots: saving and loading.

use super::{Objects, PhysicsObject};
use crate::arena::{Arena, Item};
use crate::id::ObjectId;
use sinew_math::{ReadError, Reader, Writer};

/// Kind and state of an object in a snapshot.
struct Saved<'a> {
    kind: &'a str,
    state: Reader<'a>,
}

impl Item for Saved<'_> {
    type Id = ObjectId;
}

impl Objects {
    /// Writes ids, kinds and states.
    pub fn save(&self, w: &mut Writer) {
        self.arena.save(w, |w, object| {
            w.text(object.kind());
            w.block(|w| object.save(w));
        });
    }

    /// Reads the format of [`save`](Self::save) into the existing objects, or into new ones of registered kinds.
    /// Removes objects that the snapshot does not have.
    ///
    /// # Errors
    /// If the bytes are invalid, an object rejects its state, or an object is missing and its kind is not registered;
    /// the objects are then unchanged.
    pub fn load(&mut self, r: &mut Reader<'_>) -> Result<(), ReadError> {
        let saved = Arena::load(r, |r| Ok(Saved { kind: r.text()?, state: r.block()? }))?;
        let before = self.states();
        let mut made = Vec::new();
        for id in saved.ids() {
            if let Err(error) = self.load_one(id, saved.expect(id), &mut made) {
                self.take_back(&before);
                return Err(error);
            }
        }
        let mut made = made.into_iter();
        let mut old = core::mem::take(&mut self.arena);
        self.arena = saved.map(|id, saved| {
            let kept = old.remove(id).filter(|object| object.kind() == saved.kind);
            kept.or_else(|| made.next()).expect("it is there or was made")
        });
        Ok(())
    }

    fn load_one(
        &mut self,
        id: ObjectId,
        saved: &Saved<'_>,
        made: &mut Vec<Box<dyn PhysicsObject>>,
    ) -> Result<(), ReadError> {
        let state = saved.state.clone();
        match self.arena.get_mut(id).filter(|object| object.kind() == saved.kind) {
            Some(object) => take_state(object.as_mut(), state),
            None => {
                let make = self.kinds.iter().find(|(kind, _)| *kind == saved.kind).map(|(_, make)| make);
                let make =
                    make.ok_or_else(|| state.error("an object that is not there, of no known kind"))?;
                let mut object = make();
                take_state(object.as_mut(), state)?;
                made.push(object);
                Ok(())
            }
        }
    }

    /// Returns the states of all objects, in the order of ids.
    fn states(&self) -> Writer {
        let mut w = Writer::new();
        for (_, object) in self.arena.iter() {
            w.block(|w| object.save(w));
        }
        w
    }

    /// # Panics
    /// If an object rejects its own saved state.
    fn take_back(&mut self, states: &Writer) {
        let mut r = Reader::new(states.as_bytes());
        for (_, object) in self.arena.iter_mut() {
            let taken = r.block().and_then(|state| take_state(object.as_mut(), state));
            taken.expect("an object takes the state that it wrote");
        }
    }
}

fn take_state(object: &mut dyn PhysicsObject, mut state: Reader<'_>) -> Result<(), ReadError> {
    object.load(&mut state)?;
    state.finish()
}
