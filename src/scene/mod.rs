//! What is lit: surfaces with materials, validated and immutable from here on.

mod distinct_channels;
mod emission_apart;
mod emitter_name;
mod emitters;
mod error;
mod face_names;
mod file_uv;
pub mod import;
mod largest;
mod light_channels;
mod light_group_error;
mod light_grouping;
mod light_groups;
mod lights;
mod lit_by;
mod material;
mod on_threads;
mod planes;
mod point;
mod summary;
mod surface;
mod surfaces;
mod twins;
mod up;

pub(crate) use distinct_channels::DistinctChannels;
pub(crate) use emission_apart::EmissionApart;
pub use emitter_name::EmitterName;
pub(crate) use emitters::Emitter;
pub use error::SceneError;
pub use face_names::FaceNames;
pub use file_uv::{FileUv, UvTriangle};
pub(crate) use largest::largest;
pub use light_group_error::LightGroupError;
pub use light_grouping::LightGrouping;
pub use light_groups::{LightGroups, LightWeight};
pub(crate) use lights::luminance;
pub use lights::{
    Distribution, IntensityTable, LUMENS_PER_WATT, Light, LightError, LightShape, Luminaire, PointLight, Sky, SkyLight, Spot, Sun,
};
pub use material::Material;
pub use point::{PointError, SurfacePoint};
pub use summary::{LightSummary, SceneSummary};
pub use surface::{Surface, SurfaceId};
pub use up::Up;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use self::on_threads::on_threads_of_caller;
pub(crate) use self::surfaces::Surfaces;
use crate::geometry::{Aabb, Polygon};

/// Which sides of a face emit and receive. Every face occludes from both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sides {
    /// The front, where the vertices run counter-clockwise.
    #[default]
    Front,
    /// Both: each face becomes two surfaces back to back, each with the exitance of the face.
    Both,
}

/// A scene has at most so many channels: there is a radiosity in each for every node.
const MOST_CHANNELS: usize = 1024;

/// Surfaces and materials. Immutable: every later stage relies on what [`Scene::new`] checked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    channels: usize,
    materials: Vec<Material>,
    surfaces: Surfaces,
    /// What sends light beside them.
    lights: Vec<Light>,
    sides: Sides,
    /// Which axis points up, if that was said.
    up: Option<Up>,
    /// What their faces belong to.
    objects: FaceNames,
    groups: FaceNames,
    /// Emitters whose light is kept apart.
    light_groups: Option<LightGroups>,
    /// By material, the exitance that it was solved with, where materials were changed after that.
    solved_exitance: Option<Vec<Vec<f64>>>,
    /// How many of the channels, the last ones, carry the light of groups; none in a scene that is stored.
    #[serde(skip)]
    carried: usize,
}

impl Scene {
    /// A scene of `faces` (polygon, material index, number of the face in the input), in the order given.
    ///
    /// With [`Sides::Both`] each face is followed by its twin, except where the input has the twin itself.
    ///
    /// # Errors
    /// See [`SceneError`].
    pub fn new(
        channels: usize,
        materials: Vec<Material>,
        faces: Vec<(Polygon, u32, u32)>,
        sides: Sides,
    ) -> Result<Self, SceneError> {
        if faces.is_empty() {
            return Err(SceneError::Empty);
        }
        if faces.len() > (1 << 30) {
            return Err(SceneError::TooLarge);
        }
        let count = materials.len();
        if let Some((surface, &(_, material, _))) = faces.iter().enumerate().find(|(_, face)| face.1 as usize >= count) {
            return Err(SceneError::NoSuchMaterial { surface, material, count });
        }

        let surface = |(polygon, material, face)| Surface { polygon, material, face, plane: 0, twin: None };
        let surfaces = on_threads_of_caller(|| Surfaces::new(faces.into_iter().map(surface).collect()));
        let (objects, groups) = (FaceNames::default(), FaceNames::default());
        let mut scene = Self {
            channels,
            materials,
            surfaces,
            lights: Vec::new(),
            sides,
            up: None,
            objects,
            groups,
            light_groups: None,
            solved_exitance: None,
            carried: 0,
        };
        scene.check_materials()?;
        on_threads_of_caller(|| {
            scene.add_twins();
            scene.group_planes();
        });
        Ok(scene)
    }

