//! Channels that need no solve of their own: those that repeat another, and those in which nothing emits.

use super::{Light, Material, Scene};

/// What of a scene must be solved, and which of that each of its channels is read off.
pub(crate) struct DistinctChannels {
    /// The scene in the channels that must be solved.
    pub scene: Scene,
    /// How many channels each of these stands for: the same number for all, so that errors keep their weights.
    pub copies: usize,
    /// By channel of the given scene, the one that it equals; `None` for a dark one.
    of: Vec<Option<usize>>,
}

impl DistinctChannels {
    /// `None` if all channels must be solved.
    pub fn of(scene: &Scene) -> Option<Self> {
        let column = |channel: usize| {
            let of_materials =
                scene.materials.iter().map(move |material| (material.reflectance[channel], material.exitance[channel]));
            of_materials.chain(scene.lights.iter().map(move |light| (0.0, light.strength[channel])))
        };
        let is_lit = |channel: usize| column(channel).any(|(_, exitance)| exitance > 0.0);

        // What every channel repeats; nothing, where that would give channels unequal weights.
        let all = 0..scene.channels;
        let first = |channel: usize| (0..=channel).find(|&earlier| column(earlier).eq(column(channel)));
        let firsts: Vec<Option<usize>> = all.clone().map(|channel| first(channel).filter(|&channel| is_lit(channel))).collect();
        let copies = |channel: usize| firsts.iter().filter(|&&first| first == Some(channel)).count();
        let most = all.clone().map(copies).max().unwrap_or(1).max(1);
        let even = all.clone().map(copies).all(|count| count == 0 || count == most);
        let (firsts, copies) = if even {
            (firsts, most)
        } else {
            (all.clone().map(|channel| Some(channel).filter(|&channel| is_lit(channel))).collect(), 1)
        };

        // Where no light is on at all, one dark channel is solved.
        let mut solved: Vec<usize> = all.filter(|&channel| firsts[channel] == Some(channel)).collect();
        if solved.is_empty() {
            solved.push(0);
        }
        if solved.len() == scene.channels {
            return None;
        }

        let of = firsts.iter().map(|first| solved.iter().position(|&channel| Some(channel) == *first)).collect();
        let pick = |values: &[f64]| solved.iter().map(|&channel| values[channel]).collect();
        let pick_of = |material: &Material| {
            let Material { name, reflectance, exitance } = material;
            Material { name: name.clone(), reflectance: pick(reflectance), exitance: pick(exitance) }
        };
        let materials = scene.materials.iter().map(pick_of).collect();
        let lights = scene.lights.iter().map(|light| Light { strength: pick(&light.strength), ..light.clone() }).collect();
        let light_groups = scene.light_groups.as_ref().map(|groups| groups.of_bands(&pick));
        let scene = Scene { channels: solved.len(), materials, lights, light_groups, ..scene.clone() };
        Some(Self { scene, copies, of })
    }

    /// How many channels need no solve.
    pub fn spared(&self) -> usize {
        self.of.len() - self.scene.channels
    }

    /// How many channels the given scene has.
    pub fn count(&self) -> usize {
        self.of.len()
    }

    /// How many channels an item of so many solved ones has, which may be many runs of them.
    pub fn count_of(&self, solved: usize) -> usize {
        self.count() * (solved / self.scene.channels)
    }

    /// Values of all channels, item after item, from those of the solved ones. An item may be many runs of channels, as of light groups.
    pub fn expand<T: Copy + Default>(&self, solved: &[T]) -> Vec<T> {
        let item = |item: &'_ [T]| -> Vec<T> {
            self.of.iter().map(|channel| channel.map_or_else(T::default, |channel| item[channel])).collect()
        };
        solved.chunks(self.scene.channels).flat_map(item).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polygon;
    use crate::scene::Sides;

    fn scene(channels: usize, reflectance: &[f64], exitance: &[f64]) -> Scene {
        let square = Polygon::new(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]).unwrap();
        let materials = [("lamp", reflectance, exitance), ("wall", exitance, reflectance)].map(|(name, first, second)| Material {
            name: name.to_owned(),
            reflectance: first.to_vec(),
            exitance: if name == "lamp" { second.to_vec() } else { vec![0.0; channels] },
        });
        Scene::new(channels, materials.to_vec(), vec![(square, 0, 0)], Sides::Front).unwrap()
    }

    /// Solved channels and copies, and where each channel is read off.
    fn distinct(reflectance: &[f64], exitance: &[f64]) -> Option<(usize, usize, Vec<f64>)> {
        let channels = DistinctChannels::of(&scene(reflectance.len(), reflectance, exitance))?;
        let solved: Vec<f64> = (1..=channels.scene.channels()).map(|value| value as f64).collect();
        Some((channels.scene.channels(), channels.copies, channels.expand(&solved)))
    }

    #[test]
    fn what_repeats_or_is_dark_is_read_off() {
        // Grey; all different; in pairs; dark ones between.
        assert_eq!(distinct(&[0.5, 0.5, 0.5], &[0.9, 0.9, 0.9]), Some((1, 3, vec![1.0, 1.0, 1.0])));
        assert_eq!(distinct(&[0.5, 0.6, 0.7], &[0.9, 0.9, 0.9]), None);
        assert_eq!(distinct(&[0.5, 0.6, 0.5, 0.6], &[0.9; 4]), Some((2, 2, vec![1.0, 2.0, 1.0, 2.0])));
        assert_eq!(distinct(&[0.5, 0.6, 0.5, 0.7], &[0.0, 0.9, 0.0, 0.9]), Some((2, 1, vec![0.0, 1.0, 0.0, 2.0])));
        // Two of three are equal: merged, the third would weigh half as much as it does.
        assert_eq!(distinct(&[0.5, 0.5, 0.6], &[0.9; 3]), None);
        assert_eq!(distinct(&[0.5, 0.5, 0.6, 0.1], &[0.9, 0.9, 0.9, 0.0]), Some((3, 1, vec![1.0, 2.0, 3.0, 0.0])));
        // No light at all.
        assert_eq!(distinct(&[0.5, 0.6], &[0.0; 2]), Some((1, 1, vec![0.0, 0.0])));
    }
}
