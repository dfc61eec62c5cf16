//! The rows of cell radiosities as they are kept to be solved again for other materials: what their paths bring, with reflectances and emission left
//! open.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::assemble::{Positions, starts};
use super::equations::BATCH;
use super::positions::sampled_positions;
use super::radiosity::CellRadiosities;
use super::stored_system::StoredSystem;
use super::view_points::{Arrival, view_point_count, view_points};
use crate::geometry::{sampling, streams};
use crate::paths::{BatchSums, Brought, LightPaths, PathScratch, Place, ProductNumbers, RowTerm, Terms, Trail, UNREFLECTED};
use crate::progress::Stop;
use crate::scene::{EmissionApart, Scene};

/// The material of a cell that has no value anywhere.
const NO_MATERIAL: u32 = u32::MAX;

/// Rows of all cells: without the reflectance at the cell itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StoredRows {
    /// By cell.
    material: Vec<u32>,
    /// Radiosities of the cells where paths end.
    ends: Terms,
    /// Those of other cells, see [`Brought::Seen`].
    seen: Terms,
    /// Light that is collected on the way, and at view points.
    emission: Terms,
}

/// Scene and numbers that rows are solved with.
pub(crate) struct RowMaterials<'a> {
    pub scene: &'a Scene,
    /// By product and channel.
    pub products: &'a [f64],
    /// By source of emission and channel.
    pub emission: &'a [f64],
    /// By material: whether next-event estimation brings its emission.
    pub is_sampled: &'a [bool],
}

/// The terms of a batch of cells, rows counted from its first cell.
#[derive(Default)]
struct BatchTerms {
    steps: Vec<[u32; 2]>,
    ends: Vec<RowTerm>,
    seen: Vec<RowTerm>,
    emission: Vec<RowTerm>,
}

impl BatchTerms {
    fn add(&mut self, row: usize, product: u32, what: Brought, weight: f64) {
        let (terms, source) = match what {
            Brought::End(cell) => (&mut self.ends, cell),
            Brought::Seen(cell) => (&mut self.seen, cell),
            Brought::Emission(source) => (&mut self.emission, source),
        };
        terms.push(RowTerm { row: row as u32, product, source, weight });
    }

    /// Casts so many next-event rays from each of the starts, of which each cell has `of_cell`, and adds their mean.
    fn add_next_event(
        &mut self,
        paths: &LightPaths<'_>,
        apart: &EmissionApart,
        (cells, starts): (&[usize], &[Place]),
        (of_cell, rays): (usize, u32),
        scratch: &mut PathScratch,
    ) {
        let (channels, part) = (paths.scene.channels(), 1.0 / of_cell as f64);
        let mut irradiance = vec![0.0; starts.len() * channels];
        paths.add_next_event(starts, of_cell, rays, scratch, &mut BatchSums::whole(channels, &mut irradiance));
        for (number, irradiance) in irradiance.chunks(channels).enumerate() {
            for (source, weight) in apart.sources_of(irradiance) {
                self.add(cells[number / of_cell], UNREFLECTED, Brought::Emission(source), part * weight);
            }
        }
        for seen in &scratch.seen {
            self.add(cells[seen.by / of_cell], UNREFLECTED, Brought::Seen(seen.cell), part * seen.weight);
        }
    }
}

