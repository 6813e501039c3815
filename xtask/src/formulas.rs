//! Converts formulas of the book, written as inline code, to MathML.
//!
//! Code is a formula if it consists of letters, numbers, operators and functions and contains at least one sign that
//! code does not have. Other code is unchanged.

use std::iter::Peekable;
use std::vec::IntoIter;

/// Functions, written upright.
const FUNCTIONS: [&str; 10] = ["sinh", "cosh", "tanh", "sin", "cos", "tan", "asin", "acos", "atan", "exp"];
/// Units, written upright.
const UNITS: [&str; 4] = ["m", "cm", "mm", "s"];
/// Operators between terms, from the loosest.
const RELATIONS: &str = "=≤≥<>≈";
const SUMS: &str = "+−±-";
const PRODUCTS: &str = "·×∗";
/// Signs that occur in formulas only.
const SIGNS: &str = "=≤≥≈+−·×√π½¼⅓Σ∑μθωαρτφΩΔ²³⁻¹ⁿ‖°₀₁₂₃₄₅₆₇₈₉ₖ′⌊∠/";
const SUBSCRIPTS: &str = "₀₁₂₃₄₅₆₇₈₉ₖₙ";
const PLAIN_SUBSCRIPTS: &str = "0123456789kn";
const SUPERSCRIPTS: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻ⁿᵀ";
const PLAIN_SUPERSCRIPTS: &str = "0123456789−nT";

const SUM: &str = "<mo>∑</mo>";

/// A token of a formula.
#[derive(Clone, Debug, PartialEq)]
enum Token {
    /// A number, name, function or unit, as MathML.
    Atom(String),
    /// Index marks: subscript, superscript.
    Below(String),
    Above(String),
    Function(String),
    Root,
    Open(char),
    Close(char),
    /// `|` or `‖`, which opens and closes.
    Bar(char),
    Operator(char),
    /// A fraction slash; true if spaces surround it, so that the whole following product is the denominator.
    Over(bool),
    Space,
    Comma,
}

/// Converts a formula to MathML; `None` for code.
pub fn mathml(code: &str, is_display: bool) -> Option<String> {
    let is_code = ["::", "--", "sinew", "(axis", "_from", "()", "{", "\"", "motion"]
        .iter()
        .any(|part| code.contains(part));
    if is_code || !code.chars().any(|c| SIGNS.contains(c)) {
        return None;
    }
    let mut formula = Formula { tokens: tokens(code.trim().trim_end_matches('.'))?.into_iter().peekable() };
    let content = formula.list()?;
    if formula.tokens.next().is_some() {
        return None;
    }
    let display = if is_display { " display=\"block\"" } else { "" };
    Some(format!("<math{display}>{content}</math>"))
}

