//! What an answer is wanted for: the initial importance R of error-driven refinement.
//!
//! As typed it is text; looked up in a scene it is a part of every leaf's area. R adds up to the area of all surfaces whatever it
//! stands for, so that tolerances mean the same.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::OptionsError;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::reconstruct::{Camera, CameraError, CameraRequest};
use crate::scene::{Scene, SurfaceId};
use crate::sweep::Exposure;
use crate::transmittance::Rays;
use crate::visibility::{Ray, Visibility};

/// What an answer is wanted for.
///
/// ```
/// use patchlight::solve::Interest;
///
/// assert_eq!("total".parse(), Ok(Interest::Total));
/// assert_eq!("material floor".parse(), Ok(Interest::Material("floor".to_owned())));
/// assert!("view fov=40".parse::<Interest>().is_ok());
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Interest {
    /// All surfaces, by area.
    #[default]
    Total,
    /// What a camera sees, each surface by its part of the picture; text that [`CameraRequest`] reads, which may leave out what a camera
    /// that shows the scene takes by itself.
    View(String),
    /// Surfaces of the material with this name, by area.
    Material(String),
}

impl Interest {
    const RANGE: &'static str = "total, view (with a camera behind it, as in 'view eye=0,1,5'), or material NAME";
}

impl FromStr for Interest {
    type Err = OptionsError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (kind, rest) = text.trim().split_once(char::is_whitespace).unwrap_or((text.trim(), ""));
        match (kind, rest.trim()) {
            ("total", "") => Ok(Self::Total),
            ("view", camera) if camera.parse::<CameraRequest>().is_ok() => Ok(Self::View(camera.to_owned())),
            ("material", name) if !name.is_empty() => Ok(Self::Material(name.to_owned())),
            _ => Err(OptionsError::OutOfRange { option: "importance", value: text.to_owned(), range: Self::RANGE }),
        }
    }
}

impl fmt::Display for Interest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Total => write!(f, "total"),
            Self::View(camera) if camera.is_empty() => write!(f, "view"),
            Self::View(camera) => write!(f, "view {camera}"),
            Self::Material(name) => write!(f, "material {name}"),
        }
    }
}

impl From<Interest> for String {
    fn from(interest: Interest) -> Self {
        interest.to_string()
    }
}

impl TryFrom<String> for Interest {
    type Error = OptionsError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

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
