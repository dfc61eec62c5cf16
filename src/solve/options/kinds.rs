//! Kinds of values that options have: each reads a value from text, knows whether it is legal, and says what is.

use std::fmt::Display;
use std::ops::{Bound, RangeBounds};
use std::str::FromStr;

use super::error::OptionsError;
use crate::links::Skips;

/// What an option's value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OptionType {
    /// A number.
    Real,
    /// A whole number, not negative.
    Whole,
    /// `true` or `false`.
    Flag,
    /// A name, or other text.
    Text,
}

/// What values of type `T` are legal.
pub(super) trait Kind<T> {
    /// What a value is.
    const TYPE: OptionType;

    /// The value that `text` stands for; `None` if it stands for none.
    fn parse(&self, text: &str) -> Option<T>;

    /// Whether the value is in range.
    fn allows(&self, _value: &T) -> bool {
        true
    }

    /// The value as it is typed; `None` for one that nobody has given.
    fn show(&self, value: &T) -> Option<String>;

    /// What is legal, as in "it must be ...".
    fn range(&self) -> String;
}

/// What an option of this kind is.
pub(super) const fn type_of<T, K: Kind<T>>(_: &K) -> OptionType {
    K::TYPE
}

/// Reads an option from text.
pub(super) fn read<T>(option: &'static str, kind: impl Kind<T>, text: &str) -> Result<T, OptionsError> {
    let text = text.trim();
    let value = kind.parse(text).filter(|value| kind.allows(value));
    value.ok_or_else(|| OptionsError::OutOfRange { option, value: text.to_owned(), range: kind.range() })
}

/// Whether the value of an option is in range.
pub(super) fn check<T>(option: &'static str, kind: impl Kind<T>, value: &T) -> Result<(), OptionsError> {
    if kind.allows(value) {
        return Ok(());
    }
    Err(OptionsError::OutOfRange { option, value: kind.show(value).unwrap_or_default(), range: kind.range() })
}

/// A type of numbers.
pub(super) trait Number: Copy + PartialOrd + Display + FromStr {
    /// What one of them is called.
    const NOUN: &'static str;
    /// What one of them is.
    const TYPE: OptionType;
    /// Those above are infinite, or none.
    const MOST: Self;
}

impl Number for u32 {
    const NOUN: &'static str = "a whole number";
    const TYPE: OptionType = OptionType::Whole;
    const MOST: Self = Self::MAX;
}

impl Number for u64 {
    const NOUN: &'static str = "a whole number";
    const TYPE: OptionType = OptionType::Whole;
    const MOST: Self = Self::MAX;
}

impl Number for f64 {
    const NOUN: &'static str = "a number";
    const TYPE: OptionType = OptionType::Real;
    const MOST: Self = Self::MAX;
}

/// Finite numbers in a range. Of type `Option`, the option need not be given.
pub(super) struct Range<T>(Bound<T>, Bound<T>);

/// Any number: for counts, from 0 on.
pub(super) fn any<T>() -> Range<T> {
    Range(Bound::Unbounded, Bound::Unbounded)
}

/// Numbers from `low` to `high`, both included.
pub(super) fn between<T>(low: T, high: T) -> Range<T> {
    Range(Bound::Included(low), Bound::Included(high))
}

/// Numbers from `low` on.
pub(super) fn at_least<T>(low: T) -> Range<T> {
    Range(Bound::Included(low), Bound::Unbounded)
}

/// Numbers above `low`.
pub(super) fn above<T>(low: T) -> Range<T> {
    Range(Bound::Excluded(low), Bound::Unbounded)
}

impl<T> Range<T> {
    /// Of these, the numbers below `high`.
    pub fn below(self, high: T) -> Self {
        Self(self.0, Bound::Excluded(high))
    }

    /// Of these, the numbers that are at most `high`.
    pub fn at_most(self, high: T) -> Self {
        Self(self.0, Bound::Included(high))
    }
}

impl<T: Number> Kind<T> for Range<T> {
    const TYPE: OptionType = T::TYPE;

