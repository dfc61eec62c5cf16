//! Numbers of a solution: figures, and arrays by surfaces, elements, nodes and links.

use std::ffi::c_char;

use patchlight::hierarchy::NodeId;
use patchlight::scene::SurfaceId;
use patchlight::solve::Solution as Lit;

use super::{Known, Solution, patchlight_solution};
use crate::entry::enter;
use crate::handles;
use crate::memory::{Buffer, Out};
use crate::status::{Ending, Outcome, PATCHLIGHT_NOT_AVAILABLE, patchlight_status};

/// A number that tells about a solution. Values may be added; from 100 on they are of the solve, and not there in a solution that was read
/// from a file; one that follows from another has those of its error.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_figure {
    /// Channels.
    PATCHLIGHT_CHANNELS = 1,
    /// Bytes that hierarchy, links and radiosities take.
    PATCHLIGHT_MEMORY_BYTES = 2,
    /// Visibility rays that a value at a point takes.
    PATCHLIGHT_POINT_RAYS = 3,
    /// The error that was asked for.
    PATCHLIGHT_ERROR_REQUESTED = 100,
    /// The error that is claimed for values at points: an upper confidence limit; infinite where nothing was, or can be, estimated.
    PATCHLIGHT_ERROR_ESTIMATE = 101,
    /// The measured error itself.
    PATCHLIGHT_ERROR_MEASURED = 102,
    /// The probability with which the claim holds.
    PATCHLIGHT_ERROR_CONFIDENCE = 103,
    /// The error that is claimed by energy.
    PATCHLIGHT_ERROR_ENERGY = 104,
    /// The error that is claimed locally.
    PATCHLIGHT_ERROR_LOCAL = 105,
    /// The part of the area of reflecting surfaces where light was found.
    PATCHLIGHT_LIT = 106,
    /// A proven bound of the error of values at points; only where bounds were asked for.
    PATCHLIGHT_ERROR_BOUND = 107,
    /// Visibility rays of the solve.
    PATCHLIGHT_RAYS = 108,
    /// 1 if the requested error is reached, else 0.
    PATCHLIGHT_CONVERGED = 109,
    /// The error that is claimed for the mesh, that of the values it was made from included; only where it was asked for.
    PATCHLIGHT_ERROR_MESH = 110,
}

/// What an array of a solution has items for. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_items {
    /// The surfaces of the scene.
    PATCHLIGHT_SURFACES = 1,
    /// The elements: surfaces that were not split, and the smallest pieces of the others.
    PATCHLIGHT_ELEMENTS = 2,
    /// All nodes: clusters, surfaces, elements, and what lies between them, by their numbers.
    PATCHLIGHT_NODES = 3,
    /// The links, by receiver.
    PATCHLIGHT_LINKS = 4,
}

/// A whole number for each item. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_whole {
    /// Of surfaces, elements, nodes: the number of the node.
    PATCHLIGHT_NODE = 1,
    /// The node above; the root is its own.
    PATCHLIGHT_PARENT = 2,
    /// The surface that it is or is a piece of; UINT32_MAX for a cluster.
    PATCHLIGHT_SURFACE = 3,
    /// The face of the input that it comes from; UINT32_MAX for a cluster.
    PATCHLIGHT_FACE = 4,
    /// Its material; UINT32_MAX for a cluster.
    PATCHLIGHT_MATERIAL = 5,
    /// How many corners its polygon has; 0 for a cluster.
    PATCHLIGHT_CORNER_COUNT = 6,
    /// Of links: the node that gathers.
    PATCHLIGHT_RECEIVER = 20,
    /// Of links: the node that is gathered from.
    PATCHLIGHT_SOURCE = 21,
}

/// Real numbers for each item. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_real {
    /// Of surfaces, elements, nodes: radiosity in W/m^2, by channel.
    PATCHLIGHT_RADIOSITY = 1,
    /// No point of it has less, in W/m^2, by channel; where bounds were asked for.
    PATCHLIGHT_LOWER = 2,
    /// No point of it has more.
    PATCHLIGHT_UPPER = 3,
    /// Area in m^2.
    PATCHLIGHT_AREA = 4,
    /// The corners of its polygon, three coordinates each, counter-clockwise; as many as PATCHLIGHT_CORNER_COUNT says.
    PATCHLIGHT_CORNERS = 5,
    /// Of links: the form factor from receiver to source, occlusion included: an unbiased sample.
    PATCHLIGHT_FORM_FACTOR = 20,
    /// Of links: the form factor as if nothing were in between.
    PATCHLIGHT_UNOCCLUDED_FORM_FACTOR = 21,
}

use patchlight_figure::*;
use patchlight_items::*;
use patchlight_real::*;
use patchlight_whole::*;

