//! Texts with `{names}` in them.

use std::collections::BTreeSet;

/// Puts `value_of(name)` in the place of every `{name}` of `text`.
///
/// # Errors
/// Says which bracket is not closed, or which name is unknown.
pub fn fill(text: &str, value_of: impl Fn(&str) -> Option<String>) -> Result<String, String> {
    let (mut filled, mut rest) = (String::new(), text);
    while let Some((before, behind)) = rest.split_once('{') {
        let (name, after) = behind.split_once('}').ok_or_else(|| format!("'{text}': '{{' is not closed by '}}'"))?;
        filled += before;
        filled += &value_of(name).ok_or_else(|| format!("'{{{name}}}' is the name of nothing"))?;
        rest = after;
    }
    Ok(filled + rest)
}

/// The names in `text`.
pub fn names(text: &str) -> BTreeSet<&str> {
    text.split('{').skip(1).filter_map(|part| Some(part.split_once('}')?.0)).collect()
}

/// A value as a part of a file's name: what is special to some system or shell becomes `_`.
pub fn file_part(value: &str) -> String {
    let keep = |letter: char| if letter.is_alphanumeric() || "+-._".contains(letter) { letter } else { '_' };
    let part: String = value.chars().map(keep).collect();
    // A name of points alone leads elsewhere.
    if part.bytes().all(|byte| byte == b'.') { part.replace('.', "_") } else { part }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_values() {
        let value_of = |name: &str| (name == "power").then(|| "0.5".to_owned());
        assert_eq!(fill("a-{power}/{power}.png", value_of), Ok("a-0.5/0.5.png".to_owned()));
        assert_eq!(fill("plain", value_of), Ok("plain".to_owned()));
        assert_eq!(fill("{colour}", value_of), Err("'{colour}' is the name of nothing".to_owned()));
        assert_eq!(fill("a{power", value_of), Err("'a{power': '{' is not closed by '}'".to_owned()));
        assert_eq!(names("a-{power}/{seed}{power}"), BTreeSet::from(["power", "seed"]));
    }

    #[test]
    fn values_stay_inside_of_the_folder() {
        assert_eq!(file_part("0.8 0.5 0.2"), "0.8_0.5_0.2");
        assert_eq!(file_part("../etc/passwd"), ".._etc_passwd");
        assert_eq!(file_part(".."), "__");
    }
}
