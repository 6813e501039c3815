//! Items with stable indices and generations; free slots are reused last in, first out.

use sinew_math::{ReadError, Reader, Writer};

/// Slots by index. The free list is part of the state: after a restore, new items get the same ids again.
#[derive(Clone, Debug)]
pub(crate) struct Arena<T> {
    /// Of each slot; close together, since queries name many items that they do not look at.
    generations: Vec<u32>,
    items: Vec<Option<T>>,
    free: Vec<u32>,
}

impl<T> Default for Arena<T> {
    fn default() -> Self {
        Self { generations: Vec::new(), items: Vec::new(), free: Vec::new() }
    }
}

impl<T> Arena<T> {
    /// Puts an item in; gives its index and generation.
    pub fn insert(&mut self, item: T) -> (u32, u32) {
        if let Some(index) = self.free.pop() {
            self.items[index as usize] = Some(item);
            return (index, self.generations[index as usize]);
        }
        self.generations.push(0);
        self.items.push(Some(item));
        (u32::try_from(self.items.len() - 1).expect("at most 2^32 items of a kind"), 0)
    }

    /// Takes an item out; its id is stale from now on.
    pub fn remove(&mut self, index: u32, generation: u32) -> Option<T> {
        let item = self.current(index, generation).then(|| self.items[index as usize].take())??;
        self.generations[index as usize] = generation.wrapping_add(1);
        self.free.push(index);
        Some(item)
    }

    /// The item of an id, if it is not stale.
    pub fn get(&self, index: u32, generation: u32) -> Option<&T> {
        if self.current(index, generation) { self.items[index as usize].as_ref() } else { None }
    }

    /// Likewise, mutable.
    pub fn get_mut(&mut self, index: u32, generation: u32) -> Option<&mut T> {
        if self.current(index, generation) { self.items[index as usize].as_mut() } else { None }
    }

    fn current(&self, index: u32, generation: u32) -> bool {
        self.generations.get(index as usize) == Some(&generation)
    }

    /// The item at an index that is known to be in use.
    pub fn at(&self, index: u32) -> &T {
        self.items[index as usize].as_ref().expect("the index is in use")
    }

    /// The item at an index, if there is one.
    pub fn try_at(&self, index: u32) -> Option<&T> {
        self.items.get(index as usize)?.as_ref()
    }

    /// Likewise, mutable.
    pub fn at_mut(&mut self, index: u32) -> &mut T {
        self.items[index as usize].as_mut().expect("the index is in use")
    }

    /// Generation of a slot.
    pub fn generation(&self, index: u32) -> u32 {
        self.generations[index as usize]
    }

    /// True if no slot is in use.
    pub fn is_empty(&self) -> bool {
        self.free.len() == self.items.len()
    }

    /// The same slots with other items; `item` makes one from index, generation and item.
    pub fn map<U>(self, mut item: impl FnMut(u32, u32, T) -> U) -> Arena<U> {
        let slots = self.items.into_iter().zip(&self.generations).enumerate();
        let items = slots.map(|(index, (it, &generation))| it.map(|it| item(index as u32, generation, it)));
        Arena { items: items.collect(), generations: self.generations, free: self.free }
    }

    /// Number of slots, free ones included.
    pub fn slot_count(&self) -> usize {
        self.items.len()
    }

    /// Items with their indices, by index.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &T)> {
        self.items.iter().enumerate().filter_map(|(i, item)| Some((i as u32, item.as_ref()?)))
    }

    /// Likewise, mutable.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (u32, &mut T)> {
        self.items.iter_mut().enumerate().filter_map(|(i, item)| Some((i as u32, item.as_mut()?)))
    }

    /// Items with their indices and generations.
    pub fn entries(&self) -> impl Iterator<Item = (u32, u32, &T)> {
        let slots = self.generations.iter().zip(&self.items).enumerate();
        slots.filter_map(|(i, (&generation, item))| Some((i as u32, generation, item.as_ref()?)))
    }

    /// Likewise, mutable.
    pub fn entries_mut(&mut self) -> impl Iterator<Item = (u32, u32, &mut T)> {
        let slots = self.generations.iter().zip(&mut self.items).enumerate();
        slots.filter_map(|(i, (&generation, item))| Some((i as u32, generation, item.as_mut()?)))
    }

    /// Writes slots and free list; `item` writes one item.
    pub fn save(&self, w: &mut Writer, mut item: impl FnMut(&mut Writer, &T)) {
        w.count(self.items.len());
        for (&generation, it) in self.generations.iter().zip(&self.items) {
            w.u32(generation);
            w.bool(it.is_some());
            if let Some(it) = it {
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
        let mut generations = Vec::with_capacity(count);
        let mut items = Vec::with_capacity(count);
        for _ in 0..count {
            generations.push(r.u32()?);
            items.push(if r.bool()? { Some(item(r)?) } else { None });
        }
        let count = r.count(4)?;
        let mut free = Vec::with_capacity(count);
        let mut listed = vec![false; items.len()];
        for _ in 0..count {
            let index = r.u32()?;
            let slot = items
                .get(index as usize)
                .ok_or_else(|| r.error("free list names a slot that is not there"))?;
            if slot.is_some() || core::mem::replace(&mut listed[index as usize], true) {
                return Err(r.error("free list names a slot that is in use").into());
            }
            free.push(index);
        }
        if items.iter().filter(|item| item.is_none()).count() != free.len() {
            return Err(r.error("free list misses an empty slot").into());
        }
        Ok(Self { generations, items, free })
    }
}
