//! Splits the names of a rig into words and drops words that most names share.

use super::lexicon::{LANGUAGES, Word, meaning, meanings};
use std::collections::BTreeMap;

/// A word of a name, in lower case, with its meaning; `None` if unknown.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub text: String,
    pub words: Option<Vec<Word>>,
}

/// Number of names below which shared words are coincidence.
const FEW: usize = 4;

/// Returns the words of every name, without numbers and without the rig's own prefixes and suffixes.
pub(super) fn tokens(names: &[&str]) -> Vec<Vec<Token>> {
    let mut split: Vec<Vec<String>> = names.iter().map(|name| words(name)).collect();
    name_vertebrae(names, &mut split);
    // If a name has "rt", "lf" means left; otherwise it means left front.
    let has = |wanted: &str| split.iter().flatten().any(|word| word == wanted);
    if has("rt") && !has("rf") {
        split.iter_mut().flatten().filter(|word| *word == "lf").for_each(|word| *word = "left".into());
    }
    translate(&mut split);
    cut_glued_prefix(&mut split);
    let own = own_words(&split);
    let token = |text: String| Token { words: meanings(&text), text };
    let telling = |words: Vec<String>| {
        let all: Vec<Token> = words.into_iter().map(token).collect();
        let is_own = |at: usize, token: &Token| {
            own.iter().any(|(word, anywhere)| *word == token.text && (*anywhere || at == 0 && all.len() > 1))
        };
        let kept = all.iter().enumerate().filter(|(at, token)| !is_own(*at, token));
        kept.map(|(_, token)| token.clone()).collect()
    };
    split.into_iter().map(telling).collect()
}

/// Replaces words of one language by words of the lexicon.
fn translate(split: &mut [Vec<String>]) {
    // French writes "avant-bras" as two words.
    for words in split.iter_mut() {
        if let Some(at) = words.windows(2).position(|pair| pair[0] == "avant" && pair[1] == "bras") {
            words.splice(at..at + 2, ["forearm".to_owned()]);
        }
    }
    for (tells, meant) in LANGUAGES {
        let is_told = |word: &String| tells.split(' ').any(|known| known == word);
        if !split.iter().flatten().any(is_told) {
            continue;
        }
        for word in split.iter_mut().flatten() {
            if let Some((_, other)) = meant.iter().find(|(known, _)| known == word) {
                *word = (*other).to_owned();
            }
        }
    }
}

/// Reads the spine in Xsens' names, which are vertebrae, L5 to T8. If there is an R1, L1 means left.
fn name_vertebrae(names: &[&str], split: &mut [Vec<String>]) {
    let numbered = |name: &str, letter: char| {
        let rest = name.strip_prefix(letter).or_else(|| name.strip_prefix(letter.to_ascii_uppercase()));
        rest.is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|byte| byte.is_ascii_digit()))
    };
    let any = |letter: char| names.iter().any(|name| numbered(name, letter));
    if !(any('l') && any('t')) || any('r') {
        return;
    }
    for (name, words) in names.iter().zip(split) {
        if numbered(name, 'l') || numbered(name, 't') {
            *words = vec!["spine".into()];
        }
    }
}

/// Returns words without information because most names have them: unknown words anywhere in half of all names, and
/// known words at the start of nearly all.
fn own_words(split: &[Vec<String>]) -> Vec<(String, bool)> {
    let named = split.iter().filter(|words| !words.is_empty()).count();
    let (mut anywhere, mut first): (BTreeMap<&str, usize>, BTreeMap<&str, usize>) = Default::default();
    for words in split {
        for (i, word) in words.iter().enumerate() {
            *anywhere.entry(word).or_default() += usize::from(!words[..i].contains(word));
        }
        if let Some(word) = words.first() {
            *first.entry(word).or_default() += 1;
        }
    }
    let common = |&(_, &count): &(&&str, &usize), tenths: usize| count >= FEW && 10 * count >= tenths * named;
    let unknown = anywhere.iter().filter(|entry| common(entry, 5) && meanings(entry.0).is_none());
    let known = first.iter().filter(|entry| common(entry, 8));
    let mut own: Vec<(String, bool)> = unknown.map(|(word, _)| ((*word).to_owned(), true)).collect();
    own.extend(known.map(|(word, _)| ((*word).to_owned(), false)));
    own.sort_unstable();
    own
}

