//! Elements that are refined until the function on them is as good as asked for.
//!
//! In each element the function is held against the light at a random point. That tells which elements are expected to make up most of the error
//! (`expected`); they are bisected, round by round, until little is left.
//!
//! That says too little: an element is left alone because nothing was found in it. So the function is then judged at points that are spread anew
//! over all that counts, independent of all that it was made by, and what they find is refined in turn, whichever of its parts is too large (`remedy`).

use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::element;
use super::expected::expected_errors_sq;
use super::growing::{Growing, Test};
use super::judged::{Judged, Norm};
use super::light::{Light, LightScratch};
use super::limits::MeshLimits;
use super::noise::noise_scales;
use super::remedy::{Asked, NOISIEST, Remedy};
use super::spots::{Spot, by_weight, by_weight_and_surplus};
use crate::error::ErrorNorm;
use crate::geometry::{sampling, streams};
use crate::paths::{Place, place_at};
use crate::progress::Stop;

/// Rounds at most.
const ROUNDS: u32 = 32;

/// Gathers at a node at most, a power of two: the noise is a quarter of that of one then. One has the noise of a value whose error is what the solve was
/// asked for, so more are wanted only where much less is asked for than that.
pub(super) const MOST_GATHERS: u32 = 16;

/// A node is taken to weigh at least this part of the mean on its surface: others read the function there as well.
const LEAST_SIZE: f64 = 1.0 / 16.0;

/// A node takes at most so many times the rays of the light.
const MOST_RAYS: f64 = 16.0;

/// Places that a thread takes together.
const BATCH: usize = 64;

/// What elements are grown by.
pub(super) struct Grower<'a> {
    pub light: &'a dyn Light,
    pub channels: usize,
    /// The first so many of them decide.
    pub deciding: usize,
    pub seed: u64,
    /// The largest error that may be claimed, and in which norm.
    pub error: f64,
    pub norm: ErrorNorm,
    /// What a node weighs that takes the rays of the light, where heavier ones take more; `None` if all take as many.
    pub size: Option<f64>,
    /// The part of the squared error that is not left to noise of nodes.
    pub followed: f64,
    /// Whether nodes are taken where nothing is seen as well: others read the function there.
    pub takes_all: bool,
    /// Whether light is smooth and its nodes are noisy, so that each is fitted to those around it.
    pub fits: bool,
    /// Points at which the function is judged at first.
    pub judged_at: usize,
    /// Gathers at a node at most: a power of two, 1 where light has no noise.
    pub most_gathers: u32,
    pub limits: &'a MeshLimits<'a>,
    /// Told how many elements there are.
    pub tell: &'a (dyn Fn(u64) + Sync),
    pub stop: Stop<'a>,
}

/// A place where light is wanted, and by how many times its rays.
#[derive(Clone, Copy)]
struct Wanted {
    place: Place,
    rays: f64,
}

