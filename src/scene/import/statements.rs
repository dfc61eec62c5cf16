//! The statements of an OBJ or MTL file, each with the number of its line.
//!
//! Both formats are lines of `keyword arguments`. This pass takes away what their readers stumble over: any of the three line
//! ends, byte order marks, indentation and tabs, `# comments` behind values, and `\` at the end of a line that goes on below.
//! It never fails, and it costs one pass over the text.

use std::borrow::Cow;

/// One statement, never empty.
#[derive(Debug, PartialEq)]
pub(super) struct Statement<'a> {
    /// The 1-based line on which it starts.
    pub line: u32,
    /// Its first word.
    pub keyword: Cow<'a, str>,
    /// What follows the first word, trimmed, without comment; words may be separated by any white space.
    pub arguments: Cow<'a, str>,
}

/// The statements of `text`, in order.
pub(super) fn statements(text: &str) -> impl Iterator<Item = Statement<'_>> {
    let mut lines = Lines { rest: text, line: 0 };
    std::iter::from_fn(move || {
        loop {
            let (line, first) = lines.next()?;
            let first = without_comment(first).trim();
            let mut content = Cow::Borrowed(first);

            // A backslash at the end of the line joins it with the next one; comments have been taken off before.
            if let Some(start) = first.strip_suffix('\\') {
                let mut joined = start.to_owned();
                for (_, next) in lines.by_ref() {
                    let next = without_comment(next).trim();
                    let part = next.strip_suffix('\\');
                    joined.push(' ');
                    joined.push_str(part.unwrap_or(next));
                    if part.is_none() {
                        break;
                    }
                }
                content = Cow::Owned(joined);
            }
            if !content.trim().is_empty() {
                return Some(split(line, content));
            }
        }
    })
}

/// Keyword and arguments of a line that is not blank.
fn split(line: u32, content: Cow<'_, str>) -> Statement<'_> {
    let halves = |text: &str| {
        let start = text.len() - text.trim_start().len();
        let end = text[start..].find(char::is_whitespace).map_or(text.len(), |length| start + length);
        (start, end)
    };
    match content {
        Cow::Borrowed(text) => {
            let (start, end) = halves(text);
            Statement { line, keyword: Cow::Borrowed(&text[start..end]), arguments: Cow::Borrowed(text[end..].trim()) }
        }
        Cow::Owned(text) => {
            let (start, end) = halves(&text);
            Statement {
                line,
                keyword: Cow::Owned(text[start..end].to_owned()),
                arguments: Cow::Owned(text[end..].trim().to_owned()),
            }
        }
    }
}

/// A comment starts at a `#` that begins a word: `1.#QNAN` and `wall#3` hold none.
fn without_comment(line: &str) -> &str {
    let mut from = 0;
    while let Some(found) = line[from..].find('#') {
        let at = from + found;
        if line[..at].chars().next_back().is_none_or(char::is_whitespace) {
            return &line[..at];
        }
        from = at + 1;
    }
    line
}

/// Physical lines with their numbers; `\n`, `\r\n` and a lone `\r` end a line.
struct Lines<'a> {
    rest: &'a str,
    line: u32,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (u32, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        self.line = self.line.saturating_add(1);
        let bytes = self.rest.as_bytes();
        let end = bytes.iter().position(|&byte| byte == b'\n' || byte == b'\r').unwrap_or(bytes.len());
        let after = match bytes.get(end) {
            Some(b'\r') if bytes.get(end + 1) == Some(&b'\n') => end + 2,
            Some(_) => end + 1,
            None => end,
        };
        let content = &self.rest[..end];
        self.rest = &self.rest[after..];
        Some((self.line, content))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<(u32, String, String)> {
        statements(text).map(|s| (s.line, s.keyword.into_owned(), s.arguments.into_owned())).collect()
    }

    fn of(line: u32, keyword: &str, arguments: &str) -> (u32, String, String) {
        (line, keyword.to_owned(), arguments.to_owned())
    }

    #[test]
    fn every_line_end_counts_once() {
        let expected = vec![of(1, "a", "1"), of(2, "b", "2"), of(4, "c", "3")];
        for text in ["a 1\nb 2\n\nc 3", "a 1\r\nb 2\r\n\r\nc 3\r\n", "a 1\rb 2\r\rc 3"] {
            assert_eq!(read(text), expected, "{text:?}");
        }
    }

    #[test]
    fn comments_begin_words() {
        assert_eq!(
            read("  v\t1 2 1.#QNAN # why\n#v 1\n# c\nusemtl wall#3 #x\n"),
            vec![of(1, "v", "1 2 1.#QNAN"), of(4, "usemtl", "wall#3")]
        );
    }

    #[test]
    fn continued_lines_keep_their_first_number_and_comments_do_not_continue() {
        assert_eq!(
            read("f 1 2 \\\n  3 \\ # three\n 4\n# path C:\\\nv 1 2 3\nf 1 \\"),
            vec![of(1, "f", "1 2  3  4"), of(5, "v", "1 2 3"), of(6, "f", "1")]
        );
        assert_eq!(read("\\\n\\\nf 1"), vec![of(1, "f", "1")]);
        assert_eq!(read("\\"), vec![]);
    }
}
