//! What a leaf receives at least, or at most, where the form factors of groups of its sources are known as well.
//!
//! The form factor to a surface often varies little over a receiver, when those to its elements vary much: what one loses, its neighbour
//! gains. So where a source was replaced by its children, the range of the whole is kept. Groups are nested, and the most that can arrive
//! from one is a concave, piecewise linear function of its form factor: that of its parts, the brightest first, cut off at both ends of the
//! range of the whole. This gives the greatest of the linear program with all these conditions; the least is had in the same way.

use super::rounding::rounding;

/// Which end of the range of a leaf's irradiance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    Least,
    Most,
}

/// A step of a plan, by which the sources of a leaf are put together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// A source: the index of its entry.
    Source(u32),
    /// The range of the form factor to so many of the sources and groups before it.
    Group { members: u32, lower: f64, upper: f64 },
}

/// The plans of all leaves.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Plans {
    /// Where the steps of each node start; one more than there are nodes.
    pub starts: Vec<u32>,
    pub steps: Vec<Step>,
}

/// What is known of a source.
#[derive(Clone, Copy)]
pub(super) struct Range {
    pub lower: f64,
    pub upper: f64,
    pub radiosity: f64,
}

/// More that may come from a source than what it must bring.
#[derive(Clone, Copy)]
struct More {
    entry: u32,
    radiosity: f64,
    form_factor: f64,
}

/// Sources or groups that were put together: what they must bring, and where their entries in the list of what else they may bring start.
struct Part {
    form_factor: f64,
    irradiance: f64,
    start: usize,
}

impl Plans {
    /// The least, or the most, that a node receives. `is_full` says whether its form factors add up to 1, not to 1 at most. Calls `visit`
    /// for each entry with what it gets above its lower bound.
    pub fn irradiance(
        &self,
        node: u32,
        side: Side,
        is_full: bool,
        range: impl Fn(u32) -> Range,
        mut visit: impl FnMut(u32, f64),
    ) -> f64 {
        let steps = &self.steps[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize];
        let widened = rounding(steps.len());
        let (mut parts, mut more): (Vec<Part>, Vec<More>) = (Vec::new(), Vec::new());
        for &step in steps {
            match step {
                Step::Source(entry) => {
                    let Range { lower, upper, radiosity } = range(entry);
                    parts.push(Part { form_factor: lower, irradiance: lower * radiosity, start: more.len() });
                    more.push(More { entry, radiosity, form_factor: (upper - lower).max(0.0) });
                }
                Step::Group { members, lower, upper } => {
                    let mut group = joined(&mut parts, members as usize);
                    sort(&mut more[group.start..], side);

                    // The whole brings no less than its lower bound. Rounding may not make it more than that where the least is asked for.
                    let missing = lower - group.form_factor + if side == Side::Most { widened } else { -widened };
                    take(&mut more, &mut group, missing, &mut visit);
                    truncate(&mut more, group.start, upper - group.form_factor + widened);
                    parts.push(group);
                }
            }
        }

        // All together: up to 1.
        let count = parts.len();
        let mut all = joined(&mut parts, count);
        sort(&mut more[all.start..], side);
        let left = 1.0 - all.form_factor;
        if side == Side::Most {
            take(&mut more, &mut all, left.max(0.0) + widened, &mut visit);
            all.irradiance * (1.0 + widened)
        } else {
            if is_full {
                take(&mut more, &mut all, left - widened, &mut visit);
            }
            all.irradiance * (1.0 - widened)
        }
    }
}

/// Puts the last parts together.
fn joined(parts: &mut Vec<Part>, count: usize) -> Part {
    let members = parts.split_off(parts.len() - count);
    let start = members.first().map_or(0, |part| part.start);
    let sum = |of: fn(&Part) -> f64| members.iter().map(of).sum::<f64>();
    Part { form_factor: sum(|part| part.form_factor), irradiance: sum(|part| part.irradiance), start }
}

/// The brightest first for the most, the dimmest for the least.
fn sort(more: &mut [More], side: Side) {
    more.sort_by(|a, b| {
        let order = a.radiosity.total_cmp(&b.radiosity).then(b.entry.cmp(&a.entry));
        if side == Side::Most { order.reverse() } else { order }
    });
}

/// Gives a part so much more of what it may bring, from the start of the list.
fn take(more: &mut [More], part: &mut Part, mut amount: f64, visit: &mut impl FnMut(u32, f64)) {
    for next in &mut more[part.start..] {
        let taken = next.form_factor.min(amount);
        if taken <= 0.0 {
            if amount <= 0.0 {
                break;
            }
            continue;
        }
        amount -= taken;
        next.form_factor -= taken;
        part.form_factor += taken;
        part.irradiance += taken * next.radiosity;
        visit(next.entry, taken);
    }
}

/// Leaves a part no more than so much to take.
fn truncate(more: &mut Vec<More>, start: usize, amount: f64) {
    let mut left = amount.max(0.0);
    for next in &mut more[start..] {
        next.form_factor = next.form_factor.min(left);
        left -= next.form_factor;
    }
    let mut at = 0;
    more.retain(|next| {
        at += 1;
        at <= start || next.form_factor > 0.0
    });
}
