//! Faces of textured materials of MTL files: each has the mean of its texture over it, times `Kd` or `Ke`.
//!
//! Each mean makes a material of its own, of the same name.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::faces::{Face, FaceFile};
use super::maps::Map;
use super::mtl::{LARGEST_REFLECTANCE, Maps};
use super::text::{lies_below, read_regular_file};
use super::texture_coordinates::TextureCoordinates;
use super::textures::Picture;
use super::{Diagnostic, DiagnosticKind, Diagnostics, ImportError, ImportOptions, Textures};
use crate::progress::Stop;
use crate::scene::Material;

/// Faces that are coloured between two questions whether to stop.
const FACES_AT_ONCE: usize = 1 << 10;

/// Gives faces of textured materials materials of their own. `maps` are those of the materials of `read`; `scene` is its file.
pub(super) fn colour_faces(
    read: &mut FaceFile,
    maps: &[Maps],
    coordinates: &TextureCoordinates,
    (scene, options): (&Path, &ImportOptions),
    diagnostics: &mut Diagnostics,
    stop: Stop<'_>,
) -> Result<(), ImportError> {
    let mut used = vec![false; maps.len()];
    for face in &read.faces {
        if let Some(used) = used.get_mut(face.material as usize) {
            *used = true;
        }
    }
    let pictures = Pictures::of_materials(maps, &used, (scene, options), diagnostics, stop)?;
    let shown: Vec<Option<Shown<'_>>> = maps.iter().map(|maps| pictures.shown(maps)).collect();
    read.libraries.extend(pictures.read.iter().cloned());

    // Face by face, with one material for each mean.
    let mut colours = Colours { numbers: HashMap::new(), clamped: HashSet::new(), materials: &mut read.materials };
    for (index, face) in read.faces.iter_mut().enumerate() {
        if index % FACES_AT_ONCE == 0 && stop() {
            return Err(ImportError::Cancelled);
        }
        let Some(Some(shown)) = shown.get(face.material as usize) else { continue };
        let colour = |map: &Option<(&Map, &Picture)>, factor: [f64; 3]| {
            map.map(|(map, picture)| {
                let mean = mean_over(face, &read.corners, coordinates, map, picture);
                std::array::from_fn(|channel| factor[channel] * mean[channel])
            })
        };
        let found = [colour(&shown.colour, shown.maps.colour_factor), colour(&shown.radiance, shown.maps.radiance_factor)];
        face.material = colours.material_of(face.material, found, (shown.maps, diagnostics));
    }
    Ok(())
}

/// The images that materials name, by their files; `None` for those that cannot be read.
struct Pictures {
    by_file: HashMap<PathBuf, Option<Picture>>,
    /// Those that could be read, in their order.
    read: Vec<PathBuf>,
}

/// What is seen of the textures of a material.
struct Shown<'a> {
    maps: &'a Maps,
    colour: Option<(&'a Map, &'a Picture)>,
    radiance: Option<(&'a Map, &'a Picture)>,
}

impl Pictures {
    /// Those of the materials that are used; what cannot be read is a warning.
    fn of_materials(
        maps: &[Maps],
        used: &[bool],
        (scene, options): (&Path, &ImportOptions),
        diagnostics: &mut Diagnostics,
        stop: Stop<'_>,
    ) -> Result<Self, ImportError> {
        let mut pictures = Self { by_file: HashMap::new(), read: Vec::new() };
        for maps in maps.iter().zip(used).filter(|(_, used)| **used).map(|(maps, _)| maps) {
            for map in maps.colour.iter().chain(&maps.radiance) {
                if stop() {
                    return Err(ImportError::Cancelled);
                }
                if options.textures == Textures::Reject {
                    let reason = "a texture, and --texture reject wants none".to_owned();
                    return Err(ImportError::Syntax { file: maps.file.clone(), line: map.line, face: None, reason });
                }
                let file = file_of(maps, map);
                if pictures.by_file.contains_key(&file) {
                    continue;
                }
                let picture = picture_of(&file, scene, options.allow_any_path);
                match &picture {
                    Ok(_) => pictures.read.push(file.clone()),
                    Err(reason) => {
                        let text = format!("texture {} is left out: {reason}", file.display());
                        diagnostics.push(Diagnostic::new(DiagnosticKind::MissingTexture, text).at(&maps.file, map.line));
                    }
                }
                pictures.by_file.insert(file, picture.ok());
            }
        }
        Ok(pictures)
    }