    fn parse(&self, text: &str) -> Option<T> {
        text.parse().ok()
    }

    fn allows(&self, value: &T) -> bool {
        *value <= T::MOST && (self.0, self.1).contains(value)
    }

    fn show(&self, value: &T) -> Option<String> {
        Some(value.to_string())
    }

    fn range(&self) -> String {
        let bounds = match (self.0, self.1) {
            (Bound::Included(low), Bound::Included(high)) => format!(" from {low} to {high}"),
            (Bound::Included(low), _) => format!(" from {low} on"),
            (Bound::Excluded(low), Bound::Included(high)) => format!(" above {low}, at most {high}"),
            (Bound::Excluded(low), Bound::Excluded(high)) => format!(" above {low} and below {high}"),
            (Bound::Excluded(low), Bound::Unbounded) => format!(" above {low}"),
            (Bound::Unbounded, _) => String::new(),
        };
        format!("{}{bounds}", T::NOUN)
    }
}

impl<T: Number> Kind<Option<T>> for Range<T> {
    const TYPE: OptionType = T::TYPE;

    fn parse(&self, text: &str) -> Option<Option<T>> {
        text.parse().ok().map(Some)
    }

    fn allows(&self, value: &Option<T>) -> bool {
        value.is_none_or(|value| self.allows(&value))
    }

    fn show(&self, value: &Option<T>) -> Option<String> {
        value.as_ref().map(T::to_string)
    }

    fn range(&self) -> String {
        Kind::<T>::range(self)
    }
}

/// A value that is one of a few names.
pub(super) trait Choice: Copy + 'static {
    /// All names, as typed on the command line.
    const NAMES: &'static [&'static str];
    /// Its own name.
    fn name(self) -> &'static str;
    /// The value with this name.
    fn of_name(name: &str) -> Option<Self>;
}

/// One of a few names.
pub(super) struct OneName;

impl<T: Choice> Kind<T> for OneName {
    const TYPE: OptionType = OptionType::Text;

    fn parse(&self, text: &str) -> Option<T> {
        T::of_name(text)
    }

    fn show(&self, value: &T) -> Option<String> {
        Some(value.name().to_owned())
    }

    fn range(&self) -> String {
        let (last, others) = T::NAMES.split_last().expect("a choice has names");
        format!("{} or {last}", others.join(", "))
    }
}

/// Yes or no.
pub(super) struct Flag;

impl Kind<bool> for Flag {
    const TYPE: OptionType = OptionType::Flag;

    fn parse(&self, text: &str) -> Option<bool> {
        text.parse().ok()
    }

    fn show(&self, value: &bool) -> Option<String> {
        Some(value.to_string())
    }

    fn range(&self) -> String {
        "true or false".to_owned()
    }
}

/// Text that the type itself reads, with what is legal.
pub(super) struct Text(pub &'static str);

impl<T: FromStr + Display> Kind<T> for Text {
    const TYPE: OptionType = OptionType::Text;

    fn parse(&self, text: &str) -> Option<T> {
        text.parse().ok()
    }

    fn show(&self, value: &T) -> Option<String> {
        Some(value.to_string())
    }

    fn range(&self) -> String {
        self.0.to_owned()
    }
}

/// Some of [`Skips::NAMES`].
pub(super) struct SkipNames;

impl Kind<Skips> for SkipNames {
    const TYPE: OptionType = OptionType::Text;

    fn parse(&self, text: &str) -> Option<Skips> {
        text.parse().ok()
    }

    fn show(&self, skips: &Skips) -> Option<String> {
        let is_on = |name: &&str| skips.without(name) != Some(*skips);
        let names: Vec<&str> = Skips::NAMES.into_iter().filter(is_on).collect();
        Some(match names.len() {
            0 => "none".to_owned(),
            count if count == Skips::NAMES.len() => "all".to_owned(),
            _ => names.join("+"),
        })
    }

    fn range(&self) -> String {
        format!("all, none, or {}, joined by +", Skips::NAMES.join(", "))
    }
}
