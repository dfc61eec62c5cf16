//! Materials of glTF as diffuse ones (glTF 2.0 Specification, section 3.9).
//!
//! The reflectance is the base colour: factor, texture and colours of vertices, multiplied, and averaged over each face. So a metal sends on as much
//! light as it does in truth, though not into one direction; what a dielectric reflects in its gloss has no part in it. The exitance is
//! `pi` times the emissive factor, texture and strength: a radiance, in W/m^2/sr.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::PathBuf;

use super::super::mtl::{DEFAULT_REFLECTANCE, LARGEST_REFLECTANCE, LARGEST_VALUE};
use super::super::textures::{Picture, Wrap};
use super::accessors::Accessors;
use super::buffers::Place;
use super::container::shown;
use super::json::{self, Extensions, Root, TextureInfo};
use crate::scene::Material;
use crate::scene::import::DiagnosticKind;

/// How a material uses a texture.
pub(super) struct TextureUse {
    image: usize,
    /// The set of texture coordinates.
    pub set: usize,
    wrap: [Wrap; 2],
    /// From texture coordinates to those of the image: a 2 x 2 matrix by rows, and an offset (KHR_texture_transform).
    matrix: [[f64; 2]; 2],
    offset: [f64; 2],
}

/// A material as it was read.
pub(super) struct Source {
    /// Empty for what has none.
    pub name: String,
    colour: [f64; 3],
    radiance: [f64; 3],
    pub colour_texture: Option<TextureUse>,
    pub radiance_texture: Option<TextureUse>,
    pub is_double_sided: bool,
}

/// The materials of a scene: what was read, and what it became on faces.
pub(super) struct Materials {
    sources: HashMap<Option<usize>, Source>,
    pictures: HashMap<usize, Picture>,
    numbers: HashMap<(Option<usize>, [u64; 6]), u32>,
    /// Those that faces have.
    pub materials: Vec<Material>,
    /// What is worth telling, with how many materials it is about and the first of them.
    notes: BTreeMap<(DiagnosticKind, &'static str), (usize, String)>,
    clamped: HashSet<Option<usize>>,
}

/// What the factors of a face are multiplied by: means of textures and colours of vertices.
#[derive(Clone, Copy)]
pub(super) struct Means {
    pub colour: [f64; 3],
    pub radiance: [f64; 3],
}

impl Materials {
    pub fn new() -> Self {
        Self {
            sources: HashMap::new(),
            pictures: HashMap::new(),
            numbers: HashMap::new(),
            materials: Vec::new(),
            notes: BTreeMap::new(),
            clamped: HashSet::new(),
        }
    }

    /// Reads a material, with its textures; `None` is that of primitives that have none.
    pub fn read(
        &mut self,
        number: Option<usize>,
        accessors: &Accessors<'_>,
        place: &Place<'_>,
        files: &mut Vec<PathBuf>,
    ) -> Result<&Source, String> {
        if !self.sources.contains_key(&number) {
            let root = accessors.root;
            let source = match number {
                None => self.without_material(),
                Some(number) => {
                    let all = root.materials.len();
                    let material = root.materials.get(number);
                    let material =
                        material.ok_or_else(|| format!("material {number} does not exist: there are {all}, numbered from 0"))?;
                    self.source(material, number, root)?
                }
            };
            for texture in source.colour_texture.iter().chain(&source.radiance_texture) {
                self.load(texture.image, accessors, place, files).map_err(|reason| format!("image {}: {reason}", texture.image))?;
            }
            self.sources.insert(number, source);
        }
        Ok(&self.sources[&number])
    }

    fn without_material(&mut self) -> Source {
        self.note(DiagnosticKind::NoMaterial, "primitives without a material are grey 0.5", "");
        let (colour, radiance) = ([DEFAULT_REFLECTANCE; 3], [0.0; 3]);
        Source { name: String::new(), colour, radiance, colour_texture: None, radiance_texture: None, is_double_sided: false }
    }

