//! The exact radiosity of the floor, by a method of its own: collocation at the middles of many elements, exact form factors from points,
//! and the shadow of the sheet cut out of every source as each point sees it.

use patchlight::form_factor::point_form_factor;
use patchlight::geometry::Polygon;
use rayon::prelude::*;

use super::configurations::{Configuration, Face};
use crate::triangles::{add, cross, dot, sub, times, unit};

/// Probes of the floor along each side: the middles of as many cells.
pub const PROBES: usize = 128;

/// Elements on each side of the floor and the walls; other faces have elements no larger.
const ELEMENTS: usize = 32;

/// A piece of a face, or a lamp as a whole.
struct Element {
    face: usize,
    middle: [f64; 3],
    polygon: Polygon,
    corners: Vec<[f64; 3]>,
}

/// A scene with the radiosities of its elements.
pub struct Reference {
    faces: Vec<Face>,
    elements: Vec<Element>,
    radiosity: Vec<f64>,
}

impl Reference {
    /// The floor at all probes, row by row along x, and by how much that differs from what half as many elements give, as a part of
    /// the mean.
    pub fn of_floor(configuration: Configuration) -> (Vec<f64>, f64) {
        let fine = Self::new(configuration, ELEMENTS).floor();
        let coarse = Self::new(configuration, ELEMENTS / 2).floor();
        let off: f64 = fine.iter().zip(&coarse).map(|(fine, coarse)| (fine - coarse).abs()).sum();
        let sum: f64 = fine.iter().sum();
        (fine, off / sum)
    }

    fn new(configuration: Configuration, per_side: usize) -> Self {
        let faces = configuration.faces();
        let mut elements = Vec::new();
        for (index, face) in faces.iter().enumerate() {
            let pieces = |side: [f64; 3]| {
                if face.reflectance > 0.0 { (per_side as f64 * dot(side, side).sqrt() - 1e-9).ceil() as usize } else { 1 }
            };
            let (across, along) = (pieces(face.u), pieces(face.v));
            for i in 0..across {
                for j in 0..along {
                    let at = |s: f64, t: f64| {
                        add(
                            face.corner,
                            add(times(face.u, (i as f64 + s) / across as f64), times(face.v, (j as f64 + t) / along as f64)),
                        )
                    };
                    let corners = vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
                    let polygon = Polygon::new(&corners).expect("a rectangle");
                    elements.push(Element { face: index, middle: at(0.5, 0.5), polygon, corners });
                }
            }
        }
        let radiosity = elements.iter().map(|element| faces[element.face].exitance).collect();
        let mut reference = Self { faces, elements, radiosity };

        // All bounces, over rows of exact form factors.
        let row = |element: &Element| {
            if reference.faces[element.face].reflectance > 0.0 { reference.row(element.face, element.middle) } else { Vec::new() }
        };
        let rows: Vec<Vec<f64>> = reference.elements.par_iter().map(row).collect();
        for _ in 0..40 {
            let next = |(element, row): (&Element, &Vec<f64>)| {
                let face = &reference.faces[element.face];
                face.exitance + face.reflectance * row.iter().zip(&reference.radiosity).map(|(f, b)| f * b).sum::<f64>()
            };
            reference.radiosity = reference.elements.iter().zip(&rows).map(next).collect();
        }
        reference
    }

    /// One more gather, at the probes.
    fn floor(&self) -> Vec<f64> {
        let at = |probe: usize| {
            let place = |k: usize| (k as f64 + 0.5) / PROBES as f64;
            let row = self.row(0, [place(probe % PROBES), place(probe / PROBES), 0.0]);
            self.faces[0].reflectance * row.iter().zip(&self.radiosity).map(|(f, b)| f * b).sum::<f64>()
        };
        (0..PROBES * PROBES).into_par_iter().map(at).collect()
    }

    /// The form factors from a point of a face to all elements.
    fn row(&self, face: usize, x: [f64; 3]) -> Vec<f64> {
        let normal = unit(cross(self.faces[face].u, self.faces[face].v));
        let sheet = self.faces.iter().position(|face| face.material == "sheet");
        let of_element = |element: &Element| {
            let whole = point_form_factor(x, normal, &element.polygon);
            let is_on_sheet = |face: usize| self.faces[face].material == "sheet";
            match sheet.filter(|_| whole > 0.0 && !is_on_sheet(face) && !is_on_sheet(element.face)) {
                Some(sheet) => whole - hidden(x, normal, element, &self.faces[sheet]),
                None => whole,
            }
        };
        self.elements.iter().map(of_element).collect()
    }
}

/// The form factor of the part of an element that a sheet hides from x: within the cone over the sheet, and beyond it.
fn hidden(x: [f64; 3], normal: [f64; 3], element: &Element, sheet: &Face) -> f64 {
    let corners = [sheet.corner, add(sheet.corner, sheet.u), add(add(sheet.corner, sheet.u), sheet.v), add(sheet.corner, sheet.v)];
    let sheet_normal = unit(cross(sheet.u, sheet.v));
    let side = dot(sheet_normal, sub(x, sheet.corner)).signum();
    let mut part = element.corners.clone();
    clip(&mut part, sheet.corner, times(sheet_normal, -side));
    for k in 0..4 {
        let inward = cross(sub(corners[k], x), sub(corners[(k + 1) % 4], x));
        clip(&mut part, x, times(inward, -side));
    }
    match Polygon::new(&part) {
        Ok(polygon) => point_form_factor(x, normal, &polygon),
        Err(_) => 0.0,
    }
}

/// Keeps the part of a convex polygon in front of a plane (Sutherland, Hodgman 1974).
fn clip(polygon: &mut Vec<[f64; 3]>, origin: [f64; 3], inward: [f64; 3]) {
    let height = |vertex: [f64; 3]| dot(inward, sub(vertex, origin));
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &vertex) in polygon.iter().enumerate() {
        let before = polygon[(k + polygon.len() - 1) % polygon.len()];
        let (from, to) = (height(before), height(vertex));
        if (from > 0.0) != (to > 0.0) {
            kept.push(add(before, times(sub(vertex, before), from / (from - to))));
        }
        if to > 0.0 {
            kept.push(vertex);
        }
    }
    *polygon = kept;
}
