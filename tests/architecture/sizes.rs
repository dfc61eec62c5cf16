//! How long functions and files are, and how many parameters functions take.

use super::tokens::{Token, after_bracket, is, is_word, tokens};

/// Lines of a function from `fn` to the bracket that closes it.
pub const MOST_LINES: usize = 60;
/// Parameters of a function; `self` is one.
pub const MOST_PARAMETERS: usize = 6;
/// Lines of a file.
pub const MOST_LINES_OF_A_FILE: usize = 400;

/// What a function measures.
#[derive(PartialEq, Eq, Debug)]
pub struct Function {
    pub name: String,
    pub lines: usize,
    pub parameters: usize,
}

/// All functions of a source, those inside of others too. Functions without a body have the lines of their signature.
pub fn functions(text: &str) -> Vec<Function> {
    let code = tokens(text);
    // Types such as `fn(u8)` and what macros write have no name.
    let starts = (0..code.len()).filter(|&at| code[at].text == "fn" && code.get(at + 1).is_some_and(is_word));
    starts.filter_map(|start| function(&code, start)).collect()
}

fn function(code: &[Token], start: usize) -> Option<Function> {
    let open = after_generics(code, start + 2);
    if !is(code.get(open..)?, &["("]) {
        return None;
    }
    let close = after_bracket(code, open) - 1;
    let mut end = close;
    while end < code.len() && !["{", ";"].contains(&code[end].text) {
        end = if ["(", "["].contains(&code[end].text) { after_bracket(code, end) } else { end + 1 };
    }
    if is(code.get(end..)?, &["{"]) {
        end = after_bracket(code, end) - 1;
    }
    let lines = code.get(end)?.line - code[start].line + 1;
    Some(Function { name: code[start + 1].text.to_owned(), lines, parameters: parameters(&code[open + 1..close]) })
}

/// The place after `<...>`, if that is what stands here.
fn after_generics(code: &[Token], mut at: usize) -> usize {
    let mut depth = 0;
    while at < code.len() {
        match code[at].text {
            "<" => depth += 1,
            ">" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return if code[at].text == ">" { at + 1 } else { at };
        }
        at += 1;
    }
    at
}

/// Commas end parameters, apart from those within brackets; the last may have none.
fn parameters(code: &[Token]) -> usize {
    let (mut depth, mut found, mut is_open) = (0, 0, false);
    for token in code {
        match token.text {
            "(" | "[" | "{" | "<" => depth += 1,
            ")" | "]" | "}" | ">" => depth -= 1,
            "," if depth == 0 => {
                found += 1;
                is_open = false;
                continue;
            }
            _ => {}
        }
        is_open = true;
    }
    found + usize::from(is_open)
}

fn of(text: &str) -> Vec<(String, usize, usize)> {
    functions(text).into_iter().map(|function| (function.name, function.lines, function.parameters)).collect()
}

#[test]
fn a_long_function_is_seen_as_long_as_it_is() {
    let long = format!("struct A;\nfn short() {{}}\nfn long() -> [u8; 2] {{\n{}}}\n", "    {}\n".repeat(MOST_LINES - 1));
    assert_eq!(of(&long), [("short".to_owned(), 1, 0), ("long".to_owned(), MOST_LINES + 1, 0)]);
}

#[test]
fn brackets_in_strings_and_comments_end_no_function() {
    let text = "fn f() {\n// }\nlet a = \"}\"; /* } */ let b = '}';\nfn g() {\n}\n}";
    assert_eq!(of(text), [("f".to_owned(), 6, 0), ("g".to_owned(), 2, 0)]);
}

#[test]
fn seven_parameters_are_counted_with_self_and_without_commas_inside() {
    let text = "fn f<'a, T: Fn(u8, u8) -> u8>(&'a self, a: (u8, u8), b: [T; 2], c: BTreeMap<u8, u8>, d: fn(u8, u8) -> u8, e: u8, f: u8,) {}";
    assert_eq!(of(text), [("f".to_owned(), 1, 7)]);
    assert_eq!(
        of("trait A { fn none(); fn one(self) -> u8 where Self: Sized; }"),
        [("none".to_owned(), 1, 0), ("one".to_owned(), 1, 1)]
    );
}
