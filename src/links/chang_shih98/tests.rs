//! BottomUpRefine against the same decisions taken from the top with all maxima known, on kernels that are random numbers.

use super::kernels::{Kernel, Table};
use super::refine::refine;
use super::sampled_link::SampledLink;
use super::trees::{Tree, children, ids};
use crate::geometry::{Polygon, sampling};
use crate::hierarchy::{Hierarchy, NodeId};
use crate::scene::{Material, Scene, Sides, SurfaceId};

/// Surfaces of several shapes and sizes: squares, a long one, a triangle, a pentagon.
fn scene() -> Scene {
    let rectangle = |z: f64, x: f64, y: f64| vec![[0.0, 0.0, z], [x, 0.0, z], [x, y, z], [0.0, y, z]];
    let corner = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 5.0).sin_cos();
        [0.4 * cos, 0.4 * sin, 5.0]
    };
    let shapes = [
        rectangle(0.0, 1.0, 1.0),
        rectangle(1.0, 0.8, 0.9),
        rectangle(2.0, 0.5, 0.5),
        rectangle(3.0, 0.1, 0.1),
        rectangle(4.0, 4.0, 0.25),
        (0..5).map(corner).collect(),
        vec![[0.0, 0.0, 6.0], [1.2, 0.0, 6.0], [0.3, 1.1, 6.0]],
    ];
    let material = Material { name: "grey".to_owned(), reflectance: vec![0.5], exitance: vec![0.0] };
    let faces = shapes.iter().enumerate().map(|(face, shape)| (Polygon::new(shape).unwrap(), 0, face as u32));
    Scene::new(1, vec![material], faces.collect(), Sides::Front).unwrap()
}

/// A kernel that is nothing but random: over many powers of ten, at times zero.
fn random_kernel(hierarchy: &Hierarchy, a: NodeId, b: NodeId, seed: u64) -> Kernel {
    let bits = sampling::hash(seed, u64::from(a.0) << 32 | u64::from(b.0));
    let largest = if bits & 7 == 0 { 0.0 } else { 10f64.powf(4.0 * sampling::unit(bits) - 2.0) };
    let unoccluded = hierarchy.area(a) * hierarchy.area(b) * largest;
    Kernel { largest, unoccluded, exchange: 0.5 * unoccluded }
}

/// The smallest elements below a node.
fn elements(hierarchy: &Hierarchy, node: NodeId) -> Vec<NodeId> {
    if hierarchy.is_leaf(node) {
        return vec![node];
    }
    hierarchy.children(node).flat_map(|child| elements(hierarchy, child)).collect()
}

/// The decisions of sections 3.3 and 3.4 from the top down, with the maxima of all elements known.
struct FromTheTop<'a> {
    hierarchy: &'a Hierarchy,
    bottom: &'a Table,
    tolerance: f64,
    links: Vec<(NodeId, NodeId)>,
}