    /// The same surfaces of other materials, in the order of [`Scene::materials`], without light groups.
    ///
    /// # Errors
    /// [`SceneError::Materials`] for more or fewer of them, and what [`Scene::new`] says of materials.
    pub fn with_materials(&self, materials: Vec<Material>) -> Result<Self, SceneError> {
        if materials.len() != self.materials.len() {
            return Err(SceneError::Materials { given: materials.len(), needed: self.materials.len() });
        }
        let scene = Self { materials, light_groups: None, solved_exitance: None, ..self.clone() };
        scene.check_materials()?;
        Ok(scene)
    }

    /// The same surfaces of other materials, to which rays and cells stay as they were for those that were solved: [`Scene::exitance_as_solved`].
    ///
    /// # Errors
    /// Those of [`Scene::with_materials`].
    pub(crate) fn with_materials_after_solve(&self, materials: Vec<Material>) -> Result<Self, SceneError> {
        let of_materials = || self.materials.iter().map(|material| material.exitance.clone()).collect();
        let solved_exitance = Some(self.solved_exitance.clone().unwrap_or_else(of_materials));
        Ok(Self { solved_exitance, ..self.with_materials(materials)? })
    }

    /// The same with the objects and groups that the faces of its input belong to.
    #[must_use]
    pub fn with_names(self, objects: FaceNames, groups: FaceNames) -> Self {
        Self { objects, groups, ..self }
    }

    /// The same, of which is known where up is.
    #[must_use]
    pub fn with_up(self, up: Option<Up>) -> Self {
        Self { up, ..self }
    }

    /// The axis that points up, if somebody has said so.
    pub fn up(&self) -> Option<Up> {
        self.up
    }

    /// Every material must have as many channels as the scene, of which there must be some, with values in range.
    fn check_materials(&self) -> Result<(), SceneError> {
        if !(1..=MOST_CHANNELS).contains(&self.channels) {
            return Err(SceneError::Channels(self.channels));
        }
        self.materials.iter().try_for_each(|material| material.validate(self.channels))?;
        let highest = |channel: usize| self.materials.iter().map(|material| material.reflectance[channel]).fold(0.0, f64::max);
        let highest: Vec<f64> = (0..self.channels).map(highest).collect();
        self.materials.iter().try_for_each(|material| material.check_brightness(&highest))
    }

    /// Checks what [`Scene::new`] guarantees, for a scene that was read from a file. Polygons were measured when they were decoded.
    ///
    /// # Errors
    /// Says what is wrong.
    pub(crate) fn validate(&self) -> Result<(), String> {
        self.check_materials().map_err(|error| error.to_string())?;
        self.check_lights().map_err(|error| error.to_string())?;
        self.check_light_groups()?;
        let is_exitance = |of: &Vec<f64>| of.len() == self.channels && of.iter().all(|e| (0.0..=f64::from(f32::MAX)).contains(e));
        let fits = |of: &Vec<Vec<f64>>| of.len() == self.materials.len() && of.iter().all(is_exitance);
        if !self.solved_exitance.as_ref().is_none_or(|of| self.light_groups.is_none() && fits(of)) {
            return Err("the exitance that materials were solved with does not fit the scene".to_owned());
        }
        let (count, mut planes) = (self.surfaces.len(), 0);
        for (index, surface) in self.surfaces.iter().enumerate() {
            if surface.plane > planes {
                return Err(format!("surface {index}: its plane has no number in the order of the surfaces"));
            }
            planes = planes.max(surface.plane + 1);
            if surface.material as usize >= self.materials.len() {
                return Err(format!("surface {index}: its material does not exist"));
            }
            if surface.face == u32::MAX {
                return Err(format!("surface {index}: its face has no number"));
            }
            let is_twin = |twin: SurfaceId| {
                let other = self.surfaces.get(twin.index())?;
                Some(twin.index() != index && other.twin.is_some_and(|back| back.index() == index) && other.plane == surface.plane)
            };
            if surface.twin.is_some_and(|twin| is_twin(twin) != Some(true)) {
                return Err(format!("surface {index}: its twin does not exist"));
            }
        }
        if !self.objects.is_valid() || !self.groups.is_valid() {
            return Err("a face is in an object or a group that does not exist".to_owned());
        }
        if count == 0 { Err("there is no surface".to_owned()) } else { Ok(()) }
    }

