//! Rust source as a list of tokens: just enough of the language to tell code from comments and strings.

/// Kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Identifier or keyword.
    Word,
    /// Number.
    Number,
    /// String, byte string or character, with its quotes.
    Literal,
    /// Lifetime, such as `'a`.
    Lifetime,
    /// Punctuation: one character, or `::`.
    Mark,
}

/// A piece of code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    /// Kind of the token.
    pub kind: Kind,
    /// Text as written.
    pub text: &'a str,
    /// Line on which the token starts, from 1.
    pub line: usize,
}

/// Returns all tokens of `source`, without comments.
pub fn tokens(source: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let (mut at, mut line) = (0, 1);
    while at < source.len() {
        let rest = &source[at..];
        let (kind, length) = next(rest);
        let text = &rest[..length];
        tokens.extend(kind.map(|kind| Token { kind, text, line }));
        line += text.matches('\n').count();
        at += length;
    }
    tokens
}

/// Returns the kind (`None` for space and comments) and the length in bytes of the start of `rest`.
fn next(rest: &str) -> (Option<Kind>, usize) {
    let first = rest.chars().next().unwrap_or(' ');
    if first.is_whitespace() {
        (None, first.len_utf8())
    } else if rest.starts_with("//") {
        (None, rest.find('\n').unwrap_or(rest.len()))
    } else if rest.starts_with("/*") {
        (None, block_comment(rest))
    } else if let Some(length) = string(rest) {
        (Some(Kind::Literal), length)
    } else if first == '\'' {
        quote(rest)
    } else if first.is_ascii_digit() {
        (Some(Kind::Number), number(rest))
    } else if is_word(first) {
        let raw = if rest.starts_with("r#") { 2 } else { 0 };
        (Some(Kind::Word), raw + word(&rest[raw..]))
    } else if rest.starts_with("::") {
        (Some(Kind::Mark), 2)
    } else {
        (Some(Kind::Mark), first.len_utf8())
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn word(rest: &str) -> usize {
    rest.find(|c| !is_word(c)).unwrap_or(rest.len())
}

/// Returns the length of the comment, nested ones included.
fn block_comment(rest: &str) -> usize {
    let mut depth = 0;
    let mut at = 0;
    while at < rest.len() {
        if rest[at..].starts_with("/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest[at..].starts_with("*/") {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                break;
            }
        } else {
            at += rest[at..].chars().next().map_or(1, char::len_utf8);
        }
    }
    at
}

/// Returns the length of a string of any kind, prefix and quotes included; `None` if `rest` does not start
/// with one.
fn string(rest: &str) -> Option<usize> {
    let prefix = ["br", "cr", "b", "c", "r", ""].into_iter().find(|&prefix| {
        let after = rest.strip_prefix(prefix).unwrap_or_default();
        let is_raw = prefix.ends_with('r');
        after.starts_with('"') || (is_raw && after.trim_start_matches('#').starts_with('"'))
    })?;
    let body = &rest[prefix.len()..];
    if prefix.ends_with('r') {
        let hashes = body.find('"')?;
        let end = format!("\"{}", "#".repeat(hashes));
        let open = hashes + 1;
        return Some(prefix.len() + body[open..].find(&end).map_or(body.len(), |at| open + at + end.len()));
    }
    Some(prefix.len() + quoted(body, '"'))
}

/// Returns the length of `rest` up to and with the closing `quote`; the first character is the opening quote.
fn quoted(rest: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in rest.char_indices().skip(1) {
        if c == quote && !escaped {
            return at + c.len_utf8();
        }
        escaped = c == '\\' && !escaped;
    }
    rest.len()
}

/// Returns the kind and the length of a character or a lifetime.
fn quote(rest: &str) -> (Option<Kind>, usize) {
    let mut following = rest.chars().skip(1);
    let (second, third) = (following.next(), following.next());
    if second == Some('\\') || third == Some('\'') {
        (Some(Kind::Literal), quoted(rest, '\''))
    } else {
        (Some(Kind::Lifetime), 1 + word(&rest[1..]))
    }
}

/// Returns the length of a number: `1`, `1.5`, `1.`, `1e-3_f32`, `0x1F`; but only the `1` of `1..2` and of
/// `1.max(2)`.
fn number(rest: &str) -> usize {
    let mut length = word(rest);
    let after = &rest[length..];
    if let Some(fraction) = after.strip_prefix('.') {
        let next = fraction.chars().next().unwrap_or(' ');
        if next.is_ascii_digit() || (next != '.' && !is_word(next)) {
            length += 1 + word(fraction);
        }
    }
    let has_exponent = !rest.starts_with("0x") && rest[..length].ends_with(['e', 'E']);
    if has_exponent && rest[length..].starts_with(['-', '+']) {
        length += 1 + word(&rest[length + 1..]);
    }
    length
}

/// Returns the indices at which the tokens of `pattern` (separated by spaces) follow each other.
pub fn find<'a>(tokens: &'a [Token<'_>], pattern: &str) -> impl Iterator<Item = usize> + use<'a> {
    let pattern: Vec<String> = pattern.split(' ').map(str::to_owned).collect();
    (0..tokens.len()).filter(move |&at| {
        let found = tokens[at..].iter().map(|token| token.text);
        pattern.len() <= tokens.len() - at && found.zip(&pattern).all(|(found, wanted)| found == wanted)
    })
}

/// Returns the index of the bracket that closes the one at `open`; the last token if none does.
pub fn closing(tokens: &[Token<'_>], open: usize) -> usize {
    let mut depth = 0_usize;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match token.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => continue,
        }
        if depth == 0 {
            return at;
        }
    }
    tokens.len() - 1
}

/// Returns `tokens` without the items that carry `#[cfg(test)]`.
pub fn without_tests<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let mut kept = Vec::with_capacity(tokens.len());
    let mut at = 0;
    let mut attributes = find(tokens, "# [ cfg ( test ) ]").peekable();
    while at < tokens.len() {
        while attributes.next_if(|&attribute| attribute < at).is_some() {}
        if attributes.next_if_eq(&at).is_some() {
            at = end_of_item(tokens, at + 7) + 1;
        } else {
            kept.push(tokens[at]);
            at += 1;
        }
    }
    kept
}

