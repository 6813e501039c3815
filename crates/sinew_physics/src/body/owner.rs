//! Owners: code above the world, such as a character, that creates bodies and joints and removes them itself.

use sinew_math::{ReadError, Reader, Writer};

/// Name of code that owns bodies and joints of a world, and the calls that remove them.
/// [`World::remove_body`](crate::World::remove_body) and [`World::remove_joint`](crate::World::remove_joint) panic with
/// these texts for an owned item.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Owner {
    /// Name of the kind of owner: "character".
    pub name: String,
    /// Calls to use instead: "`Character::detach` cuts a limb off".
    pub calls: String,
    /// Names of the owner's parts: "leftUpperArm".
    pub parts: Vec<String>,
}

/// Owner and part of a body or joint, by number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct OwnerMark {
    owner: u16,
    part: u16,
}

/// Registered owners, each once; none is ever removed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Owners {
    all: Vec<Owner>,
}

impl Owners {
    /// Returns the number of an owner; adds the owner if it is unknown.
    pub fn number(&mut self, owner: &Owner) -> u16 {
        let known = self.all.iter().position(|known| known == owner);
        let index = known.unwrap_or_else(|| {
            self.all.push(owner.clone());
            self.all.len() - 1
        });
        u16::try_from(index).expect("at most 65,536 owners")
    }

    /// Returns the mark of a part of an owner.
    ///
    /// # Panics
    /// If the owner has no such part.
    #[track_caller]
    pub fn mark(&self, owner: u16, part: usize) -> OwnerMark {
        let parts = self.all[usize::from(owner)].parts.len();
        assert!(part < parts, "an owner of {parts} parts has no part {part}");
        OwnerMark { owner, part: u16::try_from(part).expect("at most 65,536 parts") }
    }

    /// Returns the owner and the name of the part of a mark.
    pub fn of(&self, mark: OwnerMark) -> (&Owner, &str) {
        let owner = &self.all[usize::from(mark.owner)];
        (owner, &owner.parts[usize::from(mark.part)])
    }
}

/// Owners in a snapshot: each is written at its first use, so that a snapshot without owners needs no extra bytes.
#[derive(Debug, Default)]
pub(crate) struct OwnersInOrder {
    /// Numbers in [`Owners`], in the order of first use in the snapshot.
    named: Vec<u16>,
}

impl OwnersInOrder {
    pub fn save(&mut self, owners: &Owners, mark: OwnerMark, w: &mut Writer) {
        let known = self.named.iter().position(|&owner| owner == mark.owner);
        w.u32((known.unwrap_or(self.named.len()) as u32) << 16 | u32::from(mark.part));
        if known.is_none() {
            self.named.push(mark.owner);
            let Owner { name, calls, parts } = owners.of(mark).0;
            w.text(name);
            w.text(calls);
            w.count(parts.len());
            parts.iter().for_each(|part| w.text(part));
        }
    }

    pub fn load(&mut self, owners: &mut Owners, r: &mut Reader<'_>) -> Result<OwnerMark, ReadError> {
        let bits = r.u32()?;
        let (at, part) = ((bits >> 16) as usize, (bits & 0xffff) as u16);
        if at == self.named.len() {
            let (name, calls) = (r.text()?.to_owned(), r.text()?.to_owned());
            let mut owner = Owner { name, calls, parts: Vec::new() };
            for _ in 0..r.count(4)? {
                owner.parts.push(r.text()?.to_owned());
            }
            self.named.push(owners.number(&owner));
        }
        let Some(&owner) = self.named.get(at) else {
            return Err(r.error("names an owner that is not there"));
        };
        if usize::from(part) >= owners.all[usize::from(owner)].parts.len() {
            return Err(r.error("names a part that its owner does not have"));
        }
        Ok(OwnerMark { owner, part })
    }
}
