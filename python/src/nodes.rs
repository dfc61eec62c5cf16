//! Elements, surfaces and nodes, as arrays.

use std::sync::Arc;

use patchlight::bounds::RadiosityBounds;
use patchlight::hierarchy::NodeId;
use patchlight::scene::{Surface, SurfaceId};
use pyo3::prelude::*;

use crate::arrays::array;
use crate::lit::Lit;

/// Which nodes.
pub enum Which {
    Elements,
    Surfaces,
    All,
}

/// Nodes of a solution, from `Solution.elements`, `.surfaces` and `.nodes`; N of them. Each attribute is a new array. From the solver over
/// cells they are coarse: `solve(scene, solver="links")` refines them.
#[pyclass(frozen, module = "patchlight")]
pub struct Nodes {
    lit: Arc<Lit>,
    nodes: Vec<NodeId>,
}

/// What is told for a cluster, which belongs to no surface.
const NONE: i64 = -1;

type Made<'py> = PyResult<Bound<'py, PyAny>>;

#[pymethods]
impl Nodes {
    fn __len__(&self) -> usize {
        self.nodes.len()
    }

    /// The number of each node: int64 array (N,).
    #[getter]
    fn node<'py>(&self, py: Python<'py>) -> Made<'py> {
        self.whole(py, |node| i64::from(node.0))
    }

    /// The node above: int64 array (N,); the root is its own.
    #[getter]
    fn parent<'py>(&self, py: Python<'py>) -> Made<'py> {
        let hierarchy = self.lit.evaluator()?.solution().hierarchy();
        self.whole(py, |node| i64::from(hierarchy.parent(node).unwrap_or(node).0))
    }

    /// The surface that it is or is a piece of: int64 array (N,); -1 for a cluster.
    #[getter]
    fn surface<'py>(&self, py: Python<'py>) -> Made<'py> {
        let hierarchy = self.lit.evaluator()?.solution().hierarchy();
        self.whole(py, |node| hierarchy.surface_of(node).map_or(NONE, |surface| i64::from(surface.0)))
    }

    /// The face of the input that it comes from: int64 array (N,); -1 for a cluster.
    #[getter]
    fn face<'py>(&self, py: Python<'py>) -> Made<'py> {
        self.of_surface(py, |surface| surface.face)
    }

    /// Its material: int64 array (N,); -1 for a cluster.
    #[getter]
    fn material<'py>(&self, py: Python<'py>) -> Made<'py> {
        self.of_surface(py, |surface| surface.material)
    }

    /// Areas: float64 array (N,) in m^2.
    #[getter]
    fn area<'py>(&self, py: Python<'py>) -> Made<'py> {
        let hierarchy = self.lit.evaluator()?.solution().hierarchy();
        let areas = self.nodes.iter().map(|&node| hierarchy.area(node)).collect();
        array(py, areas, &[self.nodes.len()]).map(Bound::into_any)
    }

    /// Radiosities: float64 array (N, C) in W/m^2.
    #[getter]
    fn radiosity<'py>(&self, py: Python<'py>) -> Made<'py> {
        let radiosity = self.lit.evaluator()?.solution().radiosity();
        self.by_channel(py, |node| radiosity.of(node))
    }

    /// No point of it has less, proved: float64 array (N, C) in W/m^2; None unless solved with bounds="guaranteed".
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.bounds(py, RadiosityBounds::lower)
    }

    /// No point of it has more, proved: as `lower`.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.bounds(py, RadiosityBounds::upper)
    }

    /// How many corners each has: int64 array (N,); 0 for a cluster.
    #[getter]
    fn corner_counts<'py>(&self, py: Python<'py>) -> Made<'py> {
        let hierarchy = self.lit.evaluator()?.solution().hierarchy();
        self.whole(py, |node| hierarchy.polygon(node).len() as i64)
    }

    /// The corners of all, one after another, counter-clockwise: float64 array (corner_counts.sum(), 3) in metres.
    #[getter]
    fn corners<'py>(&self, py: Python<'py>) -> Made<'py> {
        let hierarchy = self.lit.evaluator()?.solution().hierarchy();
        let numbers: Vec<f64> = self.nodes.iter().flat_map(|&node| hierarchy.polygon(node)).flatten().collect();
        let count = numbers.len() / 3;
        array(py, numbers, &[count, 3]).map(Bound::into_any)
    }

    fn __repr__(&self) -> String {
        format!("<patchlight.Nodes: {}>", self.nodes.len())
    }
}

impl Nodes {
    pub fn new(lit: Arc<Lit>, which: Which) -> PyResult<Self> {
        let solution = lit.evaluator()?.solution();
        let hierarchy = solution.hierarchy();
        let nodes = match which {
            Which::Elements => hierarchy.ids().filter(|&node| hierarchy.is_leaf(node)).collect(),
            Which::Surfaces => {
                (0..solution.scene().surfaces().len() as u32).map(|number| hierarchy.node_of(SurfaceId(number))).collect()
            }
            Which::All => hierarchy.ids().collect(),
        };
        Ok(Self { lit, nodes })
    }

    fn whole<'py>(&self, py: Python<'py>, number: impl Fn(NodeId) -> i64) -> Made<'py> {
        let numbers = self.nodes.iter().map(|&node| number(node)).collect();
        array(py, numbers, &[self.nodes.len()]).map(Bound::into_any)
    }

    fn of_surface<'py>(&self, py: Python<'py>, number: fn(&Surface) -> u32) -> Made<'py> {
        let solution = self.lit.evaluator()?.solution();
        let of = |node| solution.hierarchy().surface_of(node).map_or(NONE, |id| i64::from(number(solution.scene().surface(id))));
        self.whole(py, of)
    }

    fn by_channel<'a, 'py>(&self, py: Python<'py>, numbers: impl Fn(NodeId) -> &'a [f64]) -> Made<'py> {
        let channels = self.lit.evaluator()?.solution().scene().channels();
        let all = self.nodes.iter().flat_map(|&node| numbers(node)).copied().collect();
        array(py, all, &[self.nodes.len(), channels]).map(Bound::into_any)
    }

    fn bounds<'py>(
        &self,
        py: Python<'py>,
        side: for<'a> fn(&'a RadiosityBounds, NodeId) -> &'a [f64],
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let bounds = self.lit.evaluator()?.bounds();
        bounds.map(|bounds| self.by_channel(py, |node| side(bounds, node))).transpose()
    }
}
