//! Items with stable indices and generations; free slots are reused last in, first out.

use crate::id::{Handle, Lineage};
use sinew_math::{ReadError, Reader, Writer};

/// Item type of an arena; each has an id type.
pub(crate) trait Item {
    type Id: Handle;
}

/// Slots by index. The free list is part of the state: after a restore, new items get the same ids.
#[derive(Clone, Debug)]
pub(crate) struct Arena<T> {
    lineage: Lineage,
    /// Generation of each slot; stored contiguously, because queries check many generations without reading the items.
    generations: Vec<u32>,
    items: Vec<Option<T>>,
    free: Vec<u32>,
}

impl<T> Default for Arena<T> {
    fn default() -> Self {
        Self::new(Lineage::default())
    }
}

impl<T> Arena<T> {
    /// Creates an arena without items for a world.
    pub fn new(lineage: Lineage) -> Self {
        Self { lineage, generations: Vec::new(), items: Vec::new(), free: Vec::new() }
    }
}

impl<T: Item> Arena<T> {
    /// Adds an item; returns its id.
    pub fn insert(&mut self, item: T) -> T::Id {
        let index = self.free.pop().unwrap_or_else(|| {
            self.generations.push(0);
            self.items.push(None);
            u32::try_from(self.items.len() - 1).expect("at most 2^32 items of a kind")
        });
        self.items[index as usize] = Some(item);
        self.id(index)
    }

    /// Removes and returns the item of an id, or `None` if the id is stale. The id is stale from now on.
    pub fn remove(&mut self, id: T::Id) -> Option<T> {
        let index = id.index();
        let item = self.is_current(id).then(|| self.items[index as usize].take())??;
        self.generations[index as usize] = id.generation().wrapping_add(1);
        self.free.push(index);
        Some(item)
    }

    /// Returns the item of an id, or `None` if the id is stale.
    pub fn get(&self, id: T::Id) -> Option<&T> {
        if self.is_current(id) { self.items[id.index() as usize].as_ref() } else { None }
    }

    /// Returns the item of an id, mutable, or `None` if the id is stale.
    pub fn get_mut(&mut self, id: T::Id) -> Option<&mut T> {
        if self.is_current(id) { self.items[id.index() as usize].as_mut() } else { None }
    }

    /// Returns the item of an id from the user.
    ///
    /// # Panics
    /// At the caller's location, with the reason, if the id is stale or from another world.
    #[track_caller]
    pub fn expect(&self, id: T::Id) -> &T {
        match self.get(id) {
            Some(item) => item,
            None => self.refuse(id),
        }
    }

    /// Returns the item of an id from the user, mutable.
    ///
    /// # Panics
    /// At the caller's location, with the reason, if the id is stale or from another world.
    #[track_caller]
    pub fn expect_mut(&mut self, id: T::Id) -> &mut T {
        self.expect(id);
        self.at_mut(id.index())
    }

    /// Removes and returns the item of an id from the user; the id is stale from now on.
    ///
    /// # Panics
    /// At the caller's location, with the reason, if the id is stale or from another world.
    #[track_caller]
    pub fn take(&mut self, id: T::Id) -> T {
        match self.remove(id) {
            Some(item) => item,
            None => self.refuse(id),
        }
    }

    #[track_caller]
    fn refuse(&self, id: T::Id) -> ! {
        assert!(id.lineage().goes_with(self.lineage), "{id:?} is of another world");
        match self.generations.get(id.index() as usize) {
            Some(_) => panic!("{id:?} was removed"),
            None => panic!("{id:?} was never in this world"),
        }
    }

    fn is_current(&self, id: T::Id) -> bool {
        let generation = self.generations.get(id.index() as usize);
        generation == Some(&id.generation()) && id.lineage().goes_with(self.lineage)
    }

    /// Id of the item in a slot; for a free slot, the id of the next item stored there.
    pub fn id(&self, index: u32) -> T::Id {
        T::Id::new(index, self.generations[index as usize], self.lineage)
    }

    /// Returns the item in a slot known to be in use.
    pub fn at(&self, index: u32) -> &T {
        self.items[index as usize].as_ref().expect("the index is in use")
    }

    /// Returns the item in a slot, if any.
    pub fn try_at(&self, index: u32) -> Option<&T> {
        self.items.get(index as usize)?.as_ref()
    }

    /// Returns the item in a slot known to be in use, mutable.
    pub fn at_mut(&mut self, index: u32) -> &mut T {
        self.items[index as usize].as_mut().expect("the index is in use")
    }

    /// True if no slot is in use.
    pub fn is_empty(&self) -> bool {
        self.free.len() == self.items.len()
    }

    /// Replaces every item by the result of `item` for its id and itself; keeps slots and free list.
    pub fn map<U>(self, mut item: impl FnMut(T::Id, T) -> U) -> Arena<U> {
        let Self { lineage, generations, items, free } = self;
        let slots = items.into_iter().zip(&generations).enumerate();
        let id = |index: usize, generation| T::Id::new(index as u32, generation, lineage);
        let items = slots.map(|(index, (it, &generation))| it.map(|it| item(id(index, generation), it)));
        Arena { lineage, items: items.collect(), generations, free }
    }

    /// Number of slots, free ones included.
    pub fn slot_count(&self) -> usize {
        self.items.len()
    }

    /// Items with their indices, by index.
    pub fn iter(&self) -> impl Iterator<Item = (u32, &T)> {
        self.items.iter().enumerate().filter_map(|(i, item)| Some((i as u32, item.as_ref()?)))
    }

    /// Items with their indices, by index, mutable.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (u32, &mut T)> {
        self.items.iter_mut().enumerate().filter_map(|(i, item)| Some((i as u32, item.as_mut()?)))
    }

    /// Ids of all items, by index.
    pub fn ids(&self) -> impl Iterator<Item = T::Id> {
        self.iter().map(|(index, _)| self.id(index))
    }

    /// Items with their ids, by index, mutable.
    pub fn entries_mut(&mut self) -> impl Iterator<Item = (T::Id, &mut T)> {
        let Self { lineage, generations, items, .. } = self;
        let slots = generations.iter().zip(items).enumerate();
        let id = |index: usize, generation| T::Id::new(index as u32, generation, *lineage);
        slots.filter_map(move |(i, (&generation, item))| Some((id(i, generation), item.as_mut()?)))
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

    /// Reads the format of [`save`](Self::save); the lineage is unknown, because any world may have written it.
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
        Ok(Self { lineage: Lineage::default(), generations, items, free })
    }
}