fn tokens(code: &str) -> Option<Vec<Token>> {
    let chars: Vec<char> = code.chars().collect();
    let mut tokens = Vec::new();
    let mut at = 0;
    while at < chars.len() {
        let c = chars[at];
        let run = |is: &dyn Fn(char) -> bool| chars[at..].iter().take_while(|&&c| is(c)).collect::<String>();
        let (token, length) = match c {
            ' ' => (Token::Space, 1),
            ',' => (Token::Comma, 1),
            '√' => (Token::Root, 1),
            '(' | '[' | '⌊' => (Token::Open(c), 1),
            ')' | ']' | '⌋' => (Token::Close(c), 1),
            '|' | '‖' => (Token::Bar(c), 1),
            '/' => (Token::Over(at > 0 && chars[at - 1] == ' '), 1),
            _ if RELATIONS.contains(c) || SUMS.contains(c) || PRODUCTS.contains(c) => (Token::Operator(c), 1),
            _ if SUBSCRIPTS.contains(c) => {
                let text = run(&|c| SUBSCRIPTS.contains(c));
                (Token::Below(leaf(&translated(&text, SUBSCRIPTS, PLAIN_SUBSCRIPTS))), text.chars().count())
            }
            _ if SUPERSCRIPTS.contains(c) => {
                let text = run(&|c| SUPERSCRIPTS.contains(c));
                (
                    Token::Above(leaf(&translated(&text, SUPERSCRIPTS, PLAIN_SUPERSCRIPTS))),
                    text.chars().count(),
                )
            }
            '′' => (Token::Above("<mo>′</mo>".to_owned()), 1),
            '_' => {
                let name: String = chars[at + 1..].iter().take_while(|c| c.is_alphabetic()).collect();
                if name.chars().count() != 1 {
                    return None;
                }
                (Token::Below(format!("<mi>{name}</mi>")), 2)
            }
            '°' => (Token::Atom("<mo>°</mo>".to_owned()), 1),
            _ if c.is_ascii_digit() => {
                let text = run(&|c| c.is_ascii_digit() || c == '.');
                (Token::Atom(format!("<mn>{text}</mn>")), text.len())
            }
            '½' => (Token::Atom("<mfrac><mn>1</mn><mn>2</mn></mfrac>".to_owned()), 1),
            'Σ' => (Token::Atom(SUM.to_owned()), 1),
            _ if c.is_ascii_alphabetic() => {
                let text = run(&|c| c.is_ascii_alphabetic());
                (word(&text)?, text.len())
            }
            _ if c.is_alphabetic() => (Token::Atom(format!("<mi>{c}</mi>")), 1),
            _ => return None,
        };
        tokens.push(token);
        at += length;
    }
    Some(tokens)
}

fn translated(text: &str, from: &str, to: &str) -> String {
    text.chars().filter_map(|c| to.chars().nth(from.chars().position(|it| it == c)?)).collect()
}

/// Reads an index: a number with its sign, or a name.
fn leaf(text: &str) -> String {
    let one = |c: char| match c {
        '−' => "<mo>−</mo>".to_owned(),
        _ if c.is_ascii_digit() => format!("<mn>{c}</mn>"),
        _ => format!("<mi>{c}</mi>"),
    };
    format!("<mrow>{}</mrow>", text.chars().map(one).collect::<String>())
}

/// Converts a function, a unit, a differential, or adjacent names; `None` for a word of text.
fn word(text: &str) -> Option<Token> {
    if FUNCTIONS.contains(&text) {
        return Some(Token::Function(text.to_owned()));
    }
    if text.chars().count() == 1 {
        return Some(Token::Atom(format!("<mi>{text}</mi>")));
    }
    if UNITS.contains(&text) {
        return Some(Token::Atom(format!("<mi mathvariant=\"normal\">{text}</mi>")));
    }
    // Two letters are a product.
    let names: Vec<char> = text.chars().collect();
    (names.len() == 2)
        .then(|| Token::Atom(format!("<mrow><mi>{}</mi><mi>{}</mi></mrow>", names[0], names[1])))
}

struct Formula {
    tokens: Peekable<IntoIter<Token>>,
}

impl Formula {
    fn skip(&mut self) {
        while self.tokens.next_if_eq(&Token::Space).is_some() {}
    }

    /// Reads formulas separated by commas.
    fn list(&mut self) -> Option<String> {
        let mut out = self.chain()?;
        while self.tokens.next_if_eq(&Token::Comma).is_some() {
            out += &format!("<mo>,</mo>{}", self.chain()?);
        }
        Some(out)
    }

    /// Reads products separated by operators.
    fn chain(&mut self) -> Option<String> {
        let mut out = String::new();
        loop {
            self.skip();
            match self.tokens.peek() {
                Some(&Token::Operator(sign)) => {
                    self.tokens.next();
                    let sign = match sign {
                        '-' => '−',
                        '<' => return None,
                        sign => sign,
                    };
                    out += &format!("<mo>{sign}</mo>");
                }
                Some(Token::Close(_) | Token::Bar(_) | Token::Comma) | None if !out.is_empty() => {
                    return Some(out);
                }
                Some(Token::Close(_) | Token::Comma) | None => return None,
                _ => {
                    out += &self.product()?;
                    self.skip();
                    // A product ends at a sign, a closing bracket, or the end of the formula.
                    if !matches!(self.tokens.peek(), Some(Token::Operator(_))) {
                        return Some(out);
                    }
                }
            }
        }
    }

