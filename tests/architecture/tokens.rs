//! Rust sources as tokens: what is left without comments and white space. Enough to find paths and functions.

/// A word, a literal or a sign, and the line it starts in, from 1.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Token<'a> {
    pub text: &'a str,
    pub line: usize,
}

/// Signs that are read as one: `::` is part of paths, the arrows would close brackets.
const PAIRS: [&str; 3] = ["::", "->", "=>"];

/// All tokens of a source. Literals keep their quotes, lifetimes their apostrophe.
pub fn tokens(text: &str) -> Vec<Token<'_>> {
    let (mut found, mut at, mut line) = (Vec::new(), 0, 1);
    while at < text.len() {
        let rest = &text[at..];
        let length = length(rest);
        let token = &rest[..length];
        if !(token.starts_with(char::is_whitespace) || token.starts_with("//") || token.starts_with("/*")) {
            found.push(Token { text: token, line });
        }
        line += token.matches('\n').count();
        at += length;
    }
    found
}

/// Bytes of what a text starts with: white space, a comment or a token.
fn length(text: &str) -> usize {
    let first = text.chars().next().unwrap();
    if first.is_whitespace() {
        text.find(|c: char| !c.is_whitespace()).unwrap_or(text.len())
    } else if text.starts_with("//") {
        text.find('\n').unwrap_or(text.len())
    } else if text.starts_with("/*") {
        block_comment(text)
    } else if let Some(length) = string(text) {
        length
    } else if first == '\'' {
        character_or_lifetime(text)
    } else if is_of_word(first) {
        text.find(|c| !is_of_word(c)).unwrap_or(text.len())
    } else if PAIRS.iter().any(|pair| text.starts_with(pair)) {
        2
    } else {
        first.len_utf8()
    }
}

fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Block comments nest.
fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    loop {
        let (Some(next), closes) = (text[at..].find(['/', '*']), text[at..].find("*/")) else { return text.len() };
        at += next;
        if closes == Some(next) {
            (depth, at) = (depth - 1, at + 2);
            if depth == 0 {
                return at;
            }
        } else if text[at..].starts_with("/*") {
            (depth, at) = (depth + 1, at + 2);
        } else {
            at += 1;
        }
    }
}

/// Strings of every kind: `"a"`, `b"a"`, `c"a"`, `r"a"`, `br#"a"#`.
fn string(text: &str) -> Option<usize> {
    let prefix = text.find(|c: char| !"bcr".contains(c))?;
    let (prefix, rest) = text.split_at(prefix);
    let hashes = rest.len() - rest.trim_start_matches('#').len();
    let body = rest[hashes..].strip_prefix('"')?;
    let before = prefix.len() + hashes + 1;
    if prefix.contains('r') {
        let end = format!("\"{}", "#".repeat(hashes));
        return Some(before + body.find(&end).map_or(body.len(), |at| at + end.len()));
    }
    (hashes == 0).then(|| before + quoted(body, '"'))
}

/// Bytes up to the quote that ends a literal, and the quote.
fn quoted(body: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, c) in body.char_indices() {
        if c == quote && !escaped {
            return at + c.len_utf8();
        }
        escaped = c == '\\' && !escaped;
    }
    body.len()
}

/// `'a'` and `'\n'`, or `'a` without an end.
fn character_or_lifetime(text: &str) -> usize {
    let mut after = text[1..].chars();
    let (first, second) = (after.next(), after.next());
    if first == Some('\\') || second == Some('\'') {
        return 1 + quoted(&text[1..], '\'');
    }
    1 + text[1..].find(|c| !is_of_word(c)).unwrap_or(text.len() - 1)
}

/// The place after the bracket that closes the one at `open`; any of `()`, `[]`, `{}`.
pub fn after_bracket(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match token.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + 1;
        }
    }
    tokens.len()
}

/// The place after an item: its `;`, or the bracket that closes its body.
fn after_item(tokens: &[Token], mut at: usize) -> usize {
    while at < tokens.len() {
        match tokens[at].text {
            ";" => return at + 1,
            "{" => return after_bracket(tokens, at),
            "(" | "[" => at = after_bracket(tokens, at),
            _ => at += 1,
        }
    }
    at
}

/// Without the items under `#[cfg(test)]`, which may use what they like.
pub fn without_tests<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let (mut kept, mut at) = (Vec::new(), 0);
    while at < tokens.len() {
        if is(&tokens[at..], &["#", "[", "cfg", "(", "test", ")", "]"]) {
            at = after_item(tokens, at + 7);
        } else {
            kept.push(tokens[at]);
            at += 1;
        }
    }
    kept
}

/// Whether the tokens start with these.
pub fn is(tokens: &[Token], texts: &[&str]) -> bool {
    tokens.len() >= texts.len() && tokens.iter().zip(texts).all(|(token, text)| token.text == *text)
}

pub fn is_word(token: &Token) -> bool {
    token.text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

fn texts(source: &str) -> Vec<&str> {
    tokens(source).iter().map(|token| token.text).collect()
}

#[test]
fn comments_are_left_out_and_literals_are_one_token() {
    let source = "a/* b /* c */ d */::b // c\n->'x''\\'' 'a \"{\\\"}\" br#\"}\"\"#";
    assert_eq!(texts(source), ["a", "::", "b", "->", "'x'", "'\\''", "'a", "\"{\\\"}\"", "br#\"}\"\"#"]);
    assert_eq!(texts("b r#\"a\"# c'"), ["b", "r#\"a\"#", "c", "'"]);
}

#[test]
fn lines_are_counted_through_comments_and_strings() {
    let lines: Vec<usize> = tokens("a\n/*\n*/ b \"\n\" c").iter().map(|token| token.line).collect();
    assert_eq!(lines, [1, 3, 3, 4]);
}

#[test]
fn items_for_tests_are_left_out() {
    let source = "a #[cfg(test)] mod tests; b #[cfg(test)] #[x(y)] fn f(x: [u8; 2]) { {} } c #[cfg(unix)] d;";
    let kept: Vec<&str> = without_tests(&tokens(source)).iter().map(|token| token.text).collect();
    assert_eq!(kept, ["a", "b", "c", "#", "[", "cfg", "(", "unix", ")", "]", "d", ";"]);
}
