//! Why numbers make no light.

use thiserror::Error;

/// Why numbers make no light: says which of them is wrong, as in `its sun is below the horizon`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct LightError(pub(super) &'static str);
