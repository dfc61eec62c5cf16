//! Changes of materials, as files of jobs and the command line tell them.

use std::collections::BTreeSet;

use patchlight::scene::{Material, Scene};

use super::exit::Failure;
use super::reader::Said;

/// What of a material is changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Property {
    /// Its reflectance.
    Reflectance,
    /// Its exitance in W/m^2.
    Exitance,
    /// What its exitance is multiplied by, after that was set.
    ExitanceFactor,
}

impl Property {
    /// All names.
    pub const NAMES: [&'static str; 3] = ["reflectance", "exitance", "exitance_factor"];
    const ALL: [Self; 3] = [Self::Reflectance, Self::Exitance, Self::ExitanceFactor];

    fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().position(|&known| known == name).map(|index| Self::ALL[index])
    }
}

/// A change of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The material.
    pub material: String,
    /// What of it.
    pub property: Property,
    /// One number for all channels, or one for each.
    pub numbers: Vec<f64>,
    place: String,
}

impl Change {
    /// Of this material; the numbers are separated by blanks.
    pub fn new(material: &str, said: &Said) -> Result<Self, Failure> {
        let property = Property::named(&said.key).ok_or_else(|| said.wrong("there is no such property"))?;
        let number = |text: &str| text.parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
        let numbers: Option<Vec<f64>> = said.text.split_whitespace().map(number).collect();
        match numbers.filter(|numbers| !numbers.is_empty()) {
            Some(numbers) => Ok(Self { material: material.to_owned(), property, numbers, place: said.place.clone() }),
            None => Err(said.wrong(format_args!("'{}' must be one number or several, none negative", said.text))),
        }
    }

    /// As it is typed on the command line: MATERIAL=NUMBER, or MATERIAL=NUMBER,NUMBER,NUMBER with one for each channel.
    pub fn typed(flag: &str, property: Property, typed: &str) -> Result<Self, Failure> {
        let place = format!("--{flag} {typed}");
        let (material, numbers) = typed.rsplit_once('=').ok_or_else(|| {
            Failure::usage(format_args!("{place}: write --{flag} MATERIAL=X, or a number for each channel, as in wall=0.5,0.4,0.3"))
        })?;
        let key = Self::name_of(property).to_owned();
        let said = Said { key, text: numbers.replace(',', " "), place };
        Self::new(material.trim(), &said).map_err(|failure| Failure::usage(failure.message))
    }

    fn name_of(property: Property) -> &'static str {
        match property {
            Property::Reflectance => Property::NAMES[0],
            Property::Exitance => Property::NAMES[1],
            Property::ExitanceFactor => Property::NAMES[2],
        }
    }

    /// What tells changes apart, to the bit.
    pub fn identity(&self) -> String {
        let Self { material, property, numbers, .. } = self;
        let bits: Vec<String> = numbers.iter().map(|number| format!("{:016x}", number.to_bits())).collect();
        format!("{material:?} {property:?} {}", bits.join(" "))
    }

    fn apply(&self, channels: usize, materials: &mut [Material]) -> Result<(), Failure> {
        // The number of each channel.
        let numbers = match self.numbers[..] {
            [one] => vec![one; channels],
            ref each if each.len() == channels => each.to_vec(),
            ref others => {
                let (place, count) = (&self.place, others.len());
                return Err(Failure::bad_input(format_args!("{place}: there are {count} numbers, and {channels} channels")));
            }
        };

        // All materials of this name: a library may have several that differ.
        let names: BTreeSet<String> = materials.iter().map(|material| material.name.clone()).collect();
        if !names.contains(&self.material) {
            let (place, names) = (&self.place, Vec::from_iter(names).join(", "));
            return Err(Failure::bad_input(format_args!("{place}: the scene has no such material; it has {names}")));
        }
        for material in materials.iter_mut().filter(|material| material.name == self.material) {
            match self.property {
                Property::Reflectance => material.reflectance.clone_from(&numbers),
                Property::Exitance => material.exitance.clone_from(&numbers),
                Property::ExitanceFactor => {
                    material.exitance.iter_mut().zip(&numbers).for_each(|(exitance, factor)| *exitance *= factor);
                }
            }
        }
        Ok(())
    }
}

/// The scene with these changes, whatever their order.
pub fn changed(scene: &Scene, changes: &[Change]) -> Result<Scene, Failure> {
    let (mut materials, mut in_order) = (scene.materials().to_vec(), Vec::from_iter(changes));
    in_order.sort_by_key(|change| change.property);
    in_order.into_iter().try_for_each(|change| change.apply(scene.channels(), &mut materials))?;
    scene.with_materials(materials).map_err(Failure::bad_input)
}

#[cfg(test)]
mod tests {
    use patchlight::geometry::Polygon;
    use patchlight::scene::Sides;

    use super::*;

    fn scene() -> Scene {
        let material = |name: &str, exitance: f64| Material {
            name: name.to_owned(),
            reflectance: vec![0.5; 3],
            exitance: vec![exitance, 2.0 * exitance, 0.0],
        };
        let square = Polygon::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
        Scene::new(3, vec![material("wall", 0.0), material("lamp", 10.0)], vec![(square, 1, 0)], Sides::Front).unwrap()
    }

    fn change(material: &str, key: &str, text: &str) -> Result<Change, String> {
        let said = Said { key: key.to_owned(), text: text.to_owned(), place: "jobs.toml:7: x".to_owned() };
        Change::new(material, &said).map_err(|failure| failure.message)
    }

    #[test]
    fn materials_become_what_is_said_in_any_order() {
        let changes = [("lamp", "exitance_factor", "0.5 1 1"), ("lamp", "exitance", "4"), ("wall", "reflectance", "0.1 0.2 0.3")]
            .map(|(material, key, text)| change(material, key, text).unwrap());
        let found = changed(&scene(), &changes).unwrap();
        assert_eq!(found.materials()[0].reflectance, [0.1, 0.2, 0.3]);
        assert_eq!(found.materials()[0].exitance, [0.0; 3]);
        assert_eq!(found.materials()[1].exitance, [2.0, 4.0, 4.0]);
        assert_eq!(found.surfaces(), scene().surfaces());
        let halved = changed(&scene(), &changes[..1]).unwrap();
        assert_eq!(halved.materials()[1].exitance, [5.0, 20.0, 0.0]);
    }

    #[test]
    fn what_cannot_be_changed_is_told() {
        for text in ["", "much", "-1", "nan", "1 x"] {
            assert!(change("lamp", "exitance", text).unwrap_err().contains("jobs.toml:7: x: "), "{text}");
        }
        for (material, key, text, words) in [
            ("lmap", "exitance", "1", "jobs.toml:7: x: the scene has no such material; it has lamp, wall"),
            ("lamp", "exitance", "1 2", "there are 2 numbers, and 3 channels"),
            ("wall", "reflectance", "1", "material 'wall': reflectance 1 is not in [0, 1)"),
        ] {
            let failure = changed(&scene(), &[change(material, key, text).unwrap()]).unwrap_err();
            assert!(failure.message.contains(words), "{}", failure.message);
        }
    }
}
