//! Items with stable indices and generations; free slots are reused last in, first out.

use sinew_math::{ReadError, Reader, Writer};

/// Slots by index. The free list is part of the state: after a restore, new items get the same ids again.
#[derive(Clone, Debug)]
pub(crate) struct Arena<T> {
    slots: Vec<Slot<T>>,
    free: Vec<u32>,
}

#[derive(Clone, Debug)]
struct Slot<T> {
    generation: u32,
    item: Option<T>,
}

impl<T> Default for Arena<T> {
    fn default() -> Self {
        Self { slots: Vec::new(), free: Vec::new() }
    }
}

impl<T> Arena<T> {
    /// Puts an item in; gives its index and generation.
    pub fn insert(&mut self, item: T) -> (u32, u32) {
        if let Some(index) = self.free.pop() {
            let slot = &mut self.slots[index as usize];
            slot.item = Some(item);
            return (index, slot.generation);
        }
        self.slots.push(Slot { generation: 0, item: Some(item) });
        (u32::try_from(self.slots.len() - 1).expect("at most 2^32 items of a kind"), 0)
    }

    /// Takes an item out; its id is stale from now on.
    pub fn remove(&mut self, index: u32, generation: u32) -> Option<T> {
        let slot = self.slots.get_mut(index as usize).filter(|slot| slot.generation == generation)?;
        let item = slot.item.take()?;
        slot.generation = slot.generation.wrapping_add(1);
        self.free.push(index);
        Some(item)
    }

    /// The item of an id, if it is not stale.
    pub fn get(&self, index: u32, generation: u32) -> Option<&T> {
        self.slots.get(index as usize).filter(|slot| slot.generation == generation)?.item.as_ref()
    }

    /// Likewise, mutable.
    pub fn get_mut(&mut self, index: u32, generation: u32) -> Option<&mut T> {
        self.slots.get_mut(index as usize).filter(|slot| slot.generation == generation)?.item.as_mut()
    }

    /// The item at an index that is known to be in use.
    pub fn at(&self, index: u32) -> &T {
        self.slots[index as usize].item.as_ref().expect("the index is in use")
    }

    /// The item at an index, if there is one.
    pub fn try_at(&self, index: u32) -> Option<&T> {
        self.slots.get(index as usize)?.item.as_ref()
    }

    /// Likewise, mutable.
    pub fn at_mut(&mut self, index: u32) -> &mut T {
        self.slots[index as usize].item.as_mut().expect("the index is in use")
    }

    /// Generation of a slot.
    pub fn generation(&self, index: u32) -> u32 {
        self.slots[index as usize].generation
    }

    /// True if no slot is in use.
    pub fn is_empty(&self) -> bool {
        self.free.len() == self.slots.len()
    }

    /// The same slots with other items; `item` makes one from index, generation and item.
    pub fn map<U>(self, mut item: impl FnMut(u32, u32, T) -> U) -> Arena<U> {
        let slots = self.slots.into_iter().enumerate().map(|(index, Slot { generation, item: it })| Slot {
            generation,
            item: it.map(|it| item(index as u32, generation, it)),
        });
        Arena { slots: slots.collect(), free: self.free }
    }

    /// Number of slots, free ones included.
    pub fn slot_count(&self) -> usize {
        self.slots.len()
    }

    /// Items with their indices, by index.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &T)> {
        self.slots.iter().enumerate().filter_map(|(i, slot)| Some((i as u32, slot.item.as_ref()?)))
    }

    /// Likewise, mutable.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (u32, &mut T)> {
        self.slots.iter_mut().enumerate().filter_map(|(i, slot)| Some((i as u32, slot.item.as_mut()?)))
    }

    /// Items with their indices and generations.
    pub fn entries(&self) -> impl Iterator<Item = (u32, u32, &T)> {
        let slots = self.slots.iter().enumerate();
        slots.filter_map(|(i, slot)| Some((i as u32, slot.generation, slot.item.as_ref()?)))
    }

    /// Likewise, mutable.
    pub fn entries_mut(&mut self) -> impl Iterator<Item = (u32, u32, &mut T)> {
        let slots = self.slots.iter_mut().enumerate();
        slots.filter_map(|(i, slot)| Some((i as u32, slot.generation, slot.item.as_mut()?)))
    }

    /// Writes slots and free list; `item` writes one item.
    pub fn save(&self, w: &mut Writer, mut item: impl FnMut(&mut Writer, &T)) {
        w.count(self.slots.len());
        for slot in &self.slots {
            w.u32(slot.generation);
            w.bool(slot.item.is_some());
            if let Some(it) = &slot.item {
                item(w, it);
            }
        }
        w.count(self.free.len());
        for &index in &self.free {
            w.u32(index);
        }
    }

    /// Reads what [`save`](Self::save) wrote.
    pub fn load<'a, E: From<ReadError>>(
        r: &mut Reader<'a>,
        mut item: impl FnMut(&mut Reader<'a>) -> Result<T, E>,
    ) -> Result<Self, E> {
        let count = r.count(5)?;
        let mut slots = Vec::with_capacity(count);
        for _ in 0..count {
            let generation = r.u32()?;
            let item = if r.bool()? { Some(item(r)?) } else { None };
            slots.push(Slot { generation, item });
        }
        let count = r.count(4)?;
        let mut free = Vec::with_capacity(count);
        let mut listed = vec![false; slots.len()];
        for _ in 0..count {
            let index = r.u32()?;
            let slot = slots
                .get(index as usize)
                .ok_or_else(|| r.error("free list names a slot that is not there"))?;
            if slot.item.is_some() || core::mem::replace(&mut listed[index as usize], true) {
                return Err(r.error("free list names a slot that is in use").into());
            }
            free.push(index);
        }
        if slots.iter().filter(|slot| slot.item.is_none()).count() != free.len() {
            return Err(r.error("free list misses an empty slot").into());
        }
        Ok(Self { slots, free })
    }
}