impl Grower<'_> {
    /// Refines the elements of all surfaces together; `None` if stopped.
    pub fn grow(&self, all: &mut [Growing]) -> Option<Judged> {
        let (mut judged, mut rounds, mut left_before, mut judged_at) = (None, self.limits.begin(), f64::INFINITY, self.judged_at);
        let (mut followed_before, asked) = (f64::INFINITY, Asked { error: self.error, has_noise: self.has_noise() });
        for round in 0..ROUNDS {
            self.take_nodes(all)?;
            self.test_changed(all, round)?;
            let Some(norm) = Norm::of(self.norm, all) else { return Some(Judged::DARK) };
            let (mut expected, left) = expected_errors_sq(all, &norm);
            let followed = self.followed * self.error.powi(2);
            let mut remedy = Some(Remedy::bisect(left, followed));
            // What does not fall is noise, or had not been found.
            judged = None;
            let is_steady = left >= std::mem::replace(&mut left_before, left);
            if is_steady || left <= followed {
                let found = self.judge(all, (judged_at, round), &norm)?;
                (expected, _) = expected_errors_sq(all, &norm);
                remedy = asked.remedy(&found, judged_at, std::mem::replace(&mut followed_before, found.followed_sq()));
                judged = Some(found);
            }
            let Some(remedy) = remedy else { break };
            let elements: usize = all.iter().map(|of| of.triangles.triangles.len()).sum();
            (self.tell)(elements as u64);
            if round + 1 == ROUNDS || !rounds.may_go_on(elements) {
                break;
            }
            match remedy {
                Remedy::Bisect(part) => {
                    let worst = worst(expected, part, all.len());
                    all.par_iter_mut().zip(worst).for_each(|(of, worst)| of.refine(&worst));
                }
                Remedy::Gather => {
                    followed_before = f64::INFINITY;
                    if !self.want_gathers(all, &norm) {
                        break;
                    }
                }
                Remedy::Judge(count) => (judged_at, left_before, followed_before) = (count, 0.0, f64::INFINITY),
            }
        }
        match judged {
            Some(judged) => Some(judged),
            None => self.judge(all, (judged_at, ROUNDS), &Norm::of(self.norm, all)?),
        }
    }

    /// Whether more gathers lower the noise of nodes.
    fn has_noise(&self) -> bool {
        self.most_gathers > 1
    }

    /// Has the nodes of surfaces that make up most of the noise take twice the gathers, those first whose rays take most of it; whether there are any
    /// that may.
    fn want_gathers(&self, all: &mut [Growing], norm: &Norm) -> bool {
        let noise_and_rays = |of: &Growing| {
            let rays = of.node_sizes().into_iter().map(|size| self.rays(size)).sum::<f64>();
            [norm.noise_sq(of), rays * f64::from(of.wanted_gathers)]
        };
        let may_take_more = all.iter().enumerate().filter(|(_, of)| of.wanted_gathers < self.most_gathers);
        let mut noisy: Vec<(usize, [f64; 2])> = may_take_more.map(|(index, of)| (index, noise_and_rays(of))).collect();
        noisy.sort_by(|(_, a), (_, b)| (b[0] * a[1]).total_cmp(&(a[0] * b[1])));
        let (wanted, mut found) = (NOISIEST * noisy.iter().map(|(_, of)| of[0]).sum::<f64>(), 0.0);
        for (index, [noise_sq, _]) in &noisy {
            if found >= wanted {
                break;
            }
            found += noise_sq;
            all[*index].wanted_gathers *= 2;
        }
        found > 0.0
    }

    /// Takes the light at nodes by as many gathers as are wanted on their surface: those that they lack. Where nodes get more, elements are tested anew.
    /// `None` if stopped.
    fn take_nodes(&self, all: &mut [Growing]) -> Option<()> {
        // Gather by gather, numbered at each node.
        let mut wanted = Vec::new();
        for (index, of) in all.iter_mut().enumerate() {
            of.begin_gathers(self.channels);
            let (sizes, least) = (of.node_sizes(), LEAST_SIZE * of.size());
            for (number, (node, has)) in of.triangles.nodes.iter().zip(&of.gathers).enumerate() {
                let size = sizes[number];
                if size == 0.0 && !self.takes_all {
                    continue;
                }
                let rays = self.rays(size.max(least));
                let point = of.plane.to_space(node.sampled_at);
                let place = |gather: u32| place_at(point, of.surface, sampling::hash(self.seed, u64::from(gather)));
                wanted.extend((*has..of.wanted_gathers).map(|gather| (index, number, Wanted { place: place(gather), rays })));
            }
        }
        let places: Vec<Wanted> = wanted.iter().map(|of| of.2).collect();
        let taken = self.take(&places, |light, _, _, found| found.extend_from_slice(light))?;

        // Means of all gathers, and their variances.
        for ((index, node, _), light) in wanted.iter().zip(taken.chunks(self.channels)) {
            all[*index].add_gather(*node, light);
        }
        if self.fits {
            all.par_iter_mut().filter(|_| !(self.stop)()).for_each(Growing::fit);
        }
        (!(self.stop)()).then_some(())
    }

    /// Tests elements that have changed; `None` if stopped.
    fn test_changed(&self, all: &mut [Growing], round: u32) -> Option<()> {
        let mut spots = Vec::new();
        for (index, of) in all.iter_mut().enumerate() {
            of.is_tested.resize(of.triangles.triangles.len(), false);
            let seed = sampling::hash(self.seed, streams::MESH_TESTS + of.surface.index() as u64);
            let is_new = |triangle: &usize| !of.is_tested[*triangle] && of.weight(*triangle as u32) > 0.0;
            let draw = |triangle: usize| sampling::hash(sampling::hash(seed, u64::from(round)), triangle as u64);
            let new = (0..of.is_tested.len()).filter(is_new);
            spots.extend(new.map(|triangle| Spot::new((index, of), triangle as u32, draw(triangle))));
            of.is_tested.fill(true);
        }
        let wanted = self.wanted(all, &spots, 0);
        let tests = self.take(&wanted, |light, number, scratch, tests| {
            let Spot { index, triangle, at, .. } = spots[number];
            let light_sq = self.light.all_sq(&wanted[number].place, scratch, light);
            tests.push(all[index].test(triangle, at, light, light_sq));
        })?;
        tests.into_iter().zip(&spots).for_each(|(test, spot)| all[spot.index].tests.push(test));
        Some(())
    }

    /// Holds the function against the light at so many points spread over all that counts, one in each of as many strata; the elements keep these tests.
    fn judge(&self, all: &mut [Growing], (count, round): (usize, u32), norm: &Norm) -> Option<Judged> {
        let seed = sampling::hash(self.seed, streams::MESH_JUDGED + u64::from(round));
        let whole: f64 = all.iter().map(Growing::whole).sum();
        let (spots, parts) = Spot::spread(all, count, seed, &by_weight_and_surplus(all, norm));

        // A place takes more rays the more it stands for.
        let mean_part = whole / count as f64;
        let judged = |stream: u64| {
            let mut wanted = self.wanted(all, &spots, stream);
            wanted.iter_mut().zip(&parts).for_each(|(wanted, part)| wanted.rays = (part / mean_part).sqrt());
            wanted
        };
        let wanted = judged(0);
        let first = self.take(&wanted, |light, number, scratch, found| {
            found.push((light.to_vec(), self.light.all_sq(&wanted[number].place, scratch, light)));
        })?;

        // Twice where there is noise. Of what seems to have none, noise would count as an error.
        let is_noisy = |number: &usize| first[*number].0.iter().any(|[_, variance]| *variance > 0.0);
        let noisy: Vec<usize> = (0..spots.len()).filter(is_noisy).collect();
        let again = judged(streams::MESH_AGAIN);
        let again: Vec<Wanted> = noisy.iter().map(|&number| again[number]).collect();
        let taken = self.take(&again, |light, _, _, found| found.push(light.to_vec()))?;
        let mut second: Vec<&[[f64; 2]]> = first.iter().map(|(light, _)| &**light).collect();
        noisy.into_iter().zip(&taken).for_each(|(number, light)| second[number] = light);

        // How much noise there is: in what is judged here, and in all nodes.
        if self.has_noise() {
            let told = |number: usize| {
                let weight = parts[number] * norm.weight(first[number].1);
                let pairs = || first[number].0.iter().zip(second[number]).take(self.deciding);
                let differences: f64 = pairs().map(|(first, second)| (first[0] - second[0]).powi(2)).sum();
                let variances: f64 = pairs().map(|(first, second)| first[1] + second[1]).sum();
                (spots[number].index, [0.5 * weight * differences, 0.5 * weight * variances])
            };
            let points: Vec<(usize, [f64; 2])> = (0..spots.len()).map(told).collect();
            let scales = noise_scales(&points, all.len());
            all.iter_mut().zip(scales).for_each(|(of, scale)| of.scale_noise(scale));
        }

        let found = spots.iter().zip(&parts).zip(&first).zip(second).map(|(((spot, part), (light, light_sq)), second)| {
            let &Spot { index, triangle, at, .. } = spot;
            let errors_sq = all[index].sampled_errors_sq(triangle, at, [light, second]);
            (all[index].test(triangle, at, light, *light_sq), *part, errors_sq)
        });
        let found: Vec<(Test, f64, Vec<f64>)> = found.collect();
        let judged = Judged::by(&found, whole, norm);
        found.into_iter().zip(&spots).for_each(|((test, ..), spot)| all[spot.index].tests.push(test));
        Some(judged)
    }

    /// The squared noise of the function, in the norm, by what two gathers at so many of its nodes differ by; and the same as their variances tell it.
    /// `None` where all is dark, or if stopped.
    pub fn sampled_noise_sq(&self, all: &[Growing], count: usize) -> Option<[f64; 2]> {
        // A node of the element at each of as many points, by what it adds to the noise there.
        let seed = sampling::hash(self.seed, streams::MESH_PILOT);
        let whole: f64 = all.iter().map(Growing::whole).sum();
        let (spots, _) = Spot::spread(all, count, seed, &by_weight(all));
        let at_node = |spot: &Spot| Spot { at: element::sampled_node(sampling::unit(sampling::hash(seed, spot.draw))), ..*spot };
        let spots: Vec<Spot> = spots.iter().map(at_node).collect();

        let (wanted, again) = (self.wanted(all, &spots, 0), self.wanted(all, &spots, streams::MESH_AGAIN));
        let second = self.take(&again, |light, _, _, found| found.push(light.to_vec()))?;
        let found: Vec<[f64; 3]> = self.take(&wanted, |light, number, scratch, found| {
            let pairs = || light.iter().zip(&second[number]).take(self.deciding);
            let differences: f64 = pairs().map(|(first, second)| (first[0] - second[0]).powi(2)).sum();
            let told: f64 = pairs().map(|(first, second)| first[1] + second[1]).sum();
            found.push([self.light.all_sq(&wanted[number].place, scratch, light), 0.5 * differences, 0.5 * told]);
        })?;
        let of_each = whole / count as f64;
        let lit = found.iter().filter(|[light_sq, ..]| *light_sq > 0.0).map(|&[light_sq, ..]| (light_sq, of_each));
        let norm = Norm::by_light(self.norm, lit.collect())?;
        let sum = |which: usize| element::NOISE * found.iter().map(|of| of_each * norm.weight(of[0]) * of[which]).sum::<f64>();
        Some([sum(1), sum(2)])
    }

    /// How many times its rays the light of a node takes that weighs so much.
    fn rays(&self, size: f64) -> f64 {
        // The variance of the whole is least for all rays if these go with the root of what a node stands for.
        self.size.map_or(1.0, |mean| (size / mean).sqrt().min(MOST_RAYS))
    }

    /// Where light is wanted at some points; `stream` picks the random numbers.
    fn wanted(&self, all: &[Growing], spots: &[Spot], stream: u64) -> Vec<Wanted> {
        let means: Vec<f64> = all.iter().map(Growing::size).collect();
        let size = |spot: &Spot| all[spot.index].size_in(spot.triangle).unwrap_or(means[spot.index]);
        let size = |spot: &Spot| size(spot).max(LEAST_SIZE * means[spot.index]);
        let wanted = |spot: &Spot| {
            let of = &all[spot.index];
            let point = element::point_at(of.triangles.corners(spot.triangle), spot.at);
            let place = place_at(of.plane.to_space(point), of.surface, sampling::hash(self.seed, stream));
            Wanted { place, rays: self.rays(size(spot)) }
        };
        spots.iter().map(wanted).collect()
    }

    /// Takes the light at places, in parallel; `make` turns what is found at each, by channel, into results, which are returned in the order of the
    /// places; `None` if stopped.
    fn take<R: Send + Serialize + DeserializeOwned>(
        &self,
        wanted: &[Wanted],
        make: impl Fn(&[[f64; 2]], usize, &mut LightScratch, &mut Vec<R>) + Sync,
    ) -> Option<Vec<R>> {
        let share = self.light.share();
        let batches = wanted.par_chunks(BATCH).enumerate().map_init(LightScratch::default, |scratch, (batch, wanted)| {
            let (mut results, mut light) = (Vec::new(), vec![[0.0; 2]; self.channels]);
            if !share.has(batch) {
                return Some(results);
            }
            for (number, Wanted { place, rays }) in wanted.iter().enumerate() {
                if (self.stop)() {
                    return None;
                }
                self.light.take(place, *rays, scratch, &mut light);
                make(&light, batch * BATCH + number, scratch, &mut results);
            }
            Some(results)
        });
        let mut batches: Vec<Vec<R>> = batches.collect::<Option<_>>()?;
        share.exchange(&mut batches);
        Some(batches.into_iter().flatten().collect())
    }
}

/// By surface, the triangles that are expected to make up some part of the squared error: those with most of it.
fn worst(expected: Vec<(f64, usize, u32)>, part: f64, surfaces: usize) -> Vec<Vec<u32>> {
    let wanted = part * expected.iter().map(|of| of.0).sum::<f64>();
    let (mut worst, mut found) = (vec![Vec::new(); surfaces], 0.0);
    for (error_sq, number, triangle) in expected {
        if found >= wanted {
            break;
        }
        found += error_sq;
        worst[number].push(triangle);
    }
    worst
}
