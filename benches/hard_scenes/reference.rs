//! What is right at the points of a scene, and how well it is known.

use std::fs::File;
use std::io;
use std::path::Path;

use patchlight::scene::{Scene, SurfaceId, SurfacePoint};

use super::triangles::{dot, sub};

/// How far off its surface a point may lie, in metres: positions are rounded to nanometres.
const OFF: f64 = 1e-8;

/// Points, and their light by long path tracing.
pub struct Reference {
    pub surfaces: Vec<SurfaceId>,
    pub points: Vec<SurfacePoint>,
    pub radiosity: Vec<[f64; 3]>,
    /// Its standard error.
    pub noise: Vec<[f64; 3]>,
    /// Emitted there.
    pub exitance: Vec<[f64; 3]>,
}

impl Reference {
    /// |R - E| at the points.
    pub fn light(&self) -> Vec<f64> {
        let both = self.radiosity.iter().zip(&self.exitance);
        both.map(|(radiosity, exitance)| length(sub(*radiosity, *exitance))).collect()
    }

    /// One row a point.
    pub fn write(&self, file: &Path) -> io::Result<()> {
        let mut writer = csv::Writer::from_path(file)?;
        writer.write_record(["x", "y", "z", "nx", "ny", "nz", "surface", "B_r", "B_g", "B_b", "se_r", "se_g", "se_b"])?;
        for (k, SurfacePoint { position, normal }) in self.points.iter().enumerate() {
            let place = position.iter().chain(normal).map(f64::to_string);
            let values = self.radiosity[k].iter().map(|value| short(*value, 7)).chain(self.noise[k].map(|value| short(value, 3)));
            writer.write_record(place.chain([self.surfaces[k].0.to_string()]).chain(values))?;
        }
        writer.flush()
    }

    /// Reads what was made for this very scene.
    pub fn read(file: &Path, scene: &Scene) -> io::Result<Self> {
        let mut reader = csv::Reader::from_reader(File::open(file)?);
        let mut reference = Self { surfaces: vec![], points: vec![], radiosity: vec![], noise: vec![], exitance: vec![] };
        for row in reader.records() {
            let row: Vec<f64> = row?.iter().map(|field| field.parse().unwrap_or(f64::NAN)).collect();
            let triple = |first: usize| [row[first], row[first + 1], row[first + 2]];
            let (surface, point) = (SurfaceId(row[6] as u32), SurfacePoint { position: triple(0), normal: triple(3) });
            if !lies_on(scene, surface, &point) {
                let text =
                    format!("{}: {point:?} does not lie on surface {}, so the scene is another one", file.display(), surface.0);
                return Err(io::Error::new(io::ErrorKind::InvalidData, text));
            }
            reference.exitance.push(std::array::from_fn(|k| scene.material_of(surface).exitance[k]));
            reference.surfaces.push(surface);
            reference.points.push(point);
            reference.radiosity.push(triple(7));
            reference.noise.push(triple(10));
        }
        Ok(reference)
    }
}

fn length(vector: [f64; 3]) -> f64 {
    dot(vector, vector).sqrt()
}

fn lies_on(scene: &Scene, id: SurfaceId, point: &SurfacePoint) -> bool {
    let Some(surface) = scene.surfaces().get(id.index()) else { return false };
    let (normal, corner) = (surface.polygon.normal(), surface.polygon.centroid());
    dot(normal, point.normal) > 1.0 - 1e-9 && dot(normal, sub(point.position, corner)).abs() < OFF
}

/// A number with so many significant digits.
fn short(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits - 1);
    text.parse::<f64>().map_or(text, |value| value.to_string())
}
