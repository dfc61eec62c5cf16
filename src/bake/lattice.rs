//! The lattice: which texels are gathered, and which lie between others closely enough.
//!
//! A cell is a rectangle of texels between four of them. At its nodes (corners, middles of edges, centre) values are gathered, and those at the middles
//! are compared with the bilinear function of the corners. If that is good enough, its quarters are interpolated from the nodes: where the light has a
//! second derivative, they are off by a quarter of what was found. Else each quarter is a cell of its own.
//!
//! Cells that something stands on, that a line of the scene's shape crosses, or that are not wholly covered are cut down to single texels.

use glam::DVec2;

use super::texels::Texels;

/// The side of the first cells, as a part of the side of a square with the area of all charts: as the largest cells of the irradiance cache. Larger ones
/// gather less where all is smooth, and find less of what is small.
const FIRST_CELL: f64 = 1.0 / 32.0;

/// No side of a first cell has less texels than this: from there on every second one is gathered whatever is found.
const LEAST_SIDE: usize = 4;

/// A misfit is true if it is so many standard deviations above what noise makes.
const SIGMAS: f64 = 2.0;

/// Nodes of a cell that are compared with its corners, and the standard deviation of the mean of as many squares of noise, as a part of that mean.
const MIDDLES: [usize; 5] = [1, 3, 4, 5, 7];
const SPREAD: f64 = 0.632; // (2 / 5)^(1/2)

/// A rectangle between four texels of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    /// The number of the chart.
    pub chart: usize,
    /// Columns and rows of its corners.
    from: [usize; 2],
    to: [usize; 2],
}

/// What is known of the texels of a chart besides their values.
pub(super) struct Notes {
    /// The squared standard error of a gathered value, channels added.
    pub noise_sq: Vec<f32>,
    /// Texels that a line of the scene's shape crosses.
    pub is_marked: Vec<bool>,
}

/// The first cells' side in texels.
pub(super) fn first_side(texels: &[Texels<'_>]) -> usize {
    let count: usize = texels.iter().map(|texels| texels.sites.len()).sum();
    ((FIRST_CELL * (count as f64).sqrt()) as usize).max(LEAST_SIDE)
}

impl Misfit {
    /// How much of it is no noise, at the least.
    pub fn true_sq(&self) -> f64 {
        self.off_sq - (1.0 + SIGMAS * SPREAD) * self.noise_sq
    }
}

/// How far the nodes in the middle of a cell are off the bilinear function of its corners, squared, channels added: the mean over them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Misfit {
    pub off_sq: f64,
    /// What of that the noise of the values makes.
    pub noise_sq: f64,
    /// The reflected light.
    pub light_sq: f64,
}

/// The first cells of a chart, of about so many texels a side.
pub(super) fn first_cells(chart: usize, size: [usize; 2], side: usize) -> Vec<Cell> {
    let [columns, rows] = size.map(|count| steps(count, side));
    rows.iter()
        .flat_map(|&[top, bottom]| columns.iter().map(move |&[left, right]| Cell { chart, from: [left, top], to: [right, bottom] }))
        .collect()
}

/// Even steps from the first to the last of so many texels.
fn steps(count: usize, side: usize) -> Vec<[usize; 2]> {
    let (length, pieces) = (count - 1, (count - 1).div_ceil(side).max(1));
    (0..pieces).map(|k| [k * length / pieces, (k + 1) * length / pieces]).collect()
}

impl Cell {
    /// The first, the middle and the last column or row; the same ones repeat where there are fewer.
    fn lines(&self, axis: usize) -> [usize; 3] {
        [self.from[axis], (self.from[axis] + self.to[axis]) / 2, self.to[axis]]
    }

    /// The texels at its nodes, row after row.
    pub fn nodes(&self, columns: usize) -> [usize; 9] {
        let (across, down) = (self.lines(0), self.lines(1));
        std::array::from_fn(|k| down[k / 3] * columns + across[k % 3])
    }

