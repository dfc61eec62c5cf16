//! Photometric files of luminaires: IESNA LM-63 of 1986, 1991, 1995, 2002 and 2019, with photometry of type C.
//!
//! Candelas stand for rows of vertical angles, from 0 straight down to 180, at horizontal angles, counter-clockwise from above. They are multiplied by
//! the multiplier, the ballast factor and, before 2019, the ballast-lamp photometric factor. Lumens of lamps are not needed for that: candelas are those of the
//! luminaire with its lamps, or, where they are -1, were measured as they are. Horizontal angles that end at 0, 90 or 180 stand for luminaires that are
//! alike all around, in each quarter, or in both halves. The luminous opening is a point here.
//!
//! Read by hand: crates for this (lidrs 0.2, eulumdat 0.7) name no lines in their errors.

use std::path::Path;

use super::super::ImportError;
use super::super::text::decode;
use super::numbers::Numbers;
use crate::scene::IntensityTable;

/// More intensities than this are a slip.
const MOST_VALUES: usize = 1 << 22;

/// A luminaire as its file tells.
#[derive(Clone, Debug)]
pub(super) struct Photometry {
    /// In candelas.
    pub table: IntensityTable,
    tilt: Option<Tilt>,
    notes: Vec<String>,
}

/// How much light lamps give that are tilted (`TILT=INCLUDE`).
#[derive(Clone, Debug)]
struct Tilt {
    /// Whether the lamp stands upright in a luminaire that looks down: then a tilt is the same to all sides.
    is_upright: bool,
    /// In degrees, rising.
    angles: Vec<f64>,
    factors: Vec<f64>,
}

impl Photometry {
    /// Reads the bytes of a file.
    pub fn read(path: &Path, bytes: &[u8]) -> Result<Self, ImportError> {
        let (text, _) = decode(bytes);
        let mut numbers = Numbers::after_tilt(path, &text)?;
        let tilt = if numbers.has_tilt { Some(tilt(&mut numbers)?) } else { None };

        let Head { rows, columns, factor, opening } = head(&mut numbers)?;
        let (vertical, horizontal) = angles(&mut numbers, rows, columns)?;
        let mut values = Vec::with_capacity(rows * columns);
        for _ in 0..rows * columns {
            values.push(factor * numbers.between("an intensity", 0.0, 1e30)?);
        }
        numbers.end()?;

        let mut notes = Vec::new();
        if opening.iter().any(|&size| size > 0.0) {
            let [width, length, height] = opening.map(|size| format!("{size:.3}"));
            notes.push(format!("its luminous opening, {width} x {length} x {height} m, is taken as a point"));
        }
        let (azimuths, values) = all_around(rows, &horizontal, &values, &mut notes);
        let polar = vertical.iter().map(|angle| angle.to_radians()).collect();
        let table = IntensityTable::new(polar, azimuths, values).map_err(|error| numbers.wrong(error))?;
        Ok(Self { table, tilt, notes })
    }

    /// What is worth knowing of it.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What its candelas are multiplied by where it is turned by so many radians from looking straight down; and what that leaves out.
    pub fn at_tilt(&self, angle: f64) -> (f64, Option<&'static str>) {
        let Some(tilt) = &self.tilt else { return (1.0, None) };
        let is_tilted = angle > 1e-6;
        if is_tilted && !tilt.is_upright {
            let note = "how much light its lamp gives tilted (TILT=INCLUDE) is taken for a luminaire that looks straight down: the lamp lies";
            return (tilt.factor(0.0), Some(note));
        }
        (tilt.factor(angle.to_degrees()), None)
    }
}

/// What stands before the angles.
struct Head {
    /// How many vertical angles there are, and horizontal ones.
    rows: usize,
    columns: usize,
    /// What candelas are multiplied by.
    factor: f64,
    /// In metres.
    opening: [f64; 3],
}