    fn source(&mut self, material: &json::Material, number: usize, root: &Root) -> Result<Source, String> {
        let name = material.name.as_deref().map_or_else(|| format!("material {number}"), shown);
        self.note_left_out(material, &name);
        let [r, g, b, _] = material.pbr_metallic_roughness.base_color_factor;
        let strength = number_of(&material.extensions, "KHR_materials_emissive_strength", "emissiveStrength").unwrap_or(1.0);
        let (colour, radiance) = ([r, g, b], material.emissive_factor.map(|factor| factor * strength));
        if let Some(bad) = colour.iter().chain(&radiance).find(|value| value.is_nan() || value.abs() >= LARGEST_VALUE) {
            return Err(format!("a value of material '{name}' is {bad}, not a number below {LARGEST_VALUE:e}"));
        }
        if colour.iter().chain(&radiance).any(|&value| value < 0.0) {
            self.note(DiagnosticKind::NegativeValue, "negative colours become 0", &name);
        }
        let texture = |info: &Option<TextureInfo>| info.as_ref().map(|info| TextureUse::of(info, root)).transpose();
        let in_material = |reason| format!("material '{name}': {reason}");
        Ok(Source {
            colour: colour.map(|value| value.max(0.0) + 0.0),
            radiance: radiance.map(|value| value.max(0.0) + 0.0),
            colour_texture: texture(&material.pbr_metallic_roughness.base_color_texture).map_err(in_material)?,
            radiance_texture: texture(&material.emissive_texture).map_err(in_material)?,
            is_double_sided: material.double_sided,
            name,
        })
    }

    /// Notes what of a material is not diffuse.
    fn note_left_out(&mut self, material: &json::Material, name: &str) {
        const DIFFUSE: [&str; 3] = ["KHR_materials_emissive_strength", "KHR_materials_unlit", "KHR_materials_ior"];
        let mut left_out = |what| self.note(DiagnosticKind::IgnoredProperty, what, name);
        if material.pbr_metallic_roughness.metallic_factor > 0.0 {
            left_out("metals reflect their base colour into all directions: materials are diffuse");
        }
        if material.alpha_mode.as_deref().is_some_and(|mode| mode != "OPAQUE") {
            left_out("alphaMode is left out: what is transparent is taken as opaque");
        }
        if material.normal_texture.is_some() {
            left_out("normalTexture is left out: faces are as flat as their vertices");
        }
        if material.extensions.keys().any(|key| key.contains("transmission")) {
            left_out("transmission is left out: glass reflects its base colour, and nothing goes through");
        } else if material.extensions.keys().any(|key| !DIFFUSE.contains(&key.as_str())) {
            left_out("extensions of materials are left out: materials are diffuse");
        }
    }

    fn note(&mut self, kind: DiagnosticKind, what: &'static str, name: &str) {
        self.notes.entry((kind, what)).or_insert_with(|| (0, name.to_owned())).0 += 1;
    }

    /// What is worth telling, a line for each kind.
    pub fn notes(&self) -> impl Iterator<Item = (DiagnosticKind, String)> {
        self.notes.iter().map(|(&(kind, what), (count, first))| {
            let text = match (*count, first.as_str()) {
                (_, "") => what.to_owned(),
                (1, first) => format!("{what} (material '{first}')"),
                (count, first) => format!("{what} ({count} materials, '{first}' first)"),
            };
            (kind, text)
        })
    }

    fn load(&mut self, image: usize, accessors: &Accessors<'_>, place: &Place<'_>, files: &mut Vec<PathBuf>) -> Result<(), String> {
        if self.pictures.contains_key(&image) {
            return Ok(());
        }
        let all = &accessors.root.images;
        let source = all.get(image).ok_or_else(|| format!("it does not exist: there are {}, numbered from 0", all.len()))?;
        let picture = match (&source.uri, source.buffer_view) {
            (Some(uri), _) => Picture::decode(&place.bytes_of(uri, files)?)?,
            (None, Some(view)) => Picture::decode(accessors.buffers.view(view)?.0)?,
            (None, None) => return Err("it has neither uri nor bufferView".to_owned()),
        };
        self.pictures.insert(image, picture);
        Ok(())
    }

