//! The surfaces of a scene, and the box around them.

use std::ops::Deref;
use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::on_threads::on_threads_of_caller;
use super::surface::Surface;
use crate::geometry::Aabb;

/// Surfaces that copies of a scene share. Stored as a list.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Surfaces {
    list: Arc<Vec<Surface>>,
    /// Around all of them.
    pub bounds: Aabb,
}

/// The box around a surface is found so fast that fewer of them are not worth another thread.
const BOXES_AT_ONCE: usize = 1024;

impl Surfaces {
    pub fn new(list: Vec<Surface>) -> Self {
        // Both sides of a sheet have the same box.
        let counts = |(index, surface): &(usize, &Surface)| surface.twin.is_none_or(|twin| twin.index() > *index);
        let counted = list.par_iter().with_min_len(BOXES_AT_ONCE).enumerate().filter(counts);
        let bounds = counted.map(|(_, surface)| surface.polygon.bounds()).reduce(|| Aabb::EMPTY, Aabb::union);
        Self { list: Arc::new(list), bounds }
    }

    /// The surfaces, to change all but their polygons; of this copy alone.
    pub fn but_polygons_mut(&mut self) -> &mut [Surface] {
        Arc::<Vec<Surface>>::make_mut(&mut self.list)
    }

    /// The surfaces, taken out, or copied if others share them.
    pub fn take(&mut self) -> Vec<Surface> {
        Arc::unwrap_or_clone(std::mem::take(&mut self.list))
    }
}

impl Default for Surfaces {
    fn default() -> Self {
        Self { list: Arc::default(), bounds: Aabb::EMPTY }
    }
}

impl Deref for Surfaces {
    type Target = [Surface];

    fn deref(&self) -> &[Surface] {
        &self.list
    }
}

impl Serialize for Surfaces {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Vec::serialize(&self.list, serializer)
    }
}

impl<'a> Deserialize<'a> for Surfaces {
    fn deserialize<D: Deserializer<'a>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::deserialize(deserializer).map(|list| on_threads_of_caller(|| Self::new(list)))
    }
}
