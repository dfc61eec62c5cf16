//! How links are made: the default, and the strategies of the papers.

mod chang_shih98;
mod error_driven;
mod holzschuch94;

pub(super) use error_driven::ErrorSearch;

use std::collections::HashMap;

use super::linked::Linked;
use super::options::Strategy;
use super::plan::Plan;
use crate::links::RefineEnd;

/// Makes links as finely as is planned by now, by the strategy that the options name, and finds the radiosities over them.
pub(super) fn advance(linked: &mut Linked<'_>, plan: &Plan, search: &mut ErrorSearch) -> RefineEnd {
    let strategy = linked.job.options.strategy;
    if linked.job.is_late() {
        return RefineEnd::Stopped;
    }
    linked.begin_round();
    if strategy.links_once() {
        return chang_shih98::link_once(linked);
    }
    if strategy.links_surfaces() {
        return holzschuch94::bounce(linked, plan);
    }
    let ended = match strategy {
        Strategy::ErrorDriven => search.refine_by_error(linked, plan),
        _ => refine_in_steps(linked, plan),
    };
    linked.regather_leaves(plan.leaf_rays());
    ended
}

/// Refines to the tolerances of a round, one after the other, each with the brightness that the one before has found.
fn refine_in_steps(linked: &mut Linked<'_>, plan: &Plan) -> RefineEnd {
    for tolerance in plan.tolerances() {
        let ended = linked.refine_and_sweep(&*plan.oracle(tolerance), &HashMap::new());
        if ended != RefineEnd::Content {
            return ended;
        }
    }
    RefineEnd::Content
}
