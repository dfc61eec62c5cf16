//! What a page draws, as arrays: the elements of the lit mesh and all other surfaces, or the elements of the solver.

use crate::mesh::MeshPart;
use crate::solve::Solution;

/// Nodes, elements and triangles; see the format of the page.
#[derive(Default)]
pub(super) struct Geometry {
    /// 3, or 1 for all other channel counts: their mean.
    pub channels: usize,
    pub positions: Vec<f32>,
    pub radiosity: Vec<f32>,
    /// By node, the standard error of the radiosity that is shown, its channels together: the mean over the elements that meet there. Empty where it is not known.
    pub errors: Vec<f32>,
    pub elements: Vec<u32>,
    pub triangles: Vec<u32>,
    pub element_runs: Vec<u32>,
    pub triangle_runs: Vec<u32>,
}

/// The channels that are shown of these numbers: all three, or the mean.
pub(super) fn shown(numbers: &[f64]) -> Vec<f64> {
    if numbers.len() == 3 { numbers.to_vec() } else { vec![numbers.iter().sum::<f64>() / numbers.len() as f64] }
}

/// The standard errors at the nodes of a part: the means over the elements that meet there.
fn errors_at_nodes(part: &MeshPart<'_>) -> Vec<f32> {
    let mut sums = vec![(0.0, 0.0); part.nodes.len()];
    for (nodes, error) in part.elements.iter().zip(&part.standard_errors) {
        nodes.iter().for_each(|&node| {
            let (sum, count) = &mut sums[node as usize];
            (*sum, *count) = (*sum + error, *count + 1.0);
        });
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

impl Geometry {
    /// Of the lit mesh where there is one, with the surfaces that have no elements there; else of the elements of the solver.
    pub fn of(solution: &Solution) -> Self {
        let scene = solution.scene();
        let mut geometry = Self { channels: if scene.channels() == 3 { 3 } else { 1 }, ..Self::default() };
        let Some(mesh) = solution.mesh() else {
            solution.for_each_leaf(|vertices, surface, radiosity| geometry.add_polygon(vertices, surface, radiosity));
            return geometry;
        };

        let mut errors = Vec::new();
        let mut has_elements = vec![false; scene.surfaces().len()];
        for part in mesh.parts(scene) {
            has_elements[part.surface as usize] = true;
            let first = geometry.nodes();
            for (node, radiosity) in part.nodes.iter().zip(part.radiosity.chunks(scene.channels())) {
                geometry.add_node(node, radiosity);
            }
            errors.extend(errors_at_nodes(&part));
            geometry.elements.extend(part.elements.iter().flatten().map(|node| first + node));
            geometry.element_runs.extend([part.surface, part.elements.len() as u32]);
        }

        // What reflects nothing has its exitance everywhere.
        for (number, surface) in scene.surfaces().iter().enumerate().filter(|(number, _)| !has_elements[*number]) {
            let exitance: Vec<f32> = scene.materials()[surface.material as usize].exitance.iter().map(|&e| e as f32).collect();
            let vertices: Vec<[f64; 3]> = surface.polygon.vertices().collect();
            geometry.add_polygon(&vertices, number as u32, &exitance);
        }
        // Of a mean of channels the error is no more than this part of that of all together.
        let part = (geometry.channels as f32 / scene.channels() as f32).sqrt();
        if errors.iter().any(|error: &f32| error.is_finite()) {
            errors.iter_mut().for_each(|error| *error *= part);
            errors.resize(geometry.nodes() as usize, 0.0);
            geometry.errors = errors;
        }
        geometry
    }

    fn nodes(&self) -> u32 {
        (self.positions.len() / 3) as u32
    }

    fn add_node(&mut self, position: &[f64; 3], radiosity: &[f32]) {
        self.positions.extend(position.map(|x| x as f32));
        if self.channels == 3 {
            self.radiosity.extend_from_slice(radiosity);
        } else {
            self.radiosity.push(radiosity.iter().sum::<f32>() / radiosity.len() as f32);
        }
    }

    /// Adds a convex polygon of one radiosity, as a fan of triangles.
    fn add_polygon(&mut self, vertices: &[[f64; 3]], surface: u32, radiosity: &[f32]) {
        let first = self.nodes();
        vertices.iter().for_each(|vertex| self.add_node(vertex, radiosity));
        for corner in 1..vertices.len() as u32 - 1 {
            self.triangles.extend([first, first + corner, first + corner + 1]);
        }
        let count = vertices.len() as u32 - 2;
        let last = self.triangle_runs.len();
        match self.triangle_runs.get(last.wrapping_sub(2)) {
            Some(&of) if of == surface => self.triangle_runs[last - 1] += count,
            _ => self.triangle_runs.extend([surface, count]),
        }
    }
}
