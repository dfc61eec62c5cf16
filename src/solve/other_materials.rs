//! Solving again for other materials, over what a solve has stored of its paths and links.

use std::sync::Arc;

use thiserror::Error;

use super::finish::error_report;
use super::linked::MAX_SWEEPS;
use super::report::{ErrorReport, TransportReport};
use super::solution::Solution;
use crate::progress::{Observer, Stop};
use crate::scene::{Material, Scene, SceneError};
use crate::sweep::{self, Closure, Irradiance, Radiosity, Reflection};

/// Why a solution cannot be solved again for other materials.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum OtherMaterialsError {
    /// It was solved without [`SolveOptions::keep_transport`](super::SolveOptions::keep_transport).
    #[error("the solution has no stored transport: solve the scene with --keep-transport")]
    NoTransport,
    /// The materials are out of range, or more or fewer than those that were solved.
    #[error(transparent)]
    Materials(#[from] SceneError),
    /// Nothing was followed from surfaces of this material.
    #[error(
        "material '{0}' reflected nothing as it was solved, and no path goes on from it: solve the scene anew, or store the transport of a scene in \
         which it reflects a little"
    )]
    NotFollowed(String),
    /// Surfaces were dark, so that elements have no links from them.
    #[error(
        "light comes from surfaces that sent none as they were solved, and what elements get of it is not stored: solve the scene anew"
    )]
    WasDark,
    /// Radiosities are larger than can be stored.
    #[error("with these materials it is too bright: radiosities are larger than 3.4e38 W/m^2")]
    TooBright,
}

impl Solution {
    /// What is stored to solve again for other materials, where it was solved with
    /// [`SolveOptions::keep_transport`](super::SolveOptions::keep_transport).
    pub fn transport(&self) -> Option<TransportReport> {
        self.transport.as_ref().map(|transport| transport.report())
    }

    /// The same surfaces of other materials, in the order of [`Scene::materials`], solved again over the stored transport, without a ray; and the error
    /// that is claimed for it, found anew over the stored paths of the error estimate. `None` if the observer cancels.
    ///
    /// What was asked for is [`SolveOptions::error`](super::SolveOptions::error), as before; nothing is refined, so the claim may lie above that: the less
    /// alike the materials are to those that were solved, the more. A claim holds with its probability for each choice of materials, but not for many of
    /// them independently: they have all random numbers in common. Standard errors of single values are not known.
    ///
    /// # Errors
    /// [`OtherMaterialsError`]; the solution itself is never changed.
    pub fn with_materials(
        &self,
        materials: Vec<Material>,
        observer: &dyn Observer,
    ) -> Result<Option<(Self, ErrorReport)>, OtherMaterialsError> {
        let transport = self.transport.as_ref().ok_or(OtherMaterialsError::NoTransport)?;
        let is_anew = |(number, material): &(usize, &Material)| {
            let reflects = material.reflectance.iter().any(|&rho| rho > 0.0);
            !transport.follows(*number) && (reflects || (material.emits() && !self.scene.emitted_as_solved(*number)))
        };
        if let Some((_, material)) = materials.iter().enumerate().take(self.scene.materials().len()).find(is_anew) {
            return Err(OtherMaterialsError::NotFollowed(material.name.clone()));
        }
        let scene = self.scene.with_materials_after_solve(materials)?;
        let stop = || observer.cancelled();

        // Elements, over the links.
        let radiosity = self.swept_again(&scene, &stop);
        if self.dormant_pair_is_lit(&radiosity) {
            return Err(OtherMaterialsError::WasDark);
        }

        // Cells, and the error of values over them.
        let Some((cells, error)) = transport.solve(&scene, self.options.norm.into(), &stop) else { return Ok(None) };
        if stop() {
            return Ok(None);
        }
        if !radiosity.is_in_range() || !cells.is_valid(cells.cells(), scene.channels()) {
            return Err(OtherMaterialsError::TooBright);
        }
        let error = ErrorReport { requested: self.options.error, ..error_report(Some(&error)) };
        let solution = Self {
            scene,
            options: self.options.clone(),
            hierarchy: self.hierarchy.clone(),
            links: self.links.clone(),
            exposure: self.exposure.clone(),
            lights: self.lights.clone(),
            radiosity,
            point_rays: self.point_rays,
            vertex_rays: self.vertex_rays,
            resolution: self.resolution,
            spots: self.spots.clone(),
            cell_radiosities: Some(cells),
            error_bars: None,
            bounds: None,
            mesh: None,
            groups: None,
            transport: Some(Arc::clone(transport)),
        };
        Ok(Some((solution, error)))
    }

    /// The radiosities over the links with the materials of another scene of the same surfaces.
    fn swept_again(&self, scene: &Scene, stop: Stop<'_>) -> Radiosity {
        let Self { hierarchy, links, exposure, lights, options, .. } = self;
        let closure = Closure::needed(scene, hierarchy, links, exposure, self.links_clusters());
        let reflection = Reflection { scene, closure: closure.as_ref(), lights };
        let (mut radiosity, mut previous) = (self.radiosity.clone(), f64::INFINITY);
        let mut irradiance = Irradiance::default();
        for _ in 0..MAX_SWEEPS {
            sweep::gather_into(&mut irradiance, hierarchy, links, exposure, &radiosity);
            let change = sweep::push_pull(&reflection, hierarchy, exposure, &mut irradiance, &mut radiosity);
            let to_come = change.estimate_to_come(previous);
            previous = change.largest;
            if to_come <= options.links.sweep_tolerance * change.brightest || !change.largest.is_finite() || stop() {
                break;
            }
        }
        radiosity
    }

    /// Whether clusters gather and emit.
    fn links_clusters(&self) -> bool {
        let is_cluster = |node| self.hierarchy.is_cluster(node);
        self.links.iter().any(|(receiver, link)| is_cluster(receiver) || is_cluster(link.source))
    }

    /// Whether there is a pair that has no link because its source was dark, and has light now.
    fn dormant_pair_is_lit(&self, radiosity: &Radiosity) -> bool {
        let clusters = self.links_clusters();
        let in_the_dark = self.links.dormant().iter().filter(|pair| pair.receiver != pair.source || !clusters);
        in_the_dark.map(|pair| pair.source).any(|source| radiosity.of(source).iter().any(|&b| b > 0.0))
    }
}
