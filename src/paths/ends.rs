//! Where paths end, and the light that they collected before.
//!
//! # Russian roulette
//! A path of little weight w at a point of a cell with the radiosity C may end there, but C is not the radiosity B at that point. So it goes
//! on with a chance p, and brings
//!
//! ```text
//! w C                            if it ends
//! w C + w (B_sampled - C) / p    if it goes on
//! ```
//!
//! which is w B on average, whatever C is; the closer C is to B, the less noise that adds (Arvo and Kirk 1990, with the cell as control
//! variate). Where the cell has no value, C is 0; and between plates so narrow that emitters are looked for exactly, where a cell's value is the mean of a bright
//! edge and of what lies deep in the dark.

use glam::DVec3;

use super::grids::NO_CELL;
use super::trail::Trail;
use crate::scene::SurfaceId;

/// That of a path whose first ray finds nothing, or what sends nothing.
pub(crate) const NO_SURFACE: u32 = u32::MAX;

/// Where paths end, path after path. A path that ends where its first ray arrives brings the radiosity of the cell there.
#[derive(Default)]
pub(crate) struct Ends {
    /// By path, the cell where its first ray arrives; [`NO_CELL`] if there is none, or if the path went on.
    pub cell: Vec<u32>,
    /// By path, the number of the surface where its first ray arrives; [`NO_SURFACE`] if nothing is brought from there.
    pub surface: Vec<u32>,
    /// By path, the point in that cell, and the form factor of the cell, about.
    pub point: Vec<DVec3>,
    pub form_factor: Vec<f64>,
    /// By path, the weight of its first ray, and of what that finds beside next-event rays: 1 if it is not guided, nor finds what these look for.
    pub first_weight: Vec<f64>,
    /// The paths that went on, in their order.
    pub continued: Vec<Continuation>,
    /// By continuation and channel: it brings `constant + weight * B`, B being the radiosity of the cell where it ends.
    pub constant: Vec<f64>,
    pub weight: Vec<f64>,
    /// By continuation, the weight of its rays and of what they find, which is in that.
    pub guided: Vec<f64>,
    /// By continuation and channel, where emitters are looked for exactly: how much more its variance would be by next-event rays.
    pub next_event: Vec<f64>,
    /// Other cells that continuations bring light of, those of reflectors seen on the way and of Russian roulette.
    pub seen: Vec<SeenOnTheWay>,
    /// By entry of `seen` and channel: it brings `weight * B`, B being the radiosity of the cell.
    pub seen_weight: Vec<f64>,
    /// Where paths of values end, if these here go on from there; by channel the weight with which they do, and the constant that they bring.
    pub value_ends: Vec<ValueEnd>,
    pub value_weight: Vec<f64>,
    pub value_constant: Vec<f64>,
    /// Off what paths are reflected, where somebody asks.
    pub trail: Option<Trail>,
}

/// A path that went on from where its first ray arrived.
pub(crate) struct Continuation {
    pub path: usize,
    /// The cell where it ends.
    pub cell: u32,
    /// The number of its entry in `value_ends`, if there is one by now.
    pub value_end: Option<usize>,
    /// Whether it saw the sky at once, and brings what that sends.
    pub is_of_sky: bool,
}

/// A cell whose light a continuation brings beside that of the one where it ends.
pub(crate) struct SeenOnTheWay {
    pub continuation: usize,
    pub cell: u32,
    /// Whether the path of a value has not ended before.
    pub is_of_value: bool,
}

/// Where the path of a value would end.
pub(crate) struct ValueEnd {
    pub continuation: usize,
    pub cell: u32,
    pub surface: SurfaceId,
    /// How often the path was reflected before.
    pub bounces: u32,
}

/// What a ray finds.
pub(super) enum Arrival {
    /// What sends nothing.
    Nothing,
    /// The sky, or nothing.
    Sky(DVec3),
    /// A cell that is small, and the point of a surface in it.
    Cell(u32, DVec3, SurfaceId),
    /// A point from which the path goes on; with its cell, if that of a value may end there.
    Onward(DVec3, SurfaceId, Option<u32>),
}

impl Ends {
    /// Whether a continuation that arrives in `cell`, if that has a value there, goes on, by a random number in [0, 1): with a weight below `little` it
    /// ends, or goes on with that weight.
    pub(super) fn goes_on(&mut self, continuation: usize, cell: Option<u32>, channels: usize, little: f64, draw: f64) -> bool {
        // Guided rays have little weight where there is much light.
        let own = continuation * channels..(continuation + 1) * channels;
        let left = self.weight[own.clone()].iter().copied().fold(0.0, f64::max) / self.guided[continuation];
        let chance = (left / little).min(1.0);
        if draw >= chance {
            self.continued[continuation].cell = cell.unwrap_or(NO_CELL);
            return false;
        }
        if chance < 1.0 {
            if let Some(cell) = cell {
                self.see(continuation, cell);
                self.seen_weight.extend(self.weight[own.clone()].iter().map(|weight| weight * (1.0 - 1.0 / chance)));
                self.trail.iter_mut().for_each(|trail| trail.see(continuation, 1.0 - 1.0 / chance));
            }
            self.trail.iter_mut().for_each(|trail| trail.weigh(continuation, 1.0 / chance));
            self.weight[own].iter_mut().for_each(|weight| *weight /= chance);
        }
        true
    }

    /// A continuation brings light of a cell that is seen on the way.
    pub(super) fn see(&mut self, continuation: usize, cell: u32) {
        let is_of_value = self.continued[continuation].value_end.is_none();
        self.seen.push(SeenOnTheWay { continuation, cell, is_of_value });
    }

    /// The path of a value ends here; this one goes on.
    pub(super) fn end_value(&mut self, end: ValueEnd, channels: usize) {
        let continuation = end.continuation;
        self.continued[continuation].value_end = Some(self.value_ends.len());
        self.value_ends.push(end);
        let own = continuation * channels..(continuation + 1) * channels;
        self.value_weight.extend_from_slice(&self.weight[own.clone()]);
        self.value_constant.extend_from_slice(&self.constant[own]);
        self.trail.iter_mut().for_each(|trail| trail.end_value(continuation));
    }

    /// Multiplies the weight of a continuation by that of its next ray, or of what this finds.
    #[inline]
    pub(super) fn weigh(&mut self, continuation: usize, channels: usize, weight: f64) {
        if weight == 1.0 {
            return;
        }
        self.guided[continuation] *= weight;
        self.weight[continuation * channels..][..channels].iter_mut().for_each(|left| *left *= weight);
        self.trail.iter_mut().for_each(|trail| trail.weigh(continuation, weight));
    }

    /// Forgets everything, and makes room for so many paths.
    pub(super) fn clear(&mut self, paths: usize) {
        self.cell.clear();
        self.cell.resize(paths, NO_CELL);
        self.surface.clear();
        self.surface.resize(paths, NO_SURFACE);
        self.point.resize(paths, DVec3::ZERO);
        self.form_factor.resize(paths, 0.0);
        self.first_weight.clear();
        self.first_weight.resize(paths, 1.0);
        self.continued.clear();
        self.value_ends.clear();
        self.value_weight.clear();
        self.value_constant.clear();
        self.next_event.clear();
        self.seen.clear();
        self.seen_weight.clear();
        self.trail.iter_mut().for_each(Trail::clear);
    }
}
