//! Sizes of animals, by words in file names.

use super::names::words;
use crate::rig::Rig;

/// Longest side of a grown animal, metres: for most from nose to tail, for flying birds and insects across the wings.
///
/// Round values from field guides; insects have the size that games give them, at most a cat's.
const LENGTHS: &[(&str, f32)] = &[
    ("ant beetle bug fly mosquito ladybug", 0.3),
    ("bee wasp hornet butterfly dragonfly moth", 0.35),
    ("spider scorpion tarantula", 0.4),
    ("mouse hamster chick sparrow", 0.2),
    ("frog toad hedgehog squirrel quokka snail", 0.35),
    ("rat parrot crow raven pigeon dove bat crab lobster hen chicken rooster duck", 0.5),
    ("rabbit bunny hare cat kitten owl turtle tortoise gull seagull hawk falcon", 0.6),
    ("penguin raccoon badger beaver monkey goose", 0.9),
    ("fox corgi pug shiba otter", 1.1),
    ("dog husky puppy labrador retriever goat sheep lamb", 1.4),
    ("wolf coyote hyena pig boar cheetah kangaroo ostrich", 1.7),
    ("deer doe stag alpaca llama donkey leopard jaguar panther chimpanzee gorilla vulture", 2.1),
    ("eagle bear panda pony dolphin lion lioness tiger seal iguana", 2.3),
    ("horse cow bull zebra unicorn buffalo bison yak moose camel snake python cobra", 2.5),
    ("velociraptor raptor", 2.2),
    ("hippo hippopotamus rhino rhinoceros shark crocodile alligator", 3.7),
    ("giraffe elephant mammoth", 5.5),
    ("dragon orca", 7.0),
    ("stegosaurus triceratops parasaurolophus pteranodon", 8.0),
    ("trex tyrannosaurus apatosaurus brontosaurus diplodocus whale", 13.0),
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
        let (list, length) = LENGTHS.iter().find(|(list, _)| is_in(list, word))?;
        let known = list.split(' ').find(|known| known == word)?;
        Some(Species::Animal(known, *length))
    });
    let human = || spoken.iter().any(|word| is_in(HUMANS, word)).then_some(Species::Human);
    animal.or_else(human)
}