    /// The mean of a texture over a triangle of texture coordinates.
    pub fn mean(&self, texture: &TextureUse, corners: [[f64; 2]; 3]) -> [f64; 3] {
        let moved = corners.map(|at| {
            let of_row = |row: usize| texture.matrix[row][0] * at[0] + texture.matrix[row][1] * at[1] + texture.offset[row];
            [of_row(0), of_row(1)]
        });
        self.pictures[&texture.image].mean(moved, texture.wrap)
    }

    /// A material that was read.
    pub fn source_of(&self, number: Option<usize>) -> &Source {
        &self.sources[&number]
    }

    /// The number of the material of a face.
    pub fn of_face(&mut self, number: Option<usize>, means: Means) -> u32 {
        let source = &self.sources[&number];
        let times = |factor: [f64; 3], mean: [f64; 3]| std::array::from_fn::<f64, 3, _>(|k| factor[k] * mean[k].max(0.0));
        let (colour, radiance) = (times(source.colour, means.colour), times(source.radiance, means.radiance));
        let key = std::array::from_fn(|k| if k < 3 { colour[k] } else { radiance[k - 3] }.to_bits());
        if let Some(&known) = self.numbers.get(&(number, key)) {
            return known;
        }

        let new = self.materials.len() as u32;
        self.materials.push(Material {
            name: source.name.clone(),
            reflectance: colour.iter().map(|&rho| if rho >= 1.0 { LARGEST_REFLECTANCE } else { rho }).collect(),
            exitance: radiance.iter().map(|value| std::f64::consts::PI * value).collect(),
        });
        if colour.iter().any(|&rho| rho >= 1.0) && self.clamped.insert(number) {
            let name = source.name.clone();
            self.note(DiagnosticKind::ReflectanceClamped, "base colours of 1 and more become 0.99", &name);
        }
        self.numbers.insert((number, key), new);
        new
    }
}

impl TextureUse {
    fn of(info: &TextureInfo, root: &Root) -> Result<Self, String> {
        let texture = root.textures.get(info.index).ok_or_else(|| format!("texture {} does not exist", info.index))?;
        let image = texture.source.ok_or_else(|| format!("texture {} has no PNG or JPEG image", info.index))?;
        let sampler = texture.sampler.map(|sampler| root.samplers.get(sampler).ok_or("its sampler does not exist")).transpose()?;
        let (wrap_s, wrap_t) = sampler.map_or((10497, 10497), |sampler| (sampler.wrap_s, sampler.wrap_t));

        // Scale, then turn, then move; an angle turns from u to -v, since v points down.
        let transform = info.extensions.get("KHR_texture_transform");
        let pair = |key: &str, otherwise: f64| {
            let of = |k: usize| transform.and_then(|t| t.get(key)?.get(k)?.as_f64()).unwrap_or(otherwise);
            [of(0), of(1)]
        };
        let (scale, offset) = (pair("scale", 1.0), pair("offset", 0.0));
        let (sin, cos) = transform.and_then(|t| t.get("rotation")?.as_f64()).unwrap_or(0.0).sin_cos();
        let set = transform.and_then(|t| t.get("texCoord")?.as_u64()).map_or(info.tex_coord, |set| set as usize);
        Ok(Self {
            image,
            set,
            wrap: [Wrap::of(wrap_s), Wrap::of(wrap_t)],
            matrix: [[cos * scale[0], sin * scale[1]], [-sin * scale[0], cos * scale[1]]],
            offset,
        })
    }
}

/// A number of an extension.
fn number_of(extensions: &Extensions, extension: &str, key: &str) -> Option<f64> {
    extensions.get(extension)?.get(key)?.as_f64()
}