/// Returns the index of the `;` or closing brace that ends the item at `start`.
pub fn end_of_item(tokens: &[Token<'_>], start: usize) -> usize {
    let mut at = start;
    while at < tokens.len() {
        match tokens[at].text {
            ";" => return at,
            "{" => return closing(tokens, at),
            "(" | "[" => at = closing(tokens, at) + 1,
            _ => at += 1,
        }
    }
    tokens.len() - 1
}

/// Returns the parts of a list between its commas, without splitting brackets.
pub fn parts<'b, 'a>(list: &'b [Token<'a>]) -> Vec<&'b [Token<'a>]> {
    let mut parts = Vec::new();
    let (mut at, mut start) = (0, 0);
    while at < list.len() {
        match list[at].text {
            "(" | "[" | "{" => at = closing(list, at),
            "," => {
                parts.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
        at += 1;
    }
    parts.push(&list[start..]);
    parts.retain(|part| !part.is_empty());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(source: &str, expected: &str) {
        let texts: Vec<&str> = tokens(source).iter().map(|token| token.text).collect();
        assert_eq!(texts.join(" "), expected);
    }

    #[test]
    fn comments_are_skipped_and_strings_are_one_token() {
        check("a /* b /* c */ d */ e // f\ng", "a e g");
        check(r#"x("a \" b", 'c', '\'', b"d")"#, r#"x ( "a \" b" , 'c' , '\'' , b"d" )"#);
        check(r###"r#"a " b"# r"\" r#type"###, r###"r#"a " b"# r"\" r#type"###);
        check("fn f<'a>(x: &'a str)", "fn f < 'a > ( x : & 'a str )");
    }

    #[test]
    fn numbers_end_where_ranges_and_methods_begin() {
        check(
            "0..3 1.5e-3_f32 1.max(2) x.0.y 2. 0x1e+1",
            "0 . . 3 1.5e-3_f32 1 . max ( 2 ) x . 0 . y 2. 0x1e + 1",
        );
    }

    #[test]
    fn lines_count_through_strings_and_comments() {
        let found = tokens("\"a\nb\" /*\n*/ x\ny");
        assert_eq!(found.iter().map(|token| token.line).collect::<Vec<_>>(), [1, 3, 4]);
    }

    #[test]
    fn test_items_are_cut() {
        let source = "a; #[cfg(test)] mod tests { fn b() { c } } d; #[cfg(test)] use e; f";
        let kept = without_tests(&tokens(source));
        assert_eq!(kept.iter().map(|token| token.text).collect::<String>(), "a;d;f");
    }
}
