//! Links, as the arrays of a sparse matrix.

use std::sync::Arc;

use patchlight::links::LinkSet;
use pyo3::prelude::*;

use crate::arrays::array;
use crate::errors::Failure;
use crate::lit::Lit;

/// The links of a solution, L of them, ordered by receiver: a sparse matrix of form factors from receiver (row) to source (column), over
/// nodes. `scipy.sparse.csr_array((links.data, links.indices, links.indptr), shape=links.shape)` takes them as they are. Each attribute
/// is a new array.
#[pyclass(frozen, module = "patchlight")]
pub struct Links {
    lit: Arc<Lit>,
}

type Made<'py> = PyResult<Bound<'py, PyAny>>;

#[pymethods]
impl Links {
    fn __len__(&self) -> PyResult<usize> {
        Ok(self.links()?.len())
    }

    /// Rows and columns: the number of nodes, twice.
    #[getter]
    fn shape(&self) -> PyResult<(usize, usize)> {
        let nodes = self.lit.evaluator()?.solution().hierarchy().len();
        Ok((nodes, nodes))
    }

    /// Form factors from receiver to source, occlusion included: float64 array (L,). Each is an unbiased sample, which may lie below 0.
    #[getter]
    fn data<'py>(&self, py: Python<'py>) -> Made<'py> {
        self.reals(py, |links| links.iter().map(|(_, link)| link.occluded_form_factor()).collect())
    }

    /// The same as if nothing were in between: float64 array (L,).
    #[getter]
    fn unoccluded<'py>(&self, py: Python<'py>) -> Made<'py> {
        self.reals(py, |links| links.iter().map(|(_, link)| link.form_factor).collect())
    }

    /// The node that is gathered from, the column: int array (L,), int32 where that is enough.
    #[getter]
    fn indices<'py>(&self, py: Python<'py>) -> Made<'py> {
        self.wholes(py, self.links()?.iter().map(|(_, link)| i64::from(link.source.0)).collect())
    }

    /// The node that gathers, the row: as `indices`.
    #[getter]
    fn receivers<'py>(&self, py: Python<'py>) -> Made<'py> {
        self.wholes(py, self.links()?.iter().map(|(receiver, _)| i64::from(receiver.0)).collect())
    }

    /// Where the links of each node begin, and the end: int array (N + 1,) of the type of `indices`.
    #[getter]
    fn indptr<'py>(&self, py: Python<'py>) -> Made<'py> {
        let links = self.links()?;
        let ends = self.lit.evaluator()?.solution().hierarchy().ids().scan(0, |end, node| {
            *end += links.of(node).len() as i64;
            Some(*end)
        });
        self.wholes(py, std::iter::once(0).chain(ends).collect())
    }

    fn __repr__(&self) -> PyResult<String> {
        let (nodes, _) = self.shape()?;
        Ok(format!("<patchlight.Links: {} between {nodes} nodes>", self.links()?.len()))
    }
}

impl Links {
    pub fn new(lit: Arc<Lit>) -> Self {
        Self { lit }
    }

    fn links(&self) -> Result<&LinkSet, Failure> {
        Ok(self.lit.evaluator()?.solution().links())
    }

    fn reals<'py>(&self, py: Python<'py>, of: impl Fn(&LinkSet) -> Vec<f64>) -> Made<'py> {
        let links = self.links()?;
        array(py, of(links), &[links.len()]).map(Bound::into_any)
    }

    /// All of one type, as scipy wants them: nodes and links are counted in 32 bits where these suffice.
    fn wholes<'py>(&self, py: Python<'py>, numbers: Vec<i64>) -> Made<'py> {
        let largest = self.links()?.len().max(self.shape()?.0);
        let shape = [numbers.len()];
        if i32::try_from(largest).is_ok() {
            return array(py, numbers.into_iter().map(|number| number as i32).collect(), &shape).map(Bound::into_any);
        }
        array(py, numbers, &shape).map(Bound::into_any)
    }
}
