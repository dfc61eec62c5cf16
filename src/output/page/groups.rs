//! The light of each group for itself, so that a page can weight it.

use std::io;

use serde_json::{Value, json};

use super::geometry::{Geometry, shown};
use crate::scene::LightWeight;
use crate::solve::Solution;

/// The light of groups as a page has it.
pub(super) struct Groups {
    /// By group, node and shown channel, with the weights in `facts`.
    pub radiosity: Vec<f32>,
    /// Names, weights, exitance by material, and what claims follow from.
    pub facts: Value,
}

impl Groups {
    /// Of a solution; `None` if it has no groups.
    ///
    /// Each group has the weights that it has now, or 1 if it is off: the page multiplies these by factors.
    ///
    /// # Errors
    /// A group alone is out of range.
    pub fn of(solution: &Solution) -> io::Result<Option<Self>> {
        let Some(known) = solution.scene().light_groups() else { return Ok(None) };
        let (mut radiosity, mut groups) = (Vec::new(), Vec::new());
        for (number, name) in known.names().iter().enumerate() {
            let now = known.weights_of(number);
            let is_on = now.iter().any(|&weight| weight > 0.0);
            let weights = if is_on { now.to_vec() } else { vec![1.0; now.len()] };
            let weight_of = |other: usize| if other == number { weights.clone() } else { vec![0.0; weights.len()] };
            let alone = known.names().iter().enumerate();
            let alone: Vec<LightWeight> =
                alone.map(|(other, name)| LightWeight { group: name.clone(), by_band: weight_of(other) }).collect();
            let alone = solution.relit(&alone).map_err(io::Error::other)?;
            radiosity.extend(Geometry::of(&alone).radiosity);
            let exitance: Vec<Vec<f64>> = alone.scene().materials().iter().map(|material| shown(&material.exitance)).collect();
            groups.push(json!({ "name": name, "weights": weights, "factor": u8::from(is_on), "exitance": exitance }));
        }
        let claims = solution.group_claims();
        let claims = claims.map(|claims| json!({ "values": claims.values, "mesh": claims.mesh, "products": claims.products }));
        Ok(Some(Self { radiosity, facts: json!({ "groups": groups, "claims": claims }) }))
    }
}
