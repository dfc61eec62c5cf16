//! Textures of MTL files: `map_Kd` and `map_Ke`, with the options that move them.

use super::textures::Wrap;

/// A texture as a material names it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// The line of the statement, from 1.
    pub line: u32,
    /// The file of the image, which may lie in a folder.
    pub name: String,
    pub wrap: Wrap,
    /// What texture coordinates are multiplied by, then moved by.
    scale: [f64; 2],
    offset: [f64; 2],
    /// Whether `-mm` would change its values.
    pub is_modified: bool,
}

impl Map {
    /// Reads the words behind the keyword; `None` if no name is among them.
    pub fn parse(words: &str, line: u32) -> Option<Self> {
        let mut map = Self { line, name: String::new(), wrap: Wrap::Repeat, scale: [1.0; 2], offset: [0.0; 2], is_modified: false };
        let mut rest = words.trim_start();
        loop {
            let (word, after) = first_word(rest);
            rest = match word {
                "-s" => pair(&mut map.scale, after),
                "-o" => pair(&mut map.offset, after),
                // Turbulence moves colours about, and hardly changes a mean.
                "-t" => pair(&mut [0.0; 2], after),
                "-mm" => {
                    map.is_modified = true;
                    first_word(first_word(after).1).1
                }
                "-clamp" => {
                    let (value, after) = first_word(after);
                    map.wrap = if value == "on" { Wrap::Clamp } else { Wrap::Repeat };
                    after
                }
                "-blendu" | "-blendv" | "-cc" | "-bm" | "-boost" | "-imfchan" | "-texres" | "-type" => first_word(after).1,
                _ => break,
            };
        }
        rest.trim_end().clone_into(&mut map.name);
        (!map.name.is_empty()).then_some(map)
    }

    /// Where texture coordinates lie in the image: from the left, and from the top; `v` of OBJ points up.
    pub fn place(&self, coordinates: [f64; 2]) -> [f64; 2] {
        let [u, v] = [0, 1].map(|k| self.scale[k] * coordinates[k] + self.offset[k]);
        [u, 1.0 - v]
    }
}

/// The first word, and what follows it.
fn first_word(text: &str) -> (&str, &str) {
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    (&text[..end], text[end..].trim_start())
}

/// Reads up to three numbers, of which two count, and gives what follows them.
fn pair<'a>(values: &mut [f64; 2], mut text: &'a str) -> &'a str {
    for k in 0..3 {
        let (word, after) = first_word(text);
        let Some(number) = word.parse::<f64>().ok().filter(|number| number.is_finite()) else { break };
        if let Some(value) = values.get_mut(k) {
            *value = number;
        }
        text = after;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_stand_before_a_name_that_may_hold_spaces() {
        let plain = Map::parse(" brick wall.png ", 7).unwrap();
        assert_eq!((&*plain.name, plain.line, plain.place([0.25, 0.25])), ("brick wall.png", 7, [0.25, 0.75]));
        let moved = Map::parse("-clamp on -s 2 4 1 -o 0.5 -bm 1 a/b.jpg", 1).unwrap();
        assert_eq!((&*moved.name, moved.wrap, moved.place([0.25, 0.125])), ("a/b.jpg", Wrap::Clamp, [1.0, 0.5]));
        assert_eq!(Map::parse("-o 1 2 3.png", 1).unwrap().name, "3.png");
        assert!(Map::parse("-mm 0 2 a.png", 1).unwrap().is_modified);
        assert_eq!(Map::parse("-s 1 1", 1), None);
    }
}