impl FromTheTop<'_> {
    fn is_within(&self, a: NodeId, b: NodeId) -> bool {
        let below = elements(self.hierarchy, b);
        let pairs = elements(self.hierarchy, a).into_iter().flat_map(|first| below.iter().map(move |&second| (first, second)));
        let largest = pairs.map(|(first, second)| self.bottom.at(first, second).largest).fold(0.0, f64::max);
        let (to_a, to_b) = (largest * self.hierarchy.area(b), largest * self.hierarchy.area(a));
        to_a < self.tolerance && to_b < self.tolerance
    }

    /// `heights` are those of the nodes above the smallest elements.
    fn visit(&mut self, a: NodeId, b: NodeId, heights: [usize; 2]) {
        let linked = heights == [0, 0] || self.is_within(a, b);
        if linked {
            self.links.push((a, b));
            return;
        }
        // The higher one alone, or both: first the larger one, then the other.
        let (of_a, of_b) = (ids(&children(self.hierarchy, a)), ids(&children(self.hierarchy, b)));
        match heights {
            [high, low] if high > low => of_a.for_each(|child| self.visit(child, b, [high - 1, low])),
            [low, high] if high > low => of_b.for_each(|child| self.visit(a, child, [low, high - 1])),
            [height, _] => {
                let larger_second = self.hierarchy.area(b) > self.hierarchy.area(a);
                let below = [height - 1; 2];
                if larger_second {
                    for child in of_b {
                        if self.is_within(a, child) {
                            self.links.push((a, child));
                        } else {
                            ids(&children(self.hierarchy, a)).for_each(|other| self.visit(other, child, below));
                        }
                    }
                } else {
                    for child in of_a {
                        if self.is_within(child, b) {
                            self.links.push((child, b));
                        } else {
                            ids(&children(self.hierarchy, b)).for_each(|other| self.visit(child, other, below));
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn bottom_up_links_what_is_right_from_the_top_and_every_pair_once() {
    let scene = scene();
    let mut hierarchy = Hierarchy::new(&scene);
    let trees: Vec<Tree> = (0..scene.surfaces().len() as u32)
        .map(|surface| {
            let root = hierarchy.node_of(SurfaceId(surface));
            Tree::complete(&mut hierarchy, root, 1.0 / 64.0)
        })
        .collect();
    let tops: Vec<usize> = trees.iter().map(Tree::top).collect();
    assert_eq!((tops[0], tops[1], tops[2], tops[3]), (3, 2, 2, 0));

    let mut above_the_bottom = 0;
    for (index, first) in trees.iter().enumerate() {
        for second in &trees[index + 1..] {
            for (seed, tolerance) in [(1, 1e-9), (2, 0.01), (3, 0.1), (4, 1.0), (5, 10.0), (6, 1e9)] {
                let bottom = Table::new(first.level(0), second.level(0), |a, b| {
                    let spread = random_kernel(&hierarchy, a, b, seed);
                    // Larger in one corner, so that levels mix.
                    let near = f64::from(a.0 - first.level(0).start + b.0 - second.level(0).start + 1);
                    Kernel { largest: spread.largest / near, ..spread }
                });
                let links = refine(&hierarchy, first, second, bottom.clone(), tolerance);

                // The same links.
                let mut reference = FromTheTop { hierarchy: &hierarchy, bottom: &bottom, tolerance, links: Vec::new() };
                reference.visit(first.root(), second.root(), [first.top(), second.top()]);
                let mut found: Vec<(NodeId, NodeId)> = links.iter().map(|link| (link.first, link.second)).collect();
                found.sort_unstable();
                reference.links.sort_unstable();
                assert_eq!(found, reference.links, "tolerance {tolerance}");

                // Every pair of elements once, and sums of what is below.
                let mut covered = 0;
                for SampledLink { first, second, kernel } in links {
                    let pairs = elements(&hierarchy, first)
                        .into_iter()
                        .flat_map(|a| elements(&hierarchy, second).into_iter().map(move |b| (a, b)));
                    let below: Vec<Kernel> = pairs.map(|(a, b)| bottom.at(a, b)).collect();
                    covered += below.len() as u64;
                    above_the_bottom += usize::from(below.len() > 1);
                    let sum: f64 = below.iter().map(|kernel| kernel.exchange).sum();
                    assert!((kernel.exchange - sum).abs() <= 1e-12 * sum, "{} instead of {sum}", kernel.exchange);
                }
                assert_eq!(covered, first.elements() * second.elements());
            }
        }
    }
    assert!(above_the_bottom > 1000, "{above_the_bottom}");
}

#[test]
fn a_tree_is_complete_and_as_deep_as_its_smallest_element_allows() {
    let scene = scene();
    let mut hierarchy = Hierarchy::new(&scene);
    for surface in 0..scene.surfaces().len() as u32 {
        let root = hierarchy.node_of(SurfaceId(surface));
        let min_area = 1.0 / 256.0;
        let tree = Tree::complete(&mut hierarchy, root, min_area);
        assert_eq!(tree.root(), root);
        for level in 1..=tree.top() {
            let below: Vec<NodeId> = ids(tree.level(level)).flat_map(|node| hierarchy.children(node)).collect();
            assert_eq!(below, ids(tree.level(level - 1)).collect::<Vec<_>>());
        }
        let areas: Vec<f64> = ids(tree.level(0)).map(|node| hierarchy.area(node)).collect();
        let smallest = areas.iter().copied().fold(f64::INFINITY, f64::min);
        let is_whole = tree.top() == 0;
        assert!(is_whole || smallest >= 0.999 * min_area, "{smallest}");
        assert!(smallest < 5.0 * 1.1 * min_area, "surface {surface} could be split once more: {smallest}");
    }
    assert_eq!(hierarchy.children(hierarchy.node_of(SurfaceId(0))).len(), 4);
}