/// The nodes that are items.
fn nodes(lit: &Lit, items: u32) -> Outcome<Vec<NodeId>> {
    let hierarchy = lit.hierarchy();
    match items {
        _ if items == PATCHLIGHT_SURFACES as u32 => {
            Ok((0..lit.scene().surfaces().len() as u32).map(|surface| hierarchy.node_of(SurfaceId(surface))).collect())
        }
        _ if items == PATCHLIGHT_ELEMENTS as u32 => Ok(hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect()),
        _ if items == PATCHLIGHT_NODES as u32 => Ok(hierarchy.ids().collect()),
        _ => Err(Ending::argument(format_args!("items is {items}, which is no patchlight_items that has this"))),
    }
}

fn no_such(what: u32, name: &str) -> Ending {
    Ending::argument(format_args!("what is {what}, which is no {name} that these items have"))
}

/// A whole number of a node.
fn whole_of(lit: &Lit, what: u32) -> Outcome<impl Fn(NodeId) -> u32> {
    let (hierarchy, scene) = (lit.hierarchy(), lit.scene());
    if !(PATCHLIGHT_NODE as u32..=PATCHLIGHT_CORNER_COUNT as u32).contains(&what) {
        return Err(no_such(what, "patchlight_whole"));
    }
    Ok(move |node: NodeId| {
        let surface = hierarchy.surface_of(node);
        let of_surface = |number: fn(&patchlight::scene::Surface) -> u32| surface.map_or(u32::MAX, |id| number(scene.surface(id)));
        match what {
            _ if what == PATCHLIGHT_NODE as u32 => node.0,
            _ if what == PATCHLIGHT_PARENT as u32 => hierarchy.parent(node).unwrap_or(node).0,
            _ if what == PATCHLIGHT_SURFACE as u32 => surface.map_or(u32::MAX, |id| id.0),
            _ if what == PATCHLIGHT_FACE as u32 => of_surface(|surface| surface.face),
            _ if what == PATCHLIGHT_MATERIAL as u32 => of_surface(|surface| surface.material),
            _ => hierarchy.polygon(node).len() as u32,
        }
    })
}

/// Real numbers of nodes.
fn reals_of(solution: &Solution, what: u32, nodes: &[NodeId]) -> Outcome<Vec<f64>> {
    let lit = solution.evaluator.solution();
    let bounds = || {
        let message = "this solution has no bounds: set the option bounds to guaranteed";
        solution.evaluator.bounds().ok_or_else(|| Ending::new(PATCHLIGHT_NOT_AVAILABLE, message))
    };
    let nodes = nodes.iter().copied();
    Ok(match what {
        _ if what == PATCHLIGHT_RADIOSITY as u32 => nodes.flat_map(|node| lit.radiosity().of(node)).copied().collect(),
        _ if what == PATCHLIGHT_LOWER as u32 => {
            let bounds = bounds()?;
            nodes.flat_map(|node| bounds.lower(node)).copied().collect()
        }
        _ if what == PATCHLIGHT_UPPER as u32 => {
            let bounds = bounds()?;
            nodes.flat_map(|node| bounds.upper(node)).copied().collect()
        }
        _ if what == PATCHLIGHT_AREA as u32 => nodes.map(|node| lit.hierarchy().area(node)).collect(),
        _ if what == PATCHLIGHT_CORNERS as u32 => nodes.flat_map(|node| lit.hierarchy().polygon(node)).flatten().collect(),
        _ => return Err(no_such(what, "patchlight_real")),
    })
}

impl Solution {
    /// A number that tells about the error; `None` if `what` is another.
    fn error_figure(&self, what: u32) -> Option<f64> {
        let error = match &self.known {
            Known::Solved(report) => &report.solve.error,
            Known::Estimated(error) => error,
            Known::Weighted(error) => {
                let is_estimate = [PATCHLIGHT_ERROR_ESTIMATE, PATCHLIGHT_ERROR_ENERGY].iter().any(|&figure| what == figure as u32);
                let is_measured = what == PATCHLIGHT_ERROR_MEASURED as u32;
                return is_estimate.then_some(error.estimate).or(is_measured.then_some(error.measured));
            }
            Known::Nothing => return None,
        };
        Some(match what {
            _ if what == PATCHLIGHT_ERROR_REQUESTED as u32 => error.requested,
            _ if what == PATCHLIGHT_ERROR_ESTIMATE as u32 => error.estimate,
            _ if what == PATCHLIGHT_ERROR_MEASURED as u32 => error.measured,
            _ if what == PATCHLIGHT_ERROR_CONFIDENCE as u32 => error.confidence,
            _ if what == PATCHLIGHT_ERROR_ENERGY as u32 => error.energy.estimate,
            _ if what == PATCHLIGHT_ERROR_LOCAL as u32 => error.local.estimate,
            _ if what == PATCHLIGHT_LIT as u32 => error.lit,
            _ => return None,
        })
    }
}