    /// Its quarters that have texels between their corners.
    pub fn quarters(self) -> impl Iterator<Item = Self> {
        let (across, down) = (self.lines(0), self.lines(1));
        let quarter = move |k: usize| {
            let (i, j) = (k % 2, k / 2);
            Self { from: [across[i], down[j]], to: [across[i + 1], down[j + 1]], ..self }
        };
        let is_new = |cell: &Self| [0, 1].iter().any(|&axis| cell.to[axis] > cell.from[axis] + 1);
        (0..4).map(quarter).filter(is_new)
    }

    /// Columns and rows of its corners and of its middle.
    pub fn quincunx(&self) -> [[f64; 2]; 5] {
        let [[left, top], [right, bottom]] = [self.from, self.to].map(|corner| corner.map(|at| at as f64));
        [[left, top], [right, top], [0.5 * (left + right), 0.5 * (top + bottom)], [left, bottom], [right, bottom]]
    }

    /// The texels within, corners included, with column and row.
    pub fn texels(self, columns: usize) -> impl Iterator<Item = (usize, [usize; 2])> {
        let [[left, top], [right, bottom]] = [self.from, self.to];
        (top..=bottom).flat_map(move |row| (left..=right).map(move |column| (row * columns + column, [column, row])))
    }

    /// Whether values between its nodes may be taken from these.
    pub fn is_plain(&self, texels: &Texels<'_>, notes: &Notes) -> bool {
        let is_whole = |index: usize| texels.sites[index].is_covered() && !notes.is_marked[index];
        self.texels(texels.columns()).all(|(index, _)| is_whole(index))
    }

    /// How well the corners tell the other nodes. Nodes that fall together with corners are not off.
    pub fn misfit(&self, texels: &Texels<'_>, notes: &Notes) -> Misfit {
        let nodes = self.nodes(texels.columns());
        let corners = [nodes[0], nodes[2], nodes[6], nodes[8]];
        let mut misfit = Misfit { off_sq: 0.0, noise_sq: 0.0, light_sq: 0.0 };
        for node in MIDDLES {
            let weights = bilinear(self.part(0, node % 3), self.part(1, node / 3));
            for channel in 0..texels.channels() {
                let value = |index: usize| f64::from(texels.reflected_of(index)[channel]);
                let told: f64 = corners.iter().zip(weights).map(|(&corner, weight)| weight * value(corner)).sum();
                let own = value(nodes[node]);
                misfit.off_sq += (own - told).powi(2);
            }
            misfit.light_sq += texels.light_sq(nodes[node], texels.reflected_of(nodes[node]));
            // Noise that is not known counts as none: all that is found is then taken for true.
            let noise_sq = |index: usize| f64::from(notes.noise_sq[index]);
            let of_corners: f64 = corners.iter().zip(weights).map(|(&corner, weight)| weight * weight * noise_sq(corner)).sum();
            if !corners.contains(&nodes[node]) {
                misfit.noise_sq += noise_sq(nodes[node]) + of_corners;
            }
        }
        let share = 1.0 / MIDDLES.len() as f64;
        Misfit { off_sq: share * misfit.off_sq, noise_sq: share * misfit.noise_sq, light_sq: share * misfit.light_sq }
    }

    /// Where a line lies between the first and the last one.
    fn part(&self, axis: usize, line: usize) -> f64 {
        let length = (self.to[axis] - self.from[axis]) as f64;
        if length > 0.0 { (self.lines(axis)[line] - self.from[axis]) as f64 / length } else { 0.0 }
    }

    /// Interpolates the texels that have no value yet as far as nodes are known: by quarters from all of them, or from the corners alone. Returns how many.
    pub fn interpolate_known(&self, texels: &mut Texels<'_>) -> usize {
        let nodes = self.nodes(texels.columns());
        let are_known = |texels: &Texels<'_>, nodes: &[usize]| nodes.iter().all(|&node| texels.is_known(node));
        if are_known(texels, &nodes) {
            return self.interpolate(texels).len();
        }
        let corners = [nodes[0], nodes[2], nodes[6], nodes[8]];
        if !are_known(texels, &corners) {
            return 0;
        }
        let (columns, channels) = (texels.columns(), texels.channels());
        let wanted: Vec<(usize, [usize; 2])> = self.texels(columns).filter(|&(index, _)| texels.is_wanted(index)).collect();
        for &(index, [column, row]) in &wanted {
            let part = |at: usize, axis: usize| (at - self.from[axis]) as f64 / (self.to[axis] - self.from[axis]).max(1) as f64;
            let numbers = between(texels, corners, bilinear(part(column, 0), part(row, 1)));
            texels.set(index, &numbers[..channels], &numbers[channels..]);
        }
        wanted.len()
    }