    /// Reads adjacent factors, with an optional denominator.
    fn product(&mut self) -> Option<String> {
        let mut out = self.factors(true)?;
        while let Some(&Token::Over(takes_all)) = self.tokens.peek() {
            self.tokens.next();
            let below = self.factors(takes_all)?;
            // After a sum, a narrow fraction is the last term; a wide one has the whole sum as its numerator.
            let after_sum = out.rfind(SUM).map_or(0, |at| if takes_all { 0 } else { at + SUM.len() });
            let above = out.split_off(after_sum);
            out += &format!("<mfrac>{}{}</mfrac>", row(&above), row(&below));
            self.skip();
            // A product continues with factors after a fraction.
            if matches!(
                self.tokens.peek(),
                Some(Token::Atom(_) | Token::Function(_) | Token::Root | Token::Open(_))
            ) {
                let more = self.factors(true)?;
                if matches!(self.tokens.peek(), Some(Token::Over(_))) {
                    return None;
                }
                out += &more;
            }
        }
        Some(out)
    }

    /// Reads factors, up to a space unless `takes_all`.
    fn factors(&mut self, takes_all: bool) -> Option<String> {
        self.skip();
        let mut out = String::new();
        loop {
            if takes_all {
                self.skip();
            }
            let opens = takes_all && self.opens();
            match self.tokens.peek() {
                Some(Token::Atom(_) | Token::Function(_) | Token::Root | Token::Open(_)) => {
                    out += &self.factor()?;
                }
                Some(Token::Bar(_)) if out.is_empty() || opens => out += &self.factor()?,
                _ => return (!out.is_empty()).then_some(out),
            }
        }
    }

    /// Returns true if a vertical bar opens a norm, because no end follows. Inside bars the first bar closes.
    fn opens(&self) -> bool {
        let mut ahead = self.tokens.clone();
        ahead.next();
        matches!(ahead.next(), Some(Token::Atom(_) | Token::Function(_)))
    }

    fn factor(&mut self) -> Option<String> {
        let base = match self.tokens.next()? {
            Token::Atom(atom) => atom,
            Token::Function(name) => {
                let name = self.indexed(format!("<mi>{name}</mi>"))?;
                self.skip();
                let of = self.factor()?;
                return Some(format!("<mrow>{name}<mo>&#x2061;</mo><mspace width=\"0.17em\"/>{of}</mrow>"));
            }
            Token::Root => {
                let of = match self.tokens.peek() {
                    Some(Token::Open('(')) => {
                        self.tokens.next();
                        self.until_closed()?
                    }
                    _ => self.factor()?,
                };
                format!("<msqrt>{of}</msqrt>")
            }
            Token::Open(open) => {
                let content = self.list()?;
                let Some(Token::Close(close)) = self.tokens.next() else { return None };
                format!("<mrow><mo>{open}</mo>{content}<mo>{close}</mo></mrow>")
            }
            Token::Bar(bar) => {
                let content = self.inside()?;
                self.tokens.next_if_eq(&Token::Bar(bar))?;
                format!("<mrow><mo>{bar}</mo>{content}<mo>{bar}</mo></mrow>")
            }
            _ => return None,
        };
        self.indexed(base)
    }

    /// Reads the content between bars.
    fn inside(&mut self) -> Option<String> {
        let mut depth = 0;
        let mut inner = Vec::new();
        while let Some(token) = self.tokens.peek() {
            match token {
                Token::Bar(_) if depth == 0 => break,
                Token::Open(_) => depth += 1,
                Token::Close(_) => depth -= 1,
                _ => {}
            }
            inner.extend(self.tokens.next());
        }
        let mut inner = Formula { tokens: inner.into_iter().peekable() };
        let content = inner.list()?;
        inner.tokens.next().is_none().then_some(content)
    }

    fn until_closed(&mut self) -> Option<String> {
        let content = self.list()?;
        self.tokens.next_if_eq(&Token::Close(')'))?;
        Some(content)
    }