/// How many items a solution has: `items` is a patchlight_items.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_count(
    solution: *mut patchlight_solution,
    items: u32,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(count, "count")? };
        let lit = solution.evaluator.solution();
        out.set(if items == PATCHLIGHT_LINKS as u32 { lit.links().len() } else { nodes(lit, items)?.len() })
    })
}

/// A whole number for each item: `items` is a patchlight_items, `what` a patchlight_whole.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_get_uint32(
    solution: *mut patchlight_solution,
    items: u32,
    what: u32,
    buffer: *mut u32,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let buffer = unsafe { Buffer::new(buffer, capacity, count)? };
        let lit = solution.evaluator.solution();
        if items != PATCHLIGHT_LINKS as u32 {
            let (nodes, number) = (nodes(lit, items)?, whole_of(lit, what)?);
            return buffer.fill(nodes.len(), nodes.into_iter().map(number));
        }
        let links = lit.links();
        match what {
            _ if what == PATCHLIGHT_RECEIVER as u32 => buffer.fill(links.len(), links.iter().map(|(receiver, _)| receiver.0)),
            _ if what == PATCHLIGHT_SOURCE as u32 => buffer.fill(links.len(), links.iter().map(|(_, link)| link.source.0)),
            _ => Err(no_such(what, "patchlight_whole")),
        }
    })
}

/// Real numbers for each item: `items` is a patchlight_items, `what` a patchlight_real.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_get_double(
    solution: *mut patchlight_solution,
    items: u32,
    what: u32,
    buffer: *mut f64,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let buffer = unsafe { Buffer::new(buffer, capacity, count)? };
        let lit = solution.evaluator.solution();
        if items != PATCHLIGHT_LINKS as u32 {
            return buffer.copy(&reals_of(&solution, what, &nodes(lit, items)?)?);
        }
        let links = lit.links();
        match what {
            _ if what == PATCHLIGHT_FORM_FACTOR as u32 => {
                buffer.fill(links.len(), links.iter().map(|(_, link)| link.occluded_form_factor()))
            }
            _ if what == PATCHLIGHT_UNOCCLUDED_FORM_FACTOR as u32 => {
                buffer.fill(links.len(), links.iter().map(|(_, link)| link.form_factor))
            }
            _ => Err(no_such(what, "patchlight_real")),
        }
    })
}

/// A number that tells about a solution: `what` is a patchlight_figure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_get_figure(
    solution: *mut patchlight_solution,
    what: u32,
    figure: *mut f64,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let out = unsafe { Out::new(figure, "figure")? };
        let lit = solution.evaluator.solution();
        match what {
            _ if what == PATCHLIGHT_CHANNELS as u32 => return out.set(lit.scene().channels() as f64),
            _ if what == PATCHLIGHT_MEMORY_BYTES as u32 => return out.set(lit.memory_bytes() as f64),
            _ if what == PATCHLIGHT_POINT_RAYS as u32 => return out.set(f64::from(lit.point_rays())),
            _ => {}
        }
        if let Some(error) = solution.error_figure(what) {
            return out.set(error);
        }
        let report = &solution.report()?.solve;
        out.set(match what {
            _ if what == PATCHLIGHT_RAYS as u32 => report.counts.rays as f64,
            _ if what == PATCHLIGHT_CONVERGED as u32 => f64::from(u8::from(report.converged)),
            _ if what == PATCHLIGHT_ERROR_MESH as u32 => match &report.lit_mesh {
                Some(mesh) => mesh.whole.estimate,
                None => return Err(Ending::new(PATCHLIGHT_NOT_AVAILABLE, "this solution was not solved with a mesh")),
            },
            _ if what == PATCHLIGHT_ERROR_BOUND as u32 => match &report.bounds {
                Some(bounds) => bounds.relative_error,
                None => return Err(Ending::new(PATCHLIGHT_NOT_AVAILABLE, "this solution has no bounds")),
            },
            _ => return Err(Ending::argument(format_args!("what is {what}, which is no patchlight_figure"))),
        })
    })
}

/// What the solve tells about itself, as JSON: the report of the program, but for what only a program knows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_solution_get_report(
    solution: *mut patchlight_solution,
    buffer: *mut c_char,
    capacity: usize,
    count: *mut usize,
) -> patchlight_status {
    enter(|| {
        let solution = handles::get(solution)?;
        // SAFETY: The contract of the header.
        let buffer = unsafe { Buffer::new(buffer, capacity, count)? };
        buffer.write_text(&solution.report()?.json)
    })
}
