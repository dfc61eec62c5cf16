//! What Lischinski 1994 says of figures 5.4 to 5.10. Their curves are drawn without numbers, so sentences are all there is to compare with.

use super::configurations::Configuration;

/// Of the bounds along the floor, figures 5.4 to 5.6.
pub fn of_bounds(configuration: Configuration) -> &'static str {
    match configuration {
        Configuration::Direct => "figure 5.4: found in a single iteration, tight",
        _ => "figures 5.5, 5.6: nested, tighter as the accuracy increases, looser than 5.4 because errors propagate",
    }
}

/// Of estimated and measured errors against element size, figures 5.7 to 5.9.
pub fn of_sizes(configuration: Configuration) -> &'static str {
    match configuration {
        Configuration::Direct => "figure 5.7: both estimates are the same; in the L1 norm realistic upper bounds",
        Configuration::Walls => {
            "figure 5.8: in L1 both bound the error from above, the conservative one much more pessimistic; linear in h"
        }
        Configuration::Occluded => "figure 5.9: the same; in the maximum norm the non-conservative one is not always a bound",
    }
}

/// Of error against links, figure 5.10.
pub const OF_LINKS: &str = "figure 5.10: error-driven reaches much smaller errors with a fraction of the links (c; similar for b)";