    /// Interpolates the texels that have no value yet, each quarter from its corners. Returns their indices.
    pub fn interpolate(&self, texels: &mut Texels<'_>) -> Vec<usize> {
        let (columns, channels) = (texels.columns(), texels.channels());
        let (across, down, nodes) = (self.lines(0), self.lines(1), self.nodes(columns));
        let mut filled = Vec::new();
        for (index, [column, row]) in self.texels(columns) {
            if !texels.is_wanted(index) {
                continue;
            }
            let (i, j) = (usize::from(column > across[1]), usize::from(row > down[1]));
            let part = |at: usize, from: usize, to: usize| if to > from { (at - from) as f64 / (to - from) as f64 } else { 0.0 };
            let weights = bilinear(part(column, across[i], across[i + 1]), part(row, down[j], down[j + 1]));
            let corners = [0, 1, 3, 4].map(|corner| nodes[3 * j + i + corner]);
            let numbers = between(texels, corners, weights);
            texels.set(index, &numbers[..channels], &numbers[channels..]);
            filled.push(index);
        }
        filled
    }
}

/// The numbers of some texels, weighted.
fn between(texels: &Texels<'_>, corners: [usize; 4], weights: [f64; 4]) -> Vec<f32> {
    let of = |corner: usize, k: usize| f64::from(texels.numbers_of(corner)[k]);
    let sum = |k: usize| corners.iter().zip(weights).map(|(&corner, weight)| weight * of(corner, k)).sum::<f64>();
    (0..texels.numbers()).map(|k| sum(k) as f32).collect()
}

/// The weights of the corners of a rectangle, row after row, at a place within it.
pub(super) fn bilinear(x: f64, y: f64) -> [f64; 4] {
    [(1.0 - x) * (1.0 - y), x * (1.0 - y), (1.0 - x) * y, x * y]
}

impl Notes {
    /// Of a chart, on which there are `lines` from point to point, in texels. What runs along its border parts nothing.
    pub fn new(texels: &Texels<'_>, lines: impl Iterator<Item = [DVec2; 2]>) -> Self {
        let [columns, rows] = texels.chart.size();
        let mut is_marked = vec![false; columns * rows];
        let mut mark = |at: DVec2| {
            if at.cmpge(DVec2::ONE).all() && at.x < columns as f64 - 1.0 && at.y < rows as f64 - 1.0 {
                is_marked[at.y as usize * columns + at.x as usize] = true;
            }
        };
        for [from, to] in lines {
            // Half a texel at a time, all texels whose middles are within about one of the line.
            let steps = (2.0 * from.distance(to)).ceil().max(1.0) as usize;
            for step in 0..=steps {
                let at = from.lerp(to, step as f64 / steps as f64);
                [[-0.5, -0.5], [0.5, -0.5], [-0.5, 0.5], [0.5, 0.5]].iter().for_each(|&aside| mark(at + DVec2::from(aside)));
            }
        }
        Self { noise_sq: vec![0.0; columns * rows], is_marked }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_a_chart_and_their_quarters_end_in_single_texels() {
        for size in [[1, 1], [2, 1], [1, 9], [17, 30], [64, 5]] {
            let mut is_node = vec![false; size[0] * size[1]];
            let mut cells = first_cells(0, size, 8);
            while !cells.is_empty() {
                cells.iter().for_each(|cell| cell.nodes(size[0]).iter().for_each(|&node| is_node[node] = true));
                cells = cells.into_iter().flat_map(Cell::quarters).collect();
            }
            assert!(is_node.iter().all(|&is_node| is_node), "{size:?}");
        }
    }

    #[test]
    fn weights_add_up_and_a_corner_is_itself() {
        assert_eq!(bilinear(1.0, 0.0), [0.0, 1.0, 0.0, 0.0]);
        assert!((bilinear(0.3, 0.6).iter().sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
