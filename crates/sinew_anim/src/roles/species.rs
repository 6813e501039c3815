//! Sizes and masses of animals, by words in file names.

use super::names::words;
use crate::rig::Rig;

/// Longest side of grown animals, metres, for most from nose to tail, for flying birds and insects across the wings; and
/// their least and largest mass, kg.
///
/// Round values from field guides; insects and spiders have the size that games give them, at most a cat's, and no mass.
const GROWN: &[(&str, f32, Option<[f32; 2]>)] = &[
    ("ant beetle bug fly mosquito ladybug", 0.3, None),
    ("bee wasp hornet butterfly dragonfly moth", 0.35, None),
    ("spider scorpion tarantula", 0.4, None),
    ("mouse hamster chick sparrow", 0.2, Some([0.02, 0.5])),
    ("frog toad hedgehog squirrel quokka snail", 0.35, Some([0.05, 4.0])),
    ("rat parrot crow raven pigeon dove bat crab lobster hen chicken rooster duck", 0.5, Some([0.1, 5.0])),
    ("rabbit bunny hare cat kitten owl turtle tortoise gull seagull hawk falcon", 0.6, Some([0.5, 8.0])),
    ("penguin raccoon badger beaver monkey goose", 0.9, Some([3.0, 35.0])),
    ("fox corgi pug shiba otter", 1.1, Some([4.0, 15.0])),
    ("dog husky puppy labrador retriever", 1.4, Some([8.0, 45.0])),
    ("goat sheep lamb", 1.4, Some([20.0, 100.0])),
    ("wolf coyote hyena cheetah", 1.7, Some([15.0, 70.0])),
    ("pig boar kangaroo ostrich", 1.7, Some([30.0, 200.0])),
    ("deer doe stag alpaca leopard jaguar panther chimpanzee", 2.1, Some([30.0, 180.0])),
    ("llama donkey gorilla", 2.1, Some([60.0, 300.0])),
    ("vulture", 2.1, Some([4.0, 14.0])),
    ("eagle iguana", 2.3, Some([2.0, 10.0])),
    ("bear panda pony dolphin lion lioness tiger seal", 2.3, Some([70.0, 500.0])),
    ("horse cow bull zebra unicorn buffalo bison yak moose camel", 2.5, Some([200.0, 1100.0])),
    ("snake python cobra", 2.5, Some([0.5, 90.0])),
    ("velociraptor raptor", 2.2, Some([10.0, 100.0])),
    ("hippo hippopotamus rhino rhinoceros shark crocodile alligator", 3.7, Some([200.0, 3000.0])),
    ("giraffe elephant mammoth", 5.5, Some([700.0, 7000.0])),
    ("dragon orca", 7.0, None),
    ("stegosaurus triceratops parasaurolophus pteranodon", 8.0, None),
    ("trex tyrannosaurus apatosaurus brontosaurus diplodocus whale", 13.0, None),
];

/// Words for humans. A body named so is measured like a human even if its joints show none.
const HUMANS: &str = "archer bandit boy chef cowboy doctor farmer girl guard hero heroine human knight mage man ninja npc \
    officer paladin people person pirate player policeman ranger samurai soldier villager warrior witch wizard woman zombie";

/// Words for machines, which have any size, even if they resemble an animal.
const MACHINES: &str = "bot robot mech mecha drone toy plush statue";

/// Kind of body according to the names of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Species {
    /// A human.
    Human,
    /// An animal, and the length of an adult animal, metres.
    Animal(&'static str, f32),
}

/// Kind of animal that a file names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Animal {
    /// Name of the kind, a word of the file.
    pub name: &'static str,
    /// Longest side of a grown animal, metres.
    pub length: f32,
    /// Least and largest mass of grown animals, kg.
    pub mass: [f32; 2],
    /// Longest side of the character's skin, file units.
    pub size: f32,
}

impl Animal {
    /// Returns the kind named `name` for a character of that size, file units; `None` for kinds without a usual mass.
    pub(super) fn of(name: &'static str, size: f32) -> Option<Self> {
        let (_, length, mass) = GROWN.iter().find(|(list, ..)| list.split(' ').any(|known| known == name))?;
        Some(Self { name, length: *length, mass: (*mass)?, size })
    }

    /// Returns the least and the largest mass of such an animal at the character's size, kg.
    pub fn mass_at(&self, unit_scale: f32) -> [f32; 2] {
        let times = self.size * unit_scale / self.length;
        self.mass.map(|kg| kg * times * times * times)
    }
}

/// Returns the kind of body according to file names; an animal comes before a human (snowman, wolfman).
pub(super) fn named<'a>(rig: &'a Rig, file: &'a str) -> Option<Species> {
    let is_root = |joint: &&crate::rig::Joint| joint.parent.is_none();
    let names = core::iter::once(file)
        .chain(rig.meshes.iter().map(|mesh| mesh.name.as_str()))
        .chain(rig.skins.iter().map(|skin| skin.name.as_str()))
        .chain(rig.joints.iter().filter(is_root).map(|joint| joint.name.as_str()));
    let spoken: Vec<String> = names.flat_map(words).collect();
    let is_in = |list: &str, word: &str| list.split(' ').any(|known| known == word);
    if spoken.iter().any(|word| is_in(MACHINES, word)) {
        return None;
    }
    let animal = spoken.iter().find_map(|word| {
        let (list, length, _) = GROWN.iter().find(|(list, ..)| is_in(list, word))?;
        let known = list.split(' ').find(|known| known == word)?;
        Some(Species::Animal(known, *length))
    });
    let human = || spoken.iter().any(|word| is_in(HUMANS, word)).then_some(Species::Human);
    animal.or_else(human)
}