/// Reads on from the number of lamps.
fn head(numbers: &mut Numbers<'_>) -> Result<Head, ImportError> {
    numbers.between("the number of lamps", 1.0, 1e6)?;
    let lumens = numbers.next("the lumens of a lamp")?;
    if !(lumens >= 0.0 || lumens == -1.0) {
        return Err(
            numbers.wrong(format_args!("the lumens of a lamp are {lumens}, they must be 0 or more, or -1 for absolute photometry"))
        );
    }
    let multiplier = numbers.between("the multiplier", 0.0, 1e12)?;
    let rows = numbers.count("the number of vertical angles", 2)?;
    let columns = numbers.count("the number of horizontal angles", 1)?;
    if rows.saturating_mul(columns) > MOST_VALUES {
        return Err(numbers.wrong(format_args!("{rows} x {columns} intensities are too many: there may be {MOST_VALUES}")));
    }
    match numbers.count("the type of photometry", 1)? {
        1 => {}
        kind => {
            let kind = ["B", "A"].get(kind - 2).copied().unwrap_or("no type");
            return Err(numbers.wrong(format_args!("its photometry is of type {kind} and must be of type C (1): convert the file")));
        }
    }
    let unit = match numbers.count("the type of units", 1)? {
        1 => 0.3048,
        2 => 1.0,
        other => return Err(numbers.wrong(format_args!("the type of units is {other}, it must be 1 (feet) or 2 (metres)"))),
    };
    let mut opening = [0.0; 3];
    for size in &mut opening {
        // Negative ones are round (2002).
        *size = unit * numbers.next("a luminous dimension")?.abs();
    }
    let ballast = numbers.between("the ballast factor", 0.0, 1e6)?;
    let of_lamp = numbers.next("the ballast-lamp photometric factor")?;
    numbers.next("the watts")?;
    let of_lamp = if numbers.is_of_2019 { 1.0 } else { of_lamp };
    if of_lamp <= 0.0 {
        return Err(numbers.wrong(format_args!("the ballast-lamp photometric factor is {of_lamp}, it must be above 0")));
    }
    Ok(Head { rows, columns, factor: multiplier * ballast * of_lamp, opening })
}

/// Vertical and horizontal angles in degrees.
fn angles(numbers: &mut Numbers<'_>, rows: usize, columns: usize) -> Result<(Vec<f64>, Vec<f64>), ImportError> {
    let vertical = numbers.angles("a vertical angle", rows)?;
    let ends = [vertical[0], vertical[rows - 1]];
    if ![[0.0, 90.0], [0.0, 180.0], [90.0, 180.0]].contains(&ends) {
        let reason = format_args!("its vertical angles go from {} to {}, they must go from 0 or 90 to 90 or 180", ends[0], ends[1]);
        return Err(numbers.wrong(reason));
    }
    let horizontal = numbers.angles("a horizontal angle", columns)?;
    let last = horizontal[columns - 1];
    if horizontal[0] != 0.0 || ![0.0, 90.0, 180.0, 360.0].contains(&last) {
        let reason =
            format_args!("its horizontal angles go from {} to {last}, they must go from 0 to 0, 90, 180 or 360", horizontal[0]);
        return Err(numbers.wrong(reason));
    }
    Ok((vertical, horizontal))
}

impl Tilt {
    /// On lines between those of the file, and as at its ends beyond.
    fn factor(&self, degrees: f64) -> f64 {
        let above = self.angles.partition_point(|&angle| angle <= degrees);
        match above {
            0 => self.factors[0],
            _ if above == self.angles.len() => self.factors[above - 1],
            _ => {
                let [low, high] = [above - 1, above];
                let along = (degrees - self.angles[low]) / (self.angles[high] - self.angles[low]);
                self.factors[low] + along * (self.factors[high] - self.factors[low])
            }
        }
    }
}

fn tilt(numbers: &mut Numbers<'_>) -> Result<Tilt, ImportError> {
    let geometry = numbers.count("the lamp-to-luminaire geometry", 1)?;
    if geometry > 3 {
        return Err(numbers.wrong(format_args!("the lamp-to-luminaire geometry is {geometry}, it must be 1, 2 or 3")));
    }
    let count = numbers.count("the number of tilts", 1)?;
    let angles = numbers.angles("an angle of tilt", count.min(MOST_VALUES))?;
    let factors = angles.iter().map(|_| numbers.between("a factor of a tilt", 0.0, 1e6)).collect::<Result<_, _>>()?;
    Ok(Tilt { is_upright: geometry == 1, angles, factors })
}

