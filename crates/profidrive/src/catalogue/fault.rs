//! Fault and warning numbers of a model.

/// What a fault or warning number means.
/// Source: the maker's lists, named in [`source`](Self::source).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaultText {
    /// The number, as in PNU 947.
    pub number: u16,
    /// True for a warning (`n107`), false for a fault (`F107`).
    pub warning: bool,
    /// What happened.
    pub meaning: &'static str,
    /// How it is cleared, empty when not known.
    pub remedy: &'static str,
    /// Where this is from.
    pub source: &'static str,
}
