//! What may be asked of a solve.
//!
//! [`table`] has one entry for each option, with its type, default, range, unit and help. All else follows from it: the fields of
//! [`SolveOptions`], the text that [`SolveOptions::set`] reads, what [`SolveOptions::validate`] rejects, and what the program lists. A
//! rule between two options is written in `validate`.

mod choices;
mod declare;
mod error;
mod interest;
mod kinds;
mod run;
mod table;

pub use choices::{Bounds, Norm, Solver, Strategy, Subdivision, Sweep};
pub use error::OptionsError;
pub use interest::Interest;
pub use kinds::OptionType;
pub use run::RunOptions;
pub use table::{
    CellOptions, ChangShih98Options, Holzschuch94Options, LinkOptions, Multiresolution96Options, OptionEntry, OptionGroup,
    SolveOptions, UniformOptions,
};

impl SolveOptions {
    /// All options, group after group.
    pub fn entries() -> impl Iterator<Item = &'static OptionEntry> {
        Self::GROUPS.iter().flat_map(|group| group.options)
    }

    /// The option with this key.
    ///
    /// # Errors
    /// [`OptionsError::UnknownKey`] if there is none.
    pub fn entry(key: &str) -> Result<&'static OptionEntry, OptionsError> {
        Self::entries().find(|entry| entry.key == key).ok_or_else(|| {
            let keys: Vec<_> = Self::entries().map(|entry| entry.key).collect();
            OptionsError::UnknownKey { key: key.to_owned(), keys: keys.join(", ") }
        })
    }

    /// Sets one option from text, as `--set key=value` does. Rules between options are left to [`SolveOptions::validate`], so that the
    /// order of settings does not matter.
    ///
    /// # Errors
    /// [`OptionsError`] for an unknown key, or a value that cannot be read or is out of range; nothing is changed then.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), OptionsError> {
        Self::entry(key)?.set(self, value)
    }

    /// Rejects values outside their range, and options that contradict each other; never clamps.
    ///
    /// # Errors
    /// [`OptionsError::OutOfRange`] names the option and what is legal.
    pub fn validate(&self) -> Result<(), OptionsError> {
        let reject = |option, value: &dyn ToString, range: &str| {
            Err(OptionsError::OutOfRange { option, value: value.to_string(), range: range.to_owned() })
        };
        Self::entries().try_for_each(|entry| entry.check(self))?;
        if self.bounds == Bounds::Guaranteed && self.strategy.forgets_pairs() {
            return reject("bounds", &self.bounds, "estimate for the strategies of 1994, which do not account for all pairs");
        }
        if self.importance != Interest::Total && self.strategy != Strategy::ErrorDriven {
            return reject("importance", &self.importance, "total, unless strategy is error-driven");
        }
        if self.links.subdivision != Subdivision::Regular && self.strategy.links_once() {
            return reject(
                "subdivision",
                &self.links.subdivision,
                "regular for the strategies of 1998, which subdivide surfaces evenly",
            );
        }
        if self.keep_transport && (self.solver == Solver::Links || self.strategy != Strategy::Default) {
            return reject("keep_transport", &true, "false over links, and with a strategy: what paths bring is kept over cells");
        }
        if self.keep_transport && (self.lit_mesh || self.bounds == Bounds::Guaranteed) {
            return reject(
                "keep_transport",
                &true,
                "false with a lit mesh, and with guaranteed bounds, which are not solved again",
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