    /// What a material shows of its textures; `None` if nothing.
    fn shown<'a>(&'a self, maps: &'a Maps) -> Option<Shown<'a>> {
        let picture = |map: &'a Map| Some((map, self.by_file.get(&file_of(maps, map))?.as_ref()?));
        let [colour, radiance] = [&maps.colour, &maps.radiance].map(|map| map.as_ref().and_then(picture));
        (colour.is_some() || radiance.is_some()).then_some(Shown { maps, colour, radiance })
    }
}

/// The file of a texture, beside the library that names it; some exporters write the separator of another system.
fn file_of(maps: &Maps, map: &Map) -> PathBuf {
    let beside = |name: &str| maps.file.parent().unwrap_or(Path::new("")).join(name);
    let as_written = beside(&map.name);
    if as_written.is_file() { as_written } else { beside(&map.name.replace('\\', "/")) }
}

/// The image of a file, if the scene may name it.
fn picture_of(file: &Path, scene: &Path, allow_any_path: bool) -> Result<Picture, String> {
    if !allow_any_path && !lies_below(file, scene) {
        return Err("it lies outside of the folder of the scene; allow that by --allow-any-path".to_owned());
    }
    Picture::decode(&read_regular_file(file)?)
}

/// The mean of a texture over a face; over all of it where the face has no coordinates.
fn mean_over(face: &Face, corners: &[DVec3], coordinates: &TextureCoordinates, map: &Map, picture: &Picture) -> [f64; 3] {
    let wrap = [map.wrap; 2];
    let mean_of_all = || {
        let halves = [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]];
        let [a, b] = halves.map(|half| picture.mean(half, wrap));
        std::array::from_fn(|channel| 0.5 * (a[channel] + b[channel]))
    };
    let place = |corner: usize| Some(map.place(coordinates.of(corner)?)).filter(|place| place.iter().all(|x| x.is_finite()));
    let places = (face.start..face.end).map(place);
    let Some(places) = places.collect::<Option<Vec<[f64; 2]>>>() else { return mean_of_all() };

    // By a fan of triangles, whose areas count as negative where the corners turn the other way.
    let corners = &corners[face.start..face.end];
    let triangles = || (1..corners.len() - 1).map(|k| [0, k, k + 1]);
    let area_of = |[a, b, c]: [usize; 3]| (corners[b] - corners[a]).cross(corners[c] - corners[a]);
    let normal: DVec3 = triangles().map(area_of).sum::<DVec3>().normalize_or_zero();
    let (mut sum, mut area) = ([0.0; 3], 0.0);
    for triangle in triangles() {
        let weight = area_of(triangle).dot(normal);
        let mean = picture.mean(triangle.map(|corner| places[corner]), wrap);
        sum.iter_mut().zip(mean).for_each(|(sum, mean)| *sum += weight * mean);
        area += weight;
    }
    // A texture is nowhere negative; what fans of a few parts each leave below zero is rounding.
    if area > 0.0 { sum.map(|sum| (sum / area).clamp(0.0, 1.0)) } else { mean_of_all() }
}

/// The materials of faces, by what they are coloured with.
struct Colours<'a> {
    numbers: HashMap<(u32, [u64; 6]), u32>,
    /// Materials of which a reflectance was lowered.
    clamped: HashSet<u32>,
    materials: &'a mut Vec<Material>,
}

impl Colours<'_> {
    /// The number of a material with this reflectance and radiance in place of its own, where there are any.
    fn material_of(
        &mut self,
        number: u32,
        [colour, radiance]: [Option<[f64; 3]>; 2],
        (maps, diagnostics): (&Maps, &mut Diagnostics),
    ) -> u32 {
        let own = &self.materials[number as usize];
        let written: Vec<f64> = colour.map_or_else(|| own.reflectance.clone(), Vec::from);
        let reflectance: Vec<f64> = written.iter().map(|&rho| if rho >= 1.0 { LARGEST_REFLECTANCE } else { rho }).collect();
        let exitance = radiance.map_or_else(|| own.exitance.clone(), |l| l.map(|l| std::f64::consts::PI * l).to_vec());
        if written != reflectance && self.clamped.insert(number) {
            let line = maps.colour.as_ref().map_or(0, |map| map.line);
            let text = format!(
                "material '{}' has faces of reflectance 1 and more by its texture: they become {LARGEST_REFLECTANCE}",
                own.name
            );
            diagnostics.push(Diagnostic::new(DiagnosticKind::ReflectanceClamped, text).at(&maps.file, line).material(&own.name));
        }

        let key = std::array::from_fn(|k| if k < 3 { reflectance[k] } else { exitance[k - 3] }.to_bits());
        let next = self.materials.len() as u32;
        let found = *self.numbers.entry((number, key)).or_insert(next);
        if found == next {
            let material = Material { name: own.name.clone(), reflectance, exitance };
            self.materials.push(material);
        }
        found
    }
}
