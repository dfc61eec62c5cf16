//! Radiosity at a point by methods A to D of Lischinski 1994, section 4.3.3 and figure 4.7, to compare with the gather of `over_links`.
//!
//! ```text
//! A:  B(x) = the radiosity of the leaf that x lies on
//! else: B(x) = E + rho sum over links above x of F(x -> s) V B_s,     V by the method
//! ```
//!
//! Lights are seen anew by all but A. The thesis has no clusters; here a cluster as source is all surfaces below it, with the visibility of its link where the method takes that.

use crate::direct::{DirectLight, DirectScratch};
use crate::form_factor::point_to_polygon;
use crate::hierarchy::{Hierarchy, NodeId};
use crate::links::LinkSet;
use crate::paths::{Place, Receives};
use crate::scene::Scene;
use crate::sweep::Radiosity;

/// Where form factors and visibilities at a point come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShadingMethod {
    /// Method A: the radiosity of the leaf.
    Leaf,
    /// Method B: form factors anew, visibility as the links have it.
    FormFactors,
    /// Method C: form factors and visibility anew, all of it exactly.
    Visibility,
    /// Method D: visibility anew, exactly, of emitters; of all else as the links have it.
    EmitterVisibility,
}

/// Rays from a point to lights, and as many to the sky.
const LIGHT_RAYS: u32 = 256;

/// Shades points of a solution.
pub(crate) struct Shading<'a> {
    pub scene: &'a Scene,
    pub hierarchy: &'a Hierarchy,
    pub links: &'a LinkSet,
    pub radiosity: &'a Radiosity,
    /// Tells what is visible; of emitters none.
    pub light: DirectLight<'a>,
    pub method: ShadingMethod,
}

impl Shading<'_> {
    /// The radiosity at a place, by channel, in W/m^2.
    pub fn radiosity_at(&self, place: &Place, scratch: &mut DirectScratch, radiosity: &mut [f64]) {
        let leaf = self.hierarchy.leaf_at(place.surface, place.point);
        if self.method == ShadingMethod::Leaf {
            radiosity.copy_from_slice(self.radiosity.of(leaf));
            return;
        }

        // Irradiance over the links of all nodes above the point.
        radiosity.fill(0.0);
        let mut node = Some(leaf);
        while let Some(above) = node {
            for link in self.links.of(above) {
                self.add(place, link.source, f64::from(link.transmittance), scratch, radiosity);
            }
            node = self.hierarchy.parent(above);
        }
        let (receiver, mut variance) = (place.receiver(self.scene), vec![0.0; radiosity.len()]);
        self.light.add_lights(&receiver, LIGHT_RAYS, scratch, radiosity, &mut variance);
        self.light.add_sky(&receiver, LIGHT_RAYS, scratch, radiosity, &mut variance);
        let material = self.scene.material_of(place.surface);
        for (channel, value) in radiosity.iter_mut().enumerate() {
            *value = material.exitance[channel] + material.reflectance[channel] * *value;
        }
    }

    /// Adds what a source brings whose link has this transmittance; of a cluster all surfaces below it.
    fn add(&self, place: &Place, source: NodeId, transmittance: f64, scratch: &mut DirectScratch, irradiance: &mut [f64]) {
        let Some(surface) = self.hierarchy.surface_of(source) else {
            return self.hierarchy.children(source).for_each(|child| self.add(place, child, transmittance, scratch, irradiance));
        };
        let facet = self.hierarchy.facet(source);
        let receiver = place.receiver(self.scene);
        let is_seen_anew = match self.method {
            ShadingMethod::Leaf | ShadingMethod::FormFactors => false,
            ShadingMethod::Visibility => true,
            ShadingMethod::EmitterVisibility => self.scene.material_of(surface).emits(),
        };
        let form_factor = if is_seen_anew {
            self.light.visible_form_factor(&receiver, facet, self.scene.surface(surface).plane(), scratch)
        } else {
            transmittance * point_to_polygon(place.point, self.scene.surface(place.surface).polygon.facet().normal, &facet)
        };
        irradiance.iter_mut().zip(self.radiosity.of(source)).for_each(|(h, b)| *h += form_factor * b);
    }
}
