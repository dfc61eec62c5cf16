//! How the light of a cell has changed since an earlier bake: a linear function over it, found at few texels.
//!
//! At the texels nearest to its corners and its middle light is gathered anew. A linear function is fitted to what it differs there from the earlier light, and
//! what that leaves tells whether the change is linear. If so, all other texels have their earlier light with the change added.

use glam::DVec3;

use super::lattice::{Cell, Misfit, Notes};
use super::record::Base;
use super::texels::Texels;

/// A change of the light of a cell.
pub(super) struct Change {
    /// Columns and rows of its probes, from which places are counted, in the mean.
    origin: [f64; 2],
    /// By number of a texel: the value there, and how much it grows with column and row.
    planes: Vec<DVec3>,
    /// How far the light at probes is off, as of a single texel. Its noise is that of both bakes.
    pub misfit: Misfit,
}

/// The texels of a cell at which its change is measured; none if the earlier bake does not tell the light of all that have a value.
pub(super) fn probes(cell: Cell, texels: &Texels<'_>, notes: &Notes, base: &Base<'_>) -> Vec<usize> {
    let lit = || cell.texels(texels.columns()).filter(|&(index, _)| texels.sites[index].is_covered());
    if !lit().all(|(index, _)| base.is_of(index, &texels.sites[index], notes.is_marked[index])) {
        return Vec::new();
    }
    let nearest = |[column, row]: [f64; 2]| {
        let distance = |at: [usize; 2]| (at[0] as f64 - column).hypot(at[1] as f64 - row);
        lit().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1))).map(|(index, _)| index)
    };
    let mut probes: Vec<usize> = cell.quincunx().into_iter().filter_map(nearest).collect();
    probes.sort_unstable();
    probes.dedup();
    probes
}

impl Change {
    /// Fitted to gathered `probes`, in the part of the light with this number; `None` if these are too few to judge it by.
    pub fn of(texels: &Texels<'_>, notes: &Notes, (base, part): (&Base<'_>, usize), probes: &[usize]) -> Option<Self> {
        if probes.len() < 2 || !probes.iter().all(|&index| texels.is_known(index)) {
            return None;
        }
        let places: Vec<[f64; 2]> = probes.iter().map(|&index| place(texels, index)).collect();
        let count = probes.len() as f64;
        let origin = [0, 1].map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / count);
        let changes: Vec<Vec<f64>> = probes.iter().map(|&index| differences(texels, index, base.numbers(part, index))).collect();

        // A constant, and a linear function if that leaves something to judge it by.
        let rows: Vec<DVec3> = places.iter().map(|place| DVec3::new(1.0, place[0] - origin[0], place[1] - origin[1])).collect();
        let basis = orthonormal(&rows);
        let basis = if basis.len() < probes.len() { &basis[..] } else { &basis[..1] };
        let mut planes = Vec::with_capacity(texels.numbers());
        let mut left_sq = 0.0;
        for number in 0..texels.numbers() {
            let along = |direction: &DVec3| {
                let projected: f64 = rows.iter().zip(&changes).map(|(row, change)| direction.dot(*row) * change[number]).sum();
                projected * *direction
            };
            let plane: DVec3 = basis.iter().map(along).sum();
            if number < texels.channels() {
                let left = |(row, change): (&DVec3, &Vec<f64>)| (change[number] - plane.dot(*row)).powi(2);
                left_sq += rows.iter().zip(&changes).map(left).sum::<f64>();
            }
            planes.push(plane);
        }
        let mean = |of: &dyn Fn(usize) -> f64| probes.iter().map(|&index| of(index)).sum::<f64>() / count;
        let misfit = Misfit {
            off_sq: left_sq / (probes.len() - basis.len()) as f64,
            noise_sq: 2.0 * mean(&|index| f64::from(notes.noise_sq[index])),
            light_sq: mean(&|index| texels.light_sq(index, texels.reflected_of(index))),
        };
        Some(Self { origin, planes, misfit })
    }

    /// Gives all texels of the cell that have no value yet their earlier light with the change added. Returns their indices.
    pub fn apply(&self, cell: Cell, texels: &mut Texels<'_>, (base, part): (&Base<'_>, usize)) -> Vec<usize> {
        let (columns, channels) = (texels.columns(), texels.channels());
        let wanted: Vec<usize> = cell.texels(columns).map(|(index, _)| index).filter(|&index| texels.is_wanted(index)).collect();
        for &index in &wanted {
            let [column, row] = place(texels, index);
            let at = DVec3::new(1.0, column - self.origin[0], row - self.origin[1]);
            let light =
                base.numbers(part, index).zip(&self.planes).map(|(earlier, plane)| (earlier + plane.dot(at)).max(0.0) as f32);
            let numbers: Vec<f32> = light.collect();
            let (reflected, straight) = numbers.split_at(channels);
            let straight: Vec<f32> = straight.iter().zip(reflected).map(|(straight, all)| straight.min(*all)).collect();
            texels.set(index, reflected, &straight);
        }
        wanted
    }
}

/// Column and row of a texel.
fn place(texels: &Texels<'_>, index: usize) -> [f64; 2] {
    [(index % texels.columns()) as f64, (index / texels.columns()) as f64]
}

/// What the numbers of a texel are more than earlier ones.
fn differences(texels: &Texels<'_>, index: usize, earlier: impl Iterator<Item = f64>) -> Vec<f64> {
    texels.numbers_of(index).iter().zip(earlier).map(|(&now, earlier)| f64::from(now) - earlier).collect()
}

/// Linear functions, as their coefficients for 1, x and y, whose values at the rows are orthonormal: the constant first, and as many as there can be.
fn orthonormal(rows: &[DVec3]) -> Vec<DVec3> {
    // Rows lie whole texels apart, so what is shorter than this is rounding.
    const ROUNDING: f64 = 1e-6;
    let product = |a: DVec3, b: DVec3| rows.iter().map(|row| a.dot(*row) * b.dot(*row)).sum::<f64>();
    let mut basis: Vec<DVec3> = Vec::new();
    for coefficient in [DVec3::X, DVec3::Y, DVec3::Z] {
        let rest = basis.iter().fold(coefficient, |rest, &known| rest - product(coefficient, known) * known);
        let length = product(rest, rest).sqrt();
        if length > ROUNDING {
            basis.push(rest / length);
        }
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_orthonormal_and_no_more_than_places_tell() {
        let at = |x: f64, y: f64| DVec3::new(1.0, x, y);
        let square = [at(-2.0, -3.0), at(2.0, -3.0), at(-2.0, 3.0), at(2.0, 3.0), at(0.0, 0.0)];
        for (rows, count) in [(&square[..], 3), (&square[..2], 2), (&square[..1], 1)] {
            let basis = orthonormal(rows);
            assert_eq!(basis.len(), count);
            for (k, a) in basis.iter().enumerate() {
                for (l, b) in basis.iter().enumerate() {
                    let product: f64 = rows.iter().map(|row| a.dot(*row) * b.dot(*row)).sum();
                    assert!((product - f64::from(u8::from(k == l))).abs() < 1e-12);
                }
            }
        }
    }
}
