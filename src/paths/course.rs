//! How light paths run.

/// A path of a value goes on with a chance of its weight. At most 1; the less, the longer paths get, and the less noisy: at equal noise 1 takes the
/// least time, by some 10%, in rooms of many reflectances.
const LITTLE: f64 = 1.0;

/// How many paths leave each place, when they end, and how they see emitters on the way.
#[derive(Clone, Copy)]
pub(crate) struct Course {
    pub count: u32,
    /// The least number of bounces.
    pub bounces: u32,
    /// Whether paths go one bounce on from where those of values end.
    pub past_values: bool,
    /// Paths with less weight go on at random.
    pub little: f64,
    /// Whether paths go on from where their first ray arrives on an unresolved surface ([`Grids::is_unresolved`](super::Grids::is_unresolved)), even if those of
    /// values end there: light varies over such a surface, and differs by where it is seen from.
    pub past_unresolved: bool,
    /// Rays to emitters from where a path goes on: one, or about so many if none of them is seen exactly.
    pub vertex_rays: u32,
}

impl Course {
    /// For values: paths with at least so many bounces.
    pub fn of_values(count: u32, bounces: u32, vertex_rays: u32) -> Self {
        Self { count, bounces, past_values: false, little: LITTLE, past_unresolved: false, vertex_rays }
    }

    /// Those of values, and one bounce on from where they end.
    pub fn past_values(count: u32, vertex_rays: u32) -> Self {
        Self { past_values: true, ..Self::of_values(count, 0, vertex_rays) }
    }

    /// Whether emitters are looked for exactly, and a part of the rays is guided by what is seen of them. Light varies much over what paths meet
    /// then, so that cells take no part in Russian roulette.
    pub(super) fn sees_exactly(&self) -> bool {
        self.vertex_rays > 1
    }
}