/// Azimuths from 0 to 2 pi with their intensities, of luminaires that are alike in parts.
fn all_around(rows: usize, horizontal: &[f64], values: &[f64], notes: &mut Vec<String>) -> (Vec<f64>, Vec<f64>) {
    let mut columns: Vec<(f64, &[f64])> = horizontal.iter().copied().zip(values.chunks_exact(rows)).collect();
    let mut end = columns[columns.len() - 1].0;
    if end == 0.0 {
        columns.push((360.0, columns[0].1));
        end = 360.0;
    }
    while end < 360.0 {
        let mirrored: Vec<(f64, &[f64])> =
            columns.iter().rev().skip(1).map(|&(angle, column)| (2.0 * end - angle, column)).collect();
        columns.extend(mirrored);
        end *= 2.0;
    }
    let (first, last) = (columns[0].1, columns.len() - 1);
    if columns[last].1 != first {
        notes.push("its intensities at the horizontal angle 360 are not those at 0, which are taken".to_owned());
        columns[last].1 = first;
    }
    let azimuths = columns.iter().map(|(angle, _)| angle.to_radians()).collect();
    (azimuths, columns.iter().flat_map(|(_, column)| column.iter().copied()).collect())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    fn read(text: &str) -> Result<Photometry, String> {
        Photometry::read(Path::new("a.ies"), text.as_bytes()).map_err(|error| error.to_string())
    }

    /// A file of the standard's form, with these lines from the counts on.
    fn file(counts: &str, angles: &str, values: &str) -> String {
        format!("IESNA:LM-63-2002\n[TEST] none\n[MANUFAC] = nobody\nTILT=NONE\n1 1000 2 {counts}\n0.5 1 30\n{angles}\n{values}\n")
    }

    #[test]
    fn candelas_and_lumens_are_those_of_the_file() {
        // 100 cd times 2 times 0.5 in all directions below the horizon: 200 pi lm; in all directions 400 pi.
        let below = read(&file("2 1 1 2 0 0 0", "0 90\n0", "100 100")).unwrap();
        assert_eq!(below.table.at(0.5, 3.0), 100.0);
        assert!((below.table.flux() - 200.0 * PI).abs() < 1e-10);
        let around = read(&file("3 1 1 2 0 0 0", "0 90 180\n0", "100 100 100")).unwrap();
        assert!((around.table.flux() - 400.0 * PI).abs() < 1e-10 && around.notes().is_empty());
        let above = read(&file("2 1 1 2 0 0 0", "90 180\n0", "100 100")).unwrap();
        assert_eq!((above.table.at(1.0, 0.0), above.table.at(2.0, 0.0)), (0.0, 100.0));
        // A cosine, as of a diffuse opening with 100 cd along its axis: 100 pi lm, but for what lines between its degrees are off by.
        let cosines: Vec<String> = (0..=90).map(|degree| (100.0 * f64::from(degree).to_radians().cos()).to_string()).collect();
        let angles: Vec<String> = (0..=90).map(|degree| degree.to_string()).collect();
        let text = file("91 1 1 2 0 0 0", &format!("{}\n0", angles.join(" ")), &cosines.join("\n"));
        let lines_off = (PI / 180.0).powi(2) / 12.0;
        assert!((read(&text).unwrap().table.flux() / (100.0 * PI) - 1.0).abs() < 1.1 * lines_off);
    }

    /// By the symmetry that the last horizontal angle tells of.
    #[test]
    fn parts_stand_for_the_whole() {
        let at = |text: &str, degrees: f64| read(text).unwrap().table.at(1.0, degrees.to_radians());
        let quarter = file("2 2 1 2 0 0 0", "0 90\n0 90", "3 3\n5 5");
        for (degrees, expected) in [(0.0, 3.0), (45.0, 4.0), (90.0, 5.0), (135.0, 4.0), (180.0, 3.0), (270.0, 5.0), (315.0, 4.0)] {
            assert!((at(&quarter, degrees) - expected).abs() < 1e-12, "{degrees}");
        }
        let half = file("2 3 1 2 0 0 0", "0 90\n0 90 180", "3 3\n5 5\n7 7");
        for (degrees, expected) in [(0.0, 3.0), (90.0, 5.0), (180.0, 7.0), (270.0, 5.0), (225.0, 6.0)] {
            assert!((at(&half, degrees) - expected).abs() < 1e-12, "{degrees}");
        }
        let whole = file("2 4 1 2 0 0 0", "0 90\n0 90 180 360", "3 3\n5 5\n7 7\n3 3");
        assert!((at(&whole, 270.0) - 5.0).abs() < 1e-12 && (at(&whole, 135.0) - 6.0).abs() < 1e-12);
        let uneven = read(&file("2 2 1 2 0 0 0", "0 90\n0 360", "3 3\n3 4")).unwrap();
        assert!(uneven.notes()[0].contains("360") && uneven.table.at(1.5, TAU) == 3.0);
    }

    #[test]
    fn versions_and_separators_are_read() {
        let body = "1,-1,1,2,1,1,1,2,\n1,0 1.5 1 1\r\n0 90\n0\n10 20\n\x1a";
        for head in
            ["a lamp\nof 1986\nTILT=NONE\n", "IESNA91\n[TEST] 1\nTILT= NONE\n", "IESNA:LM-63-1995\nTilt=none\n", "TILT=NONE\n"]
        {
            let found = read(&format!("{head}{body}")).unwrap();
            assert_eq!(found.table.at(0.0, 0.0), 15.0);
            assert_eq!(found.notes(), ["its luminous opening, 0.610 x 0.305 x 0.000 m, is taken as a point"]);
        }
        // The number in the place of the ballast-lamp factor is of another meaning there.
        let found = read("IES:LM-63-2019\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0 1 1.10001 5 0 90 0 10 20").unwrap();
        assert_eq!(found.table.peak(), 20.0);
    }

    #[test]
    fn tilted_lamps_give_what_the_file_says() {
        let text = |geometry: u32| {
            format!("IESNA91\nTILT=INCLUDE\n{geometry}\n3\n0 45 90\n1 0.9 0.8\n1 1000 1 2 1 1 2 0 0 0 1 1 30 0 90 0 10 10\n")
        };
        let upright = read(&text(1)).unwrap();
        assert_eq!(upright.at_tilt(0.0), (1.0, None));
        assert!((upright.at_tilt(PI / 8.0).0 - 0.95).abs() < 1e-12 && upright.at_tilt(3.0) == (0.8, None));
        let lying = read(&text(2)).unwrap();
        assert!(lying.at_tilt(0.0) == (1.0, None) && lying.at_tilt(0.5).0 == 1.0 && lying.at_tilt(0.5).1.is_some());
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let good = file("2 1 1 2 0 0 0", "0 90\n0", "100 100");
        assert!(read(&good).is_ok());
        for (from, to, words) in [
            ("TILT=NONE", "TILT=lamp.tlt", "a.ies:4: the tilt is in another file"),
            ("TILT=NONE", "none", "a.ies: it has no line TILT="),
            ("1000", "much", "a.ies:5: 'much' stands where the lumens of a lamp should be"),
            ("1000", "-2", "a.ies:5: the lumens of a lamp are -2"),
            ("1000", "nan", "a.ies:5: 'nan' stands where"),
            ("2 1 1 2 0", "2 1 2 2 0", "a.ies:5: its photometry is of type B"),
            ("2 1 1 2 0", "2 1 1 3 0", "a.ies:5: the type of units is 3"),
            ("2 1 1 2 0", "2.5 1 1 2 0", "a.ies:5: the number of vertical angles is 2.5, no whole number"),
            ("2 1 1 2 0", "100000 100000 1 2 0", "a.ies:5: 100000 x 100000 intensities are too many"),
            ("0 90", "0 80", "its vertical angles go from 0 to 80"),
            ("0 90", "90 0", "a.ies:7: a vertical angle is 0 behind 90: they must rise"),
            ("90\n0\n", "90\n10\n", "its horizontal angles go from 10 to 10"),
            ("100 100", "100 -1", "a.ies:9: an intensity is -1, it must be from 0"),
            ("100 100", "100", "a.ies:9: the file ends where an intensity should be"),
            ("100 100", "100 100 100", "a.ies:9: '100' follows the last intensity"),
            ("100 100", "0 0", "a.ies:9: it sends no light"),
        ] {
            let message = read(&good.replacen(from, to, 1)).unwrap_err();
            assert!(message.starts_with(words) || message.contains(words), "{to}: {message}");
        }
    }
}