/// Removes a prefix that half of all first words have, if the prefix is no known word and the rest of each first word
/// is known ("herohips", "herospine").
fn cut_glued_prefix(split: &mut [Vec<String>]) {
    let unknown = |words: &&Vec<String>| words.first().is_some_and(|word| meanings(word).is_none());
    let firsts: Vec<&str> = split.iter().filter(unknown).map(|words| words[0].as_str()).collect();
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for word in &firsts {
        for (end, _) in word.char_indices().skip(1) {
            *counts.entry(&word[..end]).or_default() += usize::from(meanings(&word[end..]).is_some());
        }
    }
    let named = split.iter().filter(|words| !words.is_empty()).count();
    let common = |&(_, &count): &(&&str, &usize)| count >= FEW && 2 * count >= named;
    let longest = counts.iter().filter(common).map(|(prefix, _)| *prefix);
    let Some(prefix) = longest.max_by_key(|prefix| (counts[prefix], prefix.len(), *prefix)) else { return };
    let prefix = prefix.to_owned();
    for word in split.iter_mut().filter_map(|words| words.first_mut()) {
        if meaning(word).is_none()
            && let Some(rest) = word.strip_prefix(&prefix).filter(|rest| !rest.is_empty())
        {
            *word = rest.to_owned();
        }
    }
}

/// Splits a name into words in lower case: at punctuation, digits, capitals in camel case ("LHipJoint": l, hip, joint)
/// and between Latin and other letters; drops namespaces and numbers. If camel case gives no known words but the text
/// without it does ("UPPERarm", "fOOT"), case is ignored.
pub(crate) fn words(name: &str) -> Vec<String> {
    let bare = name.rsplit([':', '|']).find(|part| !part.is_empty()).unwrap_or(name);
    let chars: Vec<char> = bare.chars().map(half_width).collect();
    let mut runs = vec![Vec::new()];
    for (i, &c) in chars.iter().enumerate() {
        let before = i.checked_sub(1).map(|b| chars[b]);
        let digits = before.is_some_and(|b| b.is_ascii_digit() != c.is_ascii_digit());
        let script = before.is_some_and(|b| (b < '\u{3000}') != (c < '\u{3000}'));
        if digits || script || !c.is_alphanumeric() {
            runs.push(Vec::new());
        }
        if c.is_alphanumeric() {
            runs.last_mut().expect("starts with one run").push(c);
        }
    }
    let mut words: Vec<String> = runs.iter().flat_map(|run| humps(run)).collect();
    words.retain(|word| !word.is_empty() && !word.starts_with(|c: char| c.is_ascii_digit()));
    words
}

/// Splits a run of letters in camel case into words in lower case.
fn humps(run: &[char]) -> Vec<String> {
    let mut words = vec![String::new()];
    for (i, &c) in run.iter().enumerate() {
        let before = i.checked_sub(1).map(|b| run[b]);
        let rises = before.is_some_and(char::is_lowercase);
        if c.is_uppercase() && (rises || run.get(i + 1).is_some_and(|next| next.is_lowercase())) {
            words.push(String::new());
        }
        words.last_mut().expect("starts with one word").extend(c.to_lowercase());
    }
    words.retain(|word| !word.is_empty());
    if words.iter().any(|word| meanings(word).is_none()) {
        let whole: String = words.concat();
        if meanings(&whole).is_some() {
            return vec![whole];
        }
    }
    words
}

/// Converts a full-width letter to ASCII: MMD writes "ＩＫ".
fn half_width(c: char) -> char {
    match c {
        '\u{ff01}'..='\u{ff5e}' => char::from_u32(u32::from(c) - 0xfee0).unwrap_or(c),
        _ => c,
    }
}
