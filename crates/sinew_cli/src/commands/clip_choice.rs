//! Selects clips of a file by the user's words.

use crate::failure::{Failure, Result};
use crate::input::motion::Motion;
use crate::report::table::shown;
use sinew::anim::Clip;
use sinew::ragdoll::settings::instead;

/// Returns the clip with that name, or with that index if no clip has the name; else the only clip whose name
/// matches case-insensitively, has the same words (without those common to all clips), or has words with
/// these prefixes.
pub fn find_clip(clips: &[Clip], name: &str) -> Result<usize, String> {
    let numbered = || name.parse().ok().filter(|&index: &usize| index < clips.len());
    if let Some(found) = clips.iter().position(|clip| clip.name == name).or_else(numbered) {
        return Ok(found);
    }
    let lower = name.to_lowercase();
    let all: Vec<Vec<String>> = clips.iter().map(|clip| words(&clip.name)).collect();
    let is_common = |word: &String| all.len() > 1 && all.iter().all(|words| words.contains(word));
    let telling = |words: &[String]| -> Vec<String> {
        let mut telling: Vec<String> = words.iter().filter(|word| !is_common(word)).cloned().collect();
        telling.sort_unstable();
        telling
    };
    let wanted = words(name);
    let those = |fits: &dyn Fn(usize) -> bool| -> Vec<usize> {
        (0..clips.len()).filter(|&index| fits(index)).collect()
    };
    let tries = [
        those(&|index| clips[index].name.to_lowercase() == lower),
        those(&|index| !wanted.is_empty() && telling(&all[index]) == telling(&wanted)),
        those(&|index| !wanted.is_empty() && begins_with_all(&all[index], &wanted)),
    ];
    if let Some(&[only]) = tries.iter().map(Vec::as_slice).find(|found| found.len() == 1) {
        return Ok(only);
    }
    if let Some(several) = tries.iter().find(|found| found.len() > 1) {
        let is_double = |index: usize| clips.iter().filter(|clip| clip.name == clips[index].name).count() > 1;
        let names: Vec<String> = several
            .iter()
            .map(|&index| match called(index, &clips[index].name) {
                called if is_double(index) => format!("{called} (number {index})"),
                called => called,
            })
            .collect();
        return Err(format!("'{name}' matches {} clips: {}", several.len(), few(&names)));
    }
    let names: Vec<String> =
        clips.iter().enumerate().map(|(index, clip)| called(index, &clip.name)).collect();
    let known = instead(name, names.iter().map(String::as_str));
    Err(match names.len() {
        0 => format!("no clip '{name}': there are no clips"),
        1..=3 => format!("no clip '{name}'; {known}"),
        _ => format!("no clip '{name}'; {known}; 'sinew inspect' lists all"),
    })
}

/// Returns the words of a name: separated by other characters, and by changes from lower case to capitals or
/// digits.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut last = ' ';
    for c in name.chars() {
        let begins = c.is_uppercase() && last.is_lowercase() || c.is_numeric() != last.is_numeric();
        if begins || !c.is_alphanumeric() {
            words.push(String::new());
        }
        if c.is_alphanumeric() {
            words.last_mut().expect("a word has been started").extend(c.to_lowercase());
        }
        last = c;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Returns true if each of the wanted words is a prefix of an existing one.
fn begins_with_all(there: &[String], wanted: &[String]) -> bool {
    wanted.iter().all(|word| there.iter().any(|other| other.starts_with(word.as_str())))
}

/// Returns the first names of a list, and the number of the others.
pub fn few(names: &[String]) -> String {
    const SHOWN: usize = 5;
    let first = names[..names.len().min(SHOWN)].join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}

/// Returns the name by which the user may call a clip.
fn called(index: usize, name: &str) -> String {
    if name.is_empty() { format!("number {index}, which has no name") } else { shown(name) }
}

/// Returns the indices of the clips that the user named, in that order; all if none were named.
pub fn choose_clips(motion: &Motion, wanted: &[String]) -> Result<Vec<usize>> {
    let clips = &motion.file.clips;
    if wanted.is_empty() {
        return Ok((0..clips.len()).collect());
    }
    let find =
        |name: &String| find_clip(clips, name).map_err(|what| Failure::at(&motion.name, what, "--clip"));
    wanted.iter().map(find).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(names: &[&str], wanted: &str) -> Result<usize, String> {
        let clip = |name: &&str| Clip { name: (*name).to_owned(), ..Clip::default() };
        find_clip(&names.iter().map(clip).collect::<Vec<_>>(), wanted)
    }

    #[test]
    fn exact_names_precede_numbers_case_and_words() {
        let names = ["Walk", "walk", "1", "Armature|Idle_Loop", "Run_Fast", "Run_Slow", "WalkBack", "RUN"];
        let wanted = [
            ("walk", 1),
            ("Walk", 0),
            ("1", 2),
            ("0", 0),
            ("idle", 3),
            ("loop idle", 3),
            ("run", 7),
            ("back-walk", 6),
            ("armature|idle_loop", 3),
        ];
        for (wanted, index) in wanted {
            assert_eq!(found(&names, wanted), Ok(index), "{wanted}");
        }
        let two = "'run' matches 2 clips: Run_Fast, Run_Slow";
        assert_eq!(found(&["Run_Fast", "Run_Slow"], "run"), Err(two.into()));
        let three = "'walk' matches 2 clips: A|Walk (number 0), A|Walk (number 2)";
        assert_eq!(found(&["A|Walk", "A|Run", "A|Walk"], "walk"), Err(three.into()));
        // A word common to all clips does not distinguish them; a word may be a prefix.
        assert_eq!(found(&["Rig|Walk", "Rig|Walk_Gun", "Rig|Idle"], "walk"), Ok(0));
        assert_eq!(found(&["Walking_A", "Running_A"], "walk"), Ok(0));
        assert!(found(&["Robot_Walking", "Robot_WalkJump"], "walk").is_err());
    }

    #[test]
    fn unknown_clip_is_reported_with_the_nearest() {
        let names = ["Walk", "Run", "Jump", "Idle", "WalkBack"];
        let line = "no clip 'wakl'; the nearest of 5 are Walk, WalkBack, Run; 'sinew inspect' lists all";
        assert_eq!(found(&names, "wakl"), Err(line.into()));
        assert_eq!(found(&["Walk"], "fly"), Err("no clip 'fly'; there is Walk".into()));
        assert_eq!(found(&[], "fly"), Err("no clip 'fly': there are no clips".into()));
    }
}
