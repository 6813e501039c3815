//! Names that a person may have meant.

use sinew_anim::roles::{HUMANOID_ROLES, Role};

/// Returns the name in `known` nearest to `name`, if at most a third of its letters differ.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let close = |&(distance, _): &(usize, &str)| distance <= name.chars().count().div_ceil(3);
    known.map(|other| (distance(name, other), other)).filter(close).min_by_key(|&(d, _)| d).map(|(_, n)| n)
}

/// Returns the three names in `known` nearest to `name`, nearest first, at any distance. Names that contain `name`, or
/// that `name` contains, come before others.
pub fn nearest_three<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let wanted = name.to_lowercase();
    // Almost every name contains a single letter.
    let is_part = |part: &str, whole: &str| part.chars().count() > 1 && whole.contains(part);
    let mut ranked: Vec<(bool, usize, &str)> = Vec::new();
    for other in known {
        let lower = other.to_lowercase();
        let apart = !(is_part(&wanted, &lower) || is_part(&lower, &wanted));
        if ranked.iter().all(|(_, _, listed)| *listed != other) {
            ranked.push((apart, unlike(&wanted, &lower), other));
        }
        ranked.sort_by_key(|&(apart, distance, _)| (apart, distance));
        ranked.truncate(3);
    }
    ranked.into_iter().map(|(_, _, other)| other).collect()
}

/// Returns the distance of two names: as a whole, or slightly more if `name` matches one word of the other name, or its
/// beginning.
fn unlike(wanted: &str, other: &str) -> usize {
    let length = wanted.chars().count();
    let of_word = |word: &str| {
        let beginning: String = word.chars().take(length).collect();
        1 + usize::min(distance(wanted, &beginning), distance(wanted, word))
    };
    let words = other.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.map(of_word).fold(distance(wanted, other), usize::min)
}

/// Returns the end of an error sentence that lists the existing names: all if few, otherwise the three nearest.
pub fn instead<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let mut known: Vec<&str> = known.collect();
    let mut seen = std::collections::BTreeSet::new();
    known.retain(|other| seen.insert(*other));
    let shown = |names: &[&str]| {
        let names: Vec<String> = names.iter().map(|name| name.escape_debug().to_string()).collect();
        names.join(", ")
    };
    match known.len() {
        0 => "there are none".to_owned(),
        1 => format!("there is {}", shown(&known)),
        2 | 3 => format!("there are {}", shown(&known)),
        count => {
            let nearest = nearest_three(name, known.iter().copied());
            format!("the nearest of {count} are {}", shown(&nearest))
        }
    }
}

/// Returns the role of that name, case-insensitive.
///
/// # Errors
/// If no role has the name: a line with the nearest three.
pub fn role_named(name: &str) -> Result<Role, String> {
    let lower = name.to_lowercase();
    let human = HUMANOID_ROLES.into_iter().find(|role| role.name().to_lowercase() == lower);
    human.or_else(|| Role::from_name(&lower)).ok_or_else(|| {
        let known: Vec<String> = HUMANOID_ROLES.into_iter().map(Role::name).collect();
        let nearest = instead(name, known.iter().map(String::as_str));
        let name = name.escape_debug();
        format!("no role `{name}`; {nearest}; of a creature spine_0, tail_0, limb_0_0 and so on")
    })
}

/// Returns the Levenshtein distance, case-insensitive; a swap of two neighbours counts as one edit.
fn distance(a: &str, b: &str) -> usize {
    let lower = |text: &str| -> Vec<char> { text.chars().flat_map(char::to_lowercase).take(64).collect() };
    let (a, b) = (lower(a), lower(b));
    let mut before: Vec<usize> = Vec::new();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut next = vec![i + 1];
        for (j, y) in b.iter().enumerate() {
            let replaced = row[j] + usize::from(x != y);
            let mut least = replaced.min(row[j + 1] + 1).min(next[j] + 1);
            if i > 0 && j > 0 && *x == b[j - 1] && a[i - 1] == *y {
                least = least.min(before[j - 1] + 1);
            }
            next.push(least);
        }
        before = core::mem::replace(&mut row, next);
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_nearest_names_are_listed() {
        let clips = ["Block", "Idle", "Cheer", "Walking_A", "Rig|Walk", "Hit_A"];
        assert_eq!(nearest_three("wlak", clips.into_iter())[..2], ["Walking_A", "Rig|Walk"]);
        let known = ["mixamorig:Spine", "mixamorig:Hips", "Hip", "Tips", "mixamorig:Head", "Hip"];
        assert_eq!(nearest_three("hips", known.into_iter()), ["mixamorig:Hips", "Hip", "Tips"]);
        assert_eq!(instead("hips", known.into_iter()), "the nearest of 5 are mixamorig:Hips, Hip, Tips");
        assert_eq!(instead("hips", ["a\n", "b"].into_iter()), r"there are a\n, b");
        assert_eq!(instead("hips", ["a"].into_iter()), "there is a");
        assert_eq!(instead("hips", [].into_iter()), "there are none");
    }
}
