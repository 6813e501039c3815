//! Links across strands that settings ask for.

use super::garments::columns;
use super::{Settings, SettingsError, SpringSource};
use sinew_anim::garments::is_ring;
use sinew_anim::{Rig, SpringLink, Springs};
use sinew_math::Vec3;

/// Links across strands as settings describe them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkSettings {
    /// Names of the joints that the strands start at, side by side; one that ends in `*` stands for several, as it does in the chains of a
    /// [garment](super::GarmentSettings::chains).
    pub chains: Vec<String>,
    /// True: the last strand is linked to the first. `None`: if they stand in a ring.
    pub closed: Option<bool>,
    /// Share and what it holds; its joints do not matter.
    pub link: SpringLink,
}

impl Settings {
    /// Springs that a character shall wear: those of `source` (an option may say another than [`springs`](Self::springs) does), with the
    /// [links](Self::spring_links) that are asked for. `up` is the axis of the rig that points up, unit.
    ///
    /// # Errors
    /// Names that the rig does not have, with the nearest ones; less than two strands; strands that do not swing: with the place.
    pub fn springs_of(&self, source: SpringSource, rig: &Rig, up: Vec3) -> Result<Springs, SettingsError> {
        let mut springs = source.springs(rig, up);
        // Who asks for no springs asks for no links.
        let listed = self.spring_links.as_ref().filter(|_| source != SpringSource::None);
        let Some(listed) = listed else { return Ok(springs) };
        let links = listed.iter().enumerate().map(|(index, links)| links.on(rig, &springs, index));
        springs.links = links.collect::<Result<Vec<_>, _>>()?.concat();
        Ok(springs)
    }
}

impl LinkSettings {
    fn on(&self, rig: &Rig, springs: &Springs, index: usize) -> Result<Vec<SpringLink>, SettingsError> {
        let place = format!("springs.links[{index}].chains");
        let mut strands = Vec::new();
        for (chain, name) in self.chains.iter().enumerate() {
            let place = format!("{place}[{chain}]");
            let found = columns(rig, name, &place)?;
            if let Some(still) = found.iter().find(|strand| !springs.swings(strand.joints[0])) {
                let name = rig.joints[still.joints[0]].name.escape_debug();
                let what = format!("`{name}` has no spring: `source` of the springs says which have");
                return Err(SettingsError::at(place, what));
            }
            strands.extend(found);
        }
        if strands.len() < 2 {
            let what = format!("links are between two strands at least, and this names {}", strands.len());
            return Err(SettingsError::at(place, what));
        }
        let closed = self.closed.unwrap_or_else(|| is_ring(rig, &strands));
        let mut links = self.link.across(&strands, closed);
        // The end of a strand that nobody knows the length of.
        links.retain(|link| link.joints.iter().all(|&joint| springs.swings(joint)));
        Ok(links)
    }
}
