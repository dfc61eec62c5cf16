//! Link reduction (Holzschuch, Sillion, Drettakis 1994, section 4): whether refining has told anything.
//!
//! Form factors to and from the children of a node that add up to what was known, and hardly differ among each other, are no news: the link
//! is better kept as it is. That depends on geometry alone, so the decision holds for good. It is only taken where all is visible.

/// A child that a node would have if it were split.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Child {
    /// In m^2.
    pub area: f64,
    /// `A F` with the other node, in m^2; `None` if one is behind the other.
    pub exchange: Option<f64>,
}

/// Whether the form factors of the children differ from each other, or their sum from what was known, by more than the part `tolerance`
/// (eps_reduce). `exchange` is that of the whole node, in m^2.
///
/// The paper's four conditions: with the exchange symmetric, the two of sums are the same one, divided by either area.
pub(super) fn is_worth_refining(exchange: f64, children: &[Child], tolerance: f64) -> bool {
    let of = |child: &Child| child.exchange.unwrap_or(0.0);
    let varies = |values: &dyn Fn(&Child) -> f64| {
        let least = children.iter().map(values).fold(f64::INFINITY, f64::min);
        let most = children.iter().map(values).fold(0.0, f64::max);
        most - least > tolerance * most
    };
    let sum: f64 = children.iter().map(of).sum();
    varies(&|child| of(child) / child.area) || varies(&of) || (sum - exchange).abs() > tolerance * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_of_the_four_conditions_asks_for_refinement() {
        let quarter = |exchange| Child { area: 0.25, exchange: Some(exchange) };
        let alike = [quarter(1.0), quarter(1.0), quarter(0.95), quarter(1.05)];
        assert!(!is_worth_refining(4.0, &alike, 0.1));
        assert!(is_worth_refining(4.0, &alike, 0.09));
        assert!(is_worth_refining(4.5, &alike, 0.12));

        // F_pi,q differs where the areas differ, though F_q,pi does not; and the other way round.
        let unequal = [Child { area: 0.2, exchange: Some(1.0) }, Child { area: 0.3, exchange: Some(1.0) }];
        assert!(is_worth_refining(2.0, &unequal, 0.3) && !is_worth_refining(2.0, &unequal, 0.35));
        let proportional = [Child { area: 0.2, exchange: Some(0.8) }, Child { area: 0.3, exchange: Some(1.2) }];
        assert!(is_worth_refining(2.0, &proportional, 0.3) && !is_worth_refining(2.0, &proportional, 0.35));

        // A child behind the other node differs from one that is not.
        assert!(is_worth_refining(1.0, &[quarter(1.0), Child { area: 0.25, exchange: None }], 0.99));
    }
}
