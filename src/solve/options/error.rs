//! What is wrong with an option.

use thiserror::Error;

/// An option outside its range, or no option at all.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum OptionsError {
    /// The value cannot be read, or is out of range.
    #[error("{option} is {value}, it must be {range}")]
    OutOfRange {
        /// The option's key.
        option: &'static str,
        /// What was given.
        value: String,
        /// What is legal.
        range: String,
    },
    /// No option has this key.
    #[error("unknown option '{key}'; choose one of {keys}")]
    UnknownKey {
        /// What was given.
        key: String,
        /// All keys, separated by commas.
        keys: String,
    },
}
