//! Light at the vertices of faces.

use glam::DVec3;
use rayon::prelude::*;

use super::Evaluator;
use crate::bake::{BakeError, BakeOptions, VertexLight, points_around, surfaces_of};
use crate::geometry::{sampling, streams};
use crate::progress::Observer;
use crate::scene::{Material, SurfaceId, SurfacePoint};
use crate::sweep::HiddenPoints;

/// The points around a vertex that nothing stands on, with what they weigh.
type Around = Vec<(DVec3, f64)>;

impl Evaluator {
    /// Radiosities at the vertices of surfaces, by [`BakeOptions::only`] of all or some: means over the part of the surface around each vertex, no farther
    /// along its edges than `within` metres. Points on which something stands do not count. `None` if the observer cancels.
    ///
    /// # Errors
    /// See [`BakeError`].
    pub fn bake_vertices(
        &self,
        options: &BakeOptions,
        within: f64,
        observer: &dyn Observer,
    ) -> Result<Option<VertexLight>, BakeError> {
        let scene = self.solution.scene();
        let surfaces = surfaces_of(scene, options)?;

        // Where light is gathered.
        let rays = self.rays();
        let hidden = HiddenPoints::of(scene, &rays);
        let of_surface = |&surface: &SurfaceId| {
            if observer.cancelled() { Vec::new() } else { self.open_points(surface, within, &hidden) }
        };
        let around: Vec<Vec<Around>> = self.pool.install(|| surfaces.par_iter().map(of_surface).collect());
        if observer.cancelled() {
            return Ok(None);
        }
        let mut points: Vec<SurfacePoint> = Vec::new();
        for (&surface, around) in surfaces.iter().zip(&around) {
            let normal = scene.surface(surface).polygon.normal();
            points.extend(around.iter().flatten().map(|(point, _)| SurfacePoint { position: point.to_array(), normal }));
        }
        let Some(values) = self.values_at(&points, observer) else { return Ok(None) };

        // Their means.
        let mut light = VertexLight { surfaces: Vec::new(), radiosity: Vec::new(), points: points.len() as u64, hidden: 0 };
        let mut gathered = values.radiosity.chunks(scene.channels());
        for (&surface, around) in surfaces.iter().zip(&around) {
            light.surfaces.push(surface.0);
            let of_vertex = |around: &Around| {
                mean(gathered.by_ref().take(around.len()).zip(around.iter().map(|(_, weight)| *weight)), scene.channels())
            };
            let means: Vec<Option<Vec<f64>>> = around.iter().map(of_vertex).collect();
            push(&mut light, &means, scene.material_of(surface));
        }
        Ok(Some(light))
    }

    /// For each vertex of a surface the points around it that nothing stands on; none where nothing is reflected.
    fn open_points(&self, surface: SurfaceId, within: f64, hidden: &HiddenPoints<'_>) -> Vec<Around> {
        let scene = self.solution.scene();
        let facet = scene.surface(surface).polygon.facet();
        if !scene.material_of(surface).reflects() {
            return vec![Vec::new(); facet.vertices.len()];
        }
        let seed = sampling::hash(self.solution.options().seed, streams::BAKE_HIDDEN + u64::from(surface.0));
        let of_vertex = |vertex: usize| {
            let all = points_around(&facet, vertex, within);
            let points: Vec<DVec3> = all.iter().map(|of| of.point).collect();
            let is_hidden = hidden.among(surface, &points, sampling::hash(seed, vertex as u64));
            all.iter().zip(is_hidden).filter(|(_, is_hidden)| !is_hidden).map(|(of, _)| (of.point, of.weight)).collect()
        };
        (0..facet.vertices.len()).map(of_vertex).collect()
    }
}

/// Adds the vertices of a surface; those of which nothing is known have the mean of the others, or what the surface emits.
fn push(light: &mut VertexLight, means: &[Option<Vec<f64>>], material: &Material) {
    let known: Vec<&Vec<f64>> = means.iter().flatten().collect();
    let of_others = |channel: usize| match known.len() {
        0 => material.exitance[channel],
        count => known.iter().map(|mean| mean[channel]).sum::<f64>() / count as f64,
    };
    for mean in means {
        light.hidden += u64::from(mean.is_none() && material.reflects());
        let of = |channel: usize| mean.as_ref().map_or_else(|| of_others(channel), |mean| mean[channel]);
        light.radiosity.extend((0..material.exitance.len()).map(|channel| of(channel) as f32));
    }
}

/// The weighted mean of values that are known; `None` if none is.
fn mean<'v>(values: impl Iterator<Item = (&'v [f32], f64)>, channels: usize) -> Option<Vec<f64>> {
    let (mut sums, mut total) = (vec![0.0; channels], 0.0);
    for (value, weight) in values.filter(|(value, _)| !value[0].is_nan()) {
        sums.iter_mut().zip(value).for_each(|(sum, &b)| *sum += weight * f64::from(b));
        total += weight;
    }
    (total > 0.0).then(|| sums.into_iter().map(|sum| sum / total).collect())
}
