//! What an answer is wanted for: the initial importance R of error-driven refinement.
//!
//! As typed it is text; looked up in a scene it is a part of every leaf's area. R adds up to the area of all surfaces whatever it
//! stands for, so that tolerances mean the same.

use thiserror::Error;

use super::options::Interest;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::picture::{Camera, CameraError, CameraRequest};
use crate::scene::{Scene, SurfaceId};
use crate::sweep::Exposure;
use crate::transmittance::Rays;
use crate::visibility::{Ray, Visibility};

/// Why a scene has nothing of what is wanted.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum InterestError {
    /// The camera takes no picture.
    #[error("importance: {0}")]
    Camera(#[from] CameraError),
    /// No surface is of this material.
    #[error("importance: no surface has the material '{0}'")]
    NoSuchMaterial(String),
    /// All that is wanted is black, or the camera sees no surface.
    #[error("importance: the camera sees no surface from its front")]
    NothingSeen,
}

/// Width and height of the picture that counts what a camera sees.
const PICTURE: (u32, u32) = (320, 240);

/// An [`Interest`] looked up in a scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum InitialImportance {
    /// Exposed area, times what each surface counts.
    Area(Vec<f64>),
    /// Places that are seen, each of them as much as all others.
    Places(Vec<(SurfaceId, [f64; 3])>),
}

impl InitialImportance {
    /// Looks up what is wanted.
    pub fn of(interest: &Interest, scene: &Scene, visibility: &dyn Visibility) -> Result<Self, InterestError> {
        let surfaces = || (0..scene.surfaces().len() as u32).map(SurfaceId);
        match interest {
            Interest::Total => Ok(Self::Area(vec![1.0; scene.surfaces().len()])),
            Interest::Material(name) => {
                let counts: Vec<f64> = surfaces().map(|id| f64::from(u8::from(scene.material_of(id).name == *name))).collect();
                if counts.iter().all(|&count| count == 0.0) {
                    return Err(InterestError::NoSuchMaterial(name.clone()));
                }
                Ok(Self::Area(counts))
            }
            Interest::View(text) => {
                let (width, height) = PICTURE;
                let default = Camera::default_view(scene, visibility, width, height);
                let camera = text.parse::<CameraRequest>()?.apply_to(default)?.rays()?;
                let pixel = |index: u32| camera.through_pixel(index % width, index / width, 0, 1);
                let looks: Vec<Ray> = (0..width * height).map(pixel).collect();
                let mut hits = Vec::new();
                Rays::new(visibility, scene).first_hits(&looks, &mut hits);
                let place = |(look, hit): (&Ray, &Option<crate::visibility::Hit>)| {
                    let hit = hit.as_ref()?;
                    let surface = scene.side_towards(SurfaceId(hit.surface), -glam::DVec3::from(look.direction))?;
                    Some((surface, std::array::from_fn(|k| look.origin[k] + hit.distance * look.direction[k])))
                };
                let places: Vec<_> = looks.iter().zip(&hits).filter_map(place).collect();
                if places.is_empty() { Err(InterestError::NothingSeen) } else { Ok(Self::Places(places)) }
            }
        }
    }

    /// R of every leaf, the same for each channel, node after node; all of it adds up to the area of all surfaces.
    pub fn of_leaves(&self, hierarchy: &Hierarchy, exposure: &Exposure, channels: usize) -> Vec<f64> {
        let mut by_node = vec![0.0; hierarchy.len()];
        match self {
            Self::Area(counts) => {
                for leaf in hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)) {
                    let count = hierarchy.surface_of(leaf).map_or(0.0, |surface| counts[surface.index()]);
                    by_node[leaf.index()] = count * hierarchy.area(leaf) * exposure.of(leaf);
                }
            }
            Self::Places(places) => {
                places.iter().for_each(|&(surface, place)| by_node[hierarchy.leaf_at(surface, place.into()).index()] += 1.0);
            }
        }
        let scale = hierarchy.area(NodeId::ROOT) / by_node.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        by_node.iter().flat_map(|r| std::iter::repeat_n(scale * r, channels)).collect()
    }
}
