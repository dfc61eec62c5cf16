//! What faces are coloured by beside the factors of their material: means of textures and of colours of vertices.

use std::collections::BTreeMap;

use glam::DVec3;

use super::super::join::Joined;
use super::accessors::Accessors;
use super::json::Primitive;
use super::materials::{Materials, Means, Source, TextureUse};
use super::primitives::{Triangles, attribute};

/// The triangles of a primitive as they are coloured.
pub(super) struct Colours<'a> {
    pub materials: &'a Materials,
    pub source: &'a Source,
    /// In the frame of the primitive.
    pub own: &'a Triangles,
    /// Corners in the world, whose winding may be another.
    pub vertices: &'a [DVec3],
    /// Texture coordinates by their sets.
    sets: BTreeMap<usize, Vec<[f64; 2]>>,
}

impl<'a> Colours<'a> {
    /// Reads the texture coordinates that the material needs.
    pub fn read(
        materials: &'a Materials,
        source: &'a Source,
        (primitive, own): (&Primitive, &'a Triangles),
        vertices: &'a [DVec3],
        accessors: &Accessors<'_>,
    ) -> Result<Self, String> {
        let mut sets = BTreeMap::new();
        for texture in source.colour_texture.iter().chain(&source.radiance_texture) {
            let name = format!("TEXCOORD_{}", texture.set);
            let number = attribute(primitive, &name)?.ok_or_else(|| format!("its material has a texture, but it has no {name}"))?;
            let coordinates = accessors.vectors::<2>(number)?;
            if coordinates.len() != own.positions.len() {
                return Err(format!("it has more or fewer {name} than vertices"));
            }
            sets.insert(texture.set, coordinates);
        }
        Ok(Self { materials, source, own, vertices, sets })
    }

    /// The means over a face, by area.
    pub fn means(&self, face: &Joined) -> Means {
        let mut means = Means { colour: [0.0; 3], radiance: [0.0; 3] };
        if self.sets.is_empty() && self.own.colours.is_none() {
            return Means { colour: [1.0; 3], radiance: [1.0; 3] };
        }
        let area = |triangle: usize| {
            let [a, b, c] = self.own.triangles[triangle].map(|corner| self.vertices[corner as usize]);
            (b - a).cross(c - a).length()
        };
        let total: f64 = face.triangles.iter().map(|&triangle| area(triangle)).sum();
        for &triangle in &face.triangles {
            // A face without area is dropped later: its colour is of no importance.
            let share = if total > 0.0 { area(triangle) / total } else { 1.0 / face.triangles.len() as f64 };
            let painted = self.painted(triangle);
            let colour = self.textured(&self.source.colour_texture, triangle);
            let radiance = self.textured(&self.source.radiance_texture, triangle);
            for k in 0..3 {
                means.colour[k] += share * colour[k] * painted[k];
                means.radiance[k] += share * radiance[k];
            }
        }
        means
    }

    /// The mean of the colours of the corners of a triangle.
    fn painted(&self, triangle: usize) -> [f64; 3] {
        let Some(colours) = &self.own.colours else { return [1.0; 3] };
        let corners = self.own.triangles[triangle].map(|corner| colours[corner as usize]);
        std::array::from_fn(|k| corners.iter().map(|colour| colour[k]).sum::<f64>() / 3.0)
    }

    /// The mean of a texture over a triangle.
    fn textured(&self, texture: &Option<TextureUse>, triangle: usize) -> [f64; 3] {
        let Some(texture) = texture else { return [1.0; 3] };
        let coordinates = &self.sets[&texture.set];
        self.materials.mean(texture, self.own.triangles[triangle].map(|corner| coordinates[corner as usize]))
    }
}