    /// How many spectral channels there are: 1 for grey, 3 for linear Rec.709 RGB, N for bands.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The materials.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The surfaces.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// The surfaces, to keep them beside the scene.
    pub(crate) fn shared_surfaces(&self) -> Surfaces {
        self.surfaces.clone()
    }

    /// One surface.
    pub fn surface(&self, id: SurfaceId) -> &Surface {
        &self.surfaces[id.index()]
    }

    /// The material of a surface.
    pub fn material_of(&self, id: SurfaceId) -> &Material {
        &self.materials[self.surface(id).material as usize]
    }

    /// The side of a sheet that can be seen from `direction`: the surface itself, its twin, or `None` for a back.
    pub(crate) fn side_towards(&self, id: SurfaceId, direction: DVec3) -> Option<SurfaceId> {
        let surface = self.surface(id);
        if surface.polygon.facet().normal.dot(direction) > 0.0 { Some(id) } else { surface.twin }
    }

    /// The objects that faces of the input belong to; a face is [`Surface::face`].
    pub fn objects(&self) -> &FaceNames {
        &self.objects
    }

    /// The groups that they belong to.
    pub fn groups(&self) -> &FaceNames {
        &self.groups
    }

    /// Which sides of the input faces emit and receive.
    pub fn sides(&self) -> Sides {
        self.sides
    }

    /// The box around all surfaces.
    pub fn bounds(&self) -> Aabb {
        self.surfaces.bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(channels: usize, reflectance: f64, exitance: f64) -> Result<Scene, SceneError> {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let polygon = Polygon::new(&square).expect("a square");
        let (reflectance, exitance) = (vec![reflectance; channels], vec![exitance; channels]);
        let material = Material { name: "a".to_owned(), reflectance, exitance };
        Scene::new(channels, vec![material], vec![(polygon, 0, 0)], Sides::Front)
    }

    #[test]
    fn other_materials_are_checked_like_the_first() {
        let grey = scene(1, 0.5, 1.0).unwrap();
        assert_eq!(grey.with_materials(scene(1, 0.7, 2.0).unwrap().materials), scene(1, 0.7, 2.0));
        let bad = Material { reflectance: vec![1.0], ..grey.materials[0].clone() };
        assert!(matches!(grey.with_materials(vec![bad]), Err(SceneError::BadMaterial { .. })));
        assert_eq!(grey.with_materials(Vec::new()), Err(SceneError::Materials { given: 0, needed: 1 }));
    }

    #[test]
    fn channels_and_brightness_have_a_range() {
        assert_eq!(scene(0, 0.5, 1.0), Err(SceneError::Channels(0)));
        assert!(matches!(scene(1025, 0.5, 1.0), Err(SceneError::Channels(1025))));
        assert!(scene(1024, 0.5, 1.0).is_ok() && scene(1, 0.99, 4e30).is_ok() && scene(1, 0.5, 0.0).is_ok());
        for (reflectance, exitance) in [(0.5, 1e300), (0.5, 1e36), (1.0 - 1e-9, 1e30), (0.5, 1e-200), (0.5, f64::NAN), (1.0, 1.0)] {
            assert!(matches!(scene(1, reflectance, exitance), Err(SceneError::BadMaterial { .. })), "{reflectance} {exitance}");
        }
    }
}
