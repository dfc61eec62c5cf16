//! What the bounds say about the whole: errors in the usual norms, and on what kind of evidence the light travels.

use serde::Serialize;

use super::conditions::{Condition, conditions};
use super::evidence::{Certainty, Evidence};
use super::form_factors::{BoundedPair, FormFactorBounds};
use super::system::{Iterate, System};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::Scene;

/// How far apart the bounds of one channel are, over all surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ChannelError {
    /// The integral of `upper - lower`, in W.
    pub l1: f64,
    /// The root of the integral of `(upper - lower)^2`, in W/m.
    pub l2: f64,
    /// The largest `upper - lower`, in W/m^2.
    pub l_infinity: f64,
    /// What all surfaces radiate at least, in W.
    pub lower_power: f64,
    /// What all surfaces radiate at most, in W.
    pub upper_power: f64,
}

/// How much of the upper bounds travels over pairs of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EvidenceShare {
    /// What the pairs' bounds rest on.
    pub evidence: Evidence,
    /// How far that can be trusted.
    pub certainty: Certainty,
    /// How many pairs there are.
    pub pairs: u64,
    /// Their part, 0 to 1, of all the power that arrives over pairs at most.
    pub upper_share: f64,
    /// Their part, 0 to 1, of what the pairs leave open: the power at most less that at least.
    pub open_share: f64,
}

/// What the bounds say about the whole.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoundsReport {
    /// The weakest of all pairs; an estimate where a condition could matter.
    pub certainty: Certainty,
    /// What the proof rests on.
    pub conditions: Vec<Condition>,
    /// A bound of the error of any values within the bounds of elements, in the mean over all area, by energy:
    /// `||upper - lower|| / ||lower - E||`. It says nothing of single points, each of which has bounds of its own. Infinite where the
    /// lower bounds prove no reflection.
    pub relative_error: f64,
    /// By channel.
    pub channels: Vec<ChannelError>,
    /// By what the pairs rest on.
    pub evidence: Vec<EvidenceShare>,
    /// The part of the area of all surfaces, 0 to 1, that is proved to see fronts alone.
    pub enclosed_share: f64,
    /// Sweeps over both systems.
    pub sweeps: u32,
}

/// What an iterate says, the last of so many sweeps over the system of `pairs`, which are of nodes of `hierarchy`.
pub(super) fn report(
    (scene, hierarchy): (&Scene, &Hierarchy),
    system: &System<'_>,
    pairs: &[BoundedPair],
    iterate: &Iterate,
    (sweeps, over_links): (u32, bool),
) -> BoundsReport {
    // Norms over the leaves.
    let mut channels = vec![ChannelError::default(); system.channels];
    let (mut area, mut enclosed_area, mut width_sq, mut reflected_sq) = (0.0, 0.0, 0.0, 0.0);
    for leaf in &system.leaves {
        let own_area = hierarchy.area(NodeId(leaf.node));
        area += own_area;
        enclosed_area += if leaf.enclosed { own_area } else { 0.0 };
        for (channel, error) in channels.iter_mut().enumerate() {
            let at = leaf.node as usize * system.channels + channel;
            let (lower, upper) = (iterate.lower[at], iterate.upper[at]);
            error.l1 += own_area * (upper - lower);
            error.l2 += own_area * (upper - lower).powi(2);
            error.l_infinity = error.l_infinity.max(upper - lower);
            error.lower_power += own_area * lower;
            error.upper_power += own_area * upper;
            width_sq += own_area * (upper - lower).powi(2);
            reflected_sq += own_area * (lower - leaf.exitance[channel]).powi(2);
        }
    }
    channels.iter_mut().for_each(|error| error.l2 = error.l2.sqrt());

    let conditions = conditions(scene, over_links);
    BoundsReport {
        certainty: if conditions.iter().any(|condition| condition.could_matter) { Certainty::Estimate } else { weakest(pairs) },
        conditions,
        relative_error: if width_sq == 0.0 { 0.0 } else { (width_sq / reflected_sq).sqrt() },
        channels,
        evidence: evidence_shares((scene, hierarchy), pairs, iterate),
        enclosed_share: enclosed_area / area,
        sweeps,
    }
}

/// How far all pairs over the links of a scene can be trusted together.
pub(super) fn certainty(scene: &Scene, pairs: &[BoundedPair]) -> Certainty {
    if conditions(scene, true).iter().any(|condition| condition.could_matter) { Certainty::Estimate } else { weakest(pairs) }
}

fn weakest(pairs: &[BoundedPair]) -> Certainty {
    pairs.iter().map(|(.., f)| f.certainty).max().unwrap_or(Certainty::Guaranteed)
}

/// Adds up the power that arrives over pairs, channels together, by what their bounds rest on.
fn evidence_shares((scene, hierarchy): (&Scene, &Hierarchy), pairs: &[BoundedPair], iterate: &Iterate) -> Vec<EvidenceShare> {
    // Powers in W, of each kind.
    let channels = scene.channels();
    let mut shares: Vec<EvidenceShare> = Vec::new();
    for &(receiver, source, FormFactorBounds { lower, upper, certainty, evidence }) in pairs {
        let sum = |values: &[f64]| values[source.index() * channels..][..channels].iter().sum::<f64>();
        let area = hierarchy.area(receiver);
        let (most, least) = (area * upper * sum(&iterate.upper), area * lower * sum(&iterate.lower));
        let is_same = |share: &&mut EvidenceShare| (share.evidence, share.certainty) == (evidence, certainty);
        let share = match shares.iter_mut().find(is_same) {
            Some(share) => share,
            None => {
                shares.push(EvidenceShare { evidence, certainty, pairs: 0, upper_share: 0.0, open_share: 0.0 });
                let last = shares.len() - 1;
                &mut shares[last]
            }
        };
        share.pairs += 1;
        share.upper_share += most;
        share.open_share += most - least;
    }

    // Parts of all.
    let total = |of: fn(&EvidenceShare) -> f64| shares.iter().map(of).sum::<f64>().max(f64::MIN_POSITIVE);
    let (upper, open) = (total(|share| share.upper_share), total(|share| share.open_share));
    for share in &mut shares {
        share.upper_share /= upper;
        share.open_share /= open;
    }
    shares.sort_by_key(|share| (share.evidence, share.certainty));
    shares
}
