//! Links across strands requested by settings.

use super::garments::columns;
use super::{Settings, SettingsError, SpringSource};
use sinew_anim::garments::is_ring;
use sinew_anim::{Rig, SpringLink, Springs};
use sinew_math::Vec3;

/// Links across strands, as described by settings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkSettings {
    /// Names of the first joints of the strands, side by side. A name that ends in `*` matches several, as in the
    /// chains of a [garment](super::GarmentSettings::chains).
    pub chains: Vec<String>,
    /// True if the last strand is linked to the first. `None`: linked if the strands form a ring.
    pub closed: Option<bool>,
    /// Share of the link and its bounds; its joints are ignored.
    pub link: SpringLink,
}

impl Settings {
    /// Returns the springs for a character: those of `source` (an option may override [`springs`](Self::springs)), with
    /// the requested [links](Self::spring_links). `up` is the rig's up axis, unit.
    ///
    /// # Errors
    /// For names that the rig does not have, with the nearest ones; fewer than two strands; strands that do not swing;
    /// with the setting's key.
    pub fn springs_of(&self, source: SpringSource, rig: &Rig, up: Vec3) -> Result<Springs, SettingsError> {
        let mut springs = source.springs(rig, up);
        // Links need springs.
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
        // The end of such a strand has an unknown length.
        links.retain(|link| link.joints.iter().all(|&joint| springs.swings(joint)));
        Ok(links)
    }
}