    /// Adds the following indices to `base`.
    fn indexed(&mut self, base: String) -> Option<String> {
        let mut below = None;
        let mut above = None;
        loop {
            match self.tokens.peek() {
                Some(Token::Below(_)) if below.is_none() => below = self.tokens.next(),
                Some(Token::Above(_)) if above.is_none() => above = self.tokens.next(),
                _ => break,
            }
        }
        Some(match (below, above) {
            (None, None) => base,
            (Some(Token::Below(below)), None) => format!("<msub>{base}{below}</msub>"),
            (None, Some(Token::Above(above))) => format!("<msup>{base}{above}</msup>"),
            (Some(Token::Below(below)), Some(Token::Above(above))) => {
                format!("<msubsup>{base}{below}{above}</msubsup>")
            }
            _ => return None,
        })
    }
}

/// Returns one part of a fraction, without enclosing brackets.
fn row(content: &str) -> String {
    let bare =
        content.strip_prefix("<mrow><mo>(</mo>").and_then(|rest| rest.strip_suffix("<mo>)</mo></mrow>"));
    // The outer brackets match if no other bracket closes before the end.
    let bare = bare.filter(|inner| !inner.contains("<mo>)</mo>"));
    format!("<mrow>{}</mrow>", bare.unwrap_or(content))
}

#[cfg(test)]
mod tests {
    use super::mathml;

    /// Returns the text of a formula without tags, with fractions as `{a|b}`.
    fn read(code: &str) -> String {
        let html = mathml(code, false).unwrap_or_else(|| panic!("{code} is a formula"));
        let html = html.replace("<mfrac>", "{").replace("</mfrac>", "}").replace("</mrow><mrow>", "|");
        html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text)).collect()
    }

    #[test]
    fn fractions_contain_their_numerator_and_denominator() {
        assert_eq!(read("a = F/m"), "a={F|m}");
        assert_eq!(read("m g/c"), "{mg|c}");
        assert_eq!(read("2v / 7μg"), "{2v|7μg}");
        assert_eq!(read("12 v² / 49 μ g"), "{12v2|49μg}");
        assert_eq!(read("w² t/(L + w t)"), "{w2t|L+wt}");
        assert_eq!(read("μ v/(1 + μ d²/I)"), "{μv|1+{μd2|I}}");
        assert_eq!(read("(ρ/ρ_w − 1) g/c"), "{({ρ|ρw}−1)g|c}");
        assert_eq!(read("L Σ 1/2k"), "L∑{1|2k}");
        assert_eq!(read("Σ w v / Σ w s"), "{∑wv|∑ws}");
        assert_eq!(read("(I₃ − I₁) / I₁ · ω₃"), "{I3−I1|I1}·ω3");
    }

    #[test]
    fn roots_indices_and_functions_are_converted() {
        let html = mathml("T = 2π √(a³/μ)", false).expect("a formula");
        assert_eq!(
            html,
            "<math><mi>T</mi><mo>=</mo><mn>2</mn><mi>π</mi><msqrt><mfrac><mrow><msup><mi>a</mi><mrow><mn>3</mn></mrow></msup></mrow>\
             <mrow><mi>μ</mi></mrow></mfrac></msqrt></math>"
        );
        assert!(
            mathml("F = −c v", false).is_some_and(|html| html.contains("<mo>=</mo><mo>−</mo><mi>c</mi>"))
        );
        assert!(
            mathml("α = I⁻¹ τ", false)
                .is_some_and(|html| html.contains("<mo>−</mo><mn>1</mn></mrow></msup>"))
        );
        assert!(mathml("g sin θ", false).is_some_and(|html| html.contains("<mi>sin</mi>")));
        assert!(mathml("½ ρ C_d A |w|²", false).is_some_and(|html| html.contains("<msup><mrow><mo>|</mo>")));
    }

    #[test]
    fn code_stays_code() {
        for code in [
            "World::add_field",
            "sinew run wind",
            "--set gap=0",
            "a * b",
            "bounds_over_box_max",
            "axis",
            "init()",
            "a - b",
        ] {
            assert_eq!(mathml(code, false), None, "{code}");
        }
    }
}