impl StoredRows {
    /// Records the rows that [`CellRadiosities::solve`] solves, with the same random numbers; the scene of `paths` keeps emission apart. `None` if
    /// stopped before.
    pub fn record(
        paths: &LightPaths<'_>,
        apart: &EmissionApart,
        (rays, seed): (u32, u64),
        numbers: &mut ProductNumbers,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let cells = sampled_positions(paths, seed, stop);
        let count = rays as usize;

        // Paths.
        let follow = |scratch: &mut PathScratch, batch| -> (BatchTerms, Vec<Arrival>) {
            if stop() {
                return Default::default();
            }
            let from = Positions::of(batch, paths, count);
            scratch.ends.keep_trail(Trail::new(apart));
            from.follow(seed, scratch);
            let mut terms = BatchTerms::default();
            scratch.ends.for_each_term(count, |term| {
                terms.add(from.cells[term.path / count], term.product, term.what, term.weight / count as f64);
            });
            terms.steps = scratch.ends.trail.take().map(|trail| trail.steps).unwrap_or_default();
            (terms, from.arrivals(&scratch.ends, &cells))
        };
        let (mut batches, arrivals): (Vec<BatchTerms>, Vec<Vec<Arrival>>) =
            cells.par_chunks(BATCH).map_init(PathScratch::default, follow).unzip();
        if stop() {
            return None;
        }

        // Next-event estimation from view points.
        let of_cell = view_point_count(count);
        let points = view_points(cells.len(), of_cell, arrivals, sampling::hash(seed, streams::VIEW_POINTS));
        let all = batches.par_iter_mut().zip(cells.par_chunks(BATCH)).zip(points.par_chunks(BATCH));
        all.for_each_init(PathScratch::default, |scratch, ((terms, batch), points)| {
            if !stop() {
                let from = Positions::of(batch, paths, count);
                let starts = starts(paths, (&from.cells, &from.places), points, of_cell);
                terms.add_next_event(paths, apart, (&from.cells, &starts), (of_cell, count.div_ceil(of_cell) as u32), scratch);
            }
        });
        if stop() {
            return None;
        }

        // All rows.
        let material = |place: &Option<Place>| place.map_or(NO_MATERIAL, |place| paths.scene.surface(place.surface).material);
        let material = cells.iter().map(material).collect();
        let [ends, seen, emission] = [(); 3].map(|()| Terms::default());
        let mut rows = Self { material, ends, seen, emission };
        for (batch, of_batch) in batches.iter_mut().zip(cells.chunks(BATCH)) {
            let (numbers, count) = (numbers.of_trail(&batch.steps), of_batch.len());
            rows.ends.append(count, &mut batch.ends, &numbers);
            rows.seen.append(count, &mut batch.seen, &numbers);
            rows.emission.append(count, &mut batch.emission, &numbers);
        }
        Some(rows)
    }

    /// The radiosities of all cells with these materials; `None` if stopped before.
    pub fn solve(&self, with: &RowMaterials<'_>, stop: Stop<'_>) -> Option<CellRadiosities> {
        let channels = with.scene.channels();
        let mut system = StoredSystem::filled(channels, self.material.len(), |row, system| {
            let number = self.material[row] as usize;
            let Some(material) = with.scene.materials().get(number) else { return };

            // What the row begins with: the exitance that rays do not bring, and light that is collected.
            self.emission.add_row(row, with.products, with.emission, system.constant());
            for (channel, constant) in system.constant().iter_mut().enumerate() {
                let own = if with.is_sampled[number] { 0.0 } else { material.exitance[channel] };
                *constant = own + material.reflectance[channel] * *constant;
            }

            // What it takes from other cells.
            let mut add = |terms: &Terms| {
                for (product, cell, weight) in terms.row(row) {
                    let product = &with.products[product as usize * channels..][..channels];
                    let weights = product.iter().zip(&material.reflectance);
                    system.push(cell, weights.map(|(product, rho)| (rho * f64::from(weight) * product) as f32));
                }
                system.terms()
            };
            let of_ends = add(&self.ends);
            add(&self.seen);
            system.limit_seen(of_ends);
        });
        Some(CellRadiosities::of_values(channels, &system.solved(stop)?))
    }

    /// How many cells there are.
    pub fn cells(&self) -> usize {
        self.material.len()
    }

    /// How many terms there are.
    pub fn terms(&self) -> usize {
        self.ends.len() + self.seen.len() + self.emission.len()
    }

    /// Bytes that this takes.
    pub fn memory_bytes(&self) -> u64 {
        let terms = self.ends.memory_bytes() + self.seen.memory_bytes() + self.emission.memory_bytes();
        terms + size_of_val(&*self.material) as u64
    }

    /// Whether it fits a scene, so many cells and so many products.
    pub fn is_valid(&self, scene: &Scene, cells: usize, products: usize) -> bool {
        let materials = scene.materials().len();
        let is_material = |&material: &u32| material == NO_MATERIAL || (material as usize) < materials;
        self.material.len() == cells
            && self.material.iter().all(is_material)
            && self.ends.are_valid(cells, products, cells)
            && self.seen.are_valid(cells, products, cells)
            && self.emission.are_valid(cells, products, scene.emission_sources())
    }
}
