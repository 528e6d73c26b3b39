//! Parameter service.

/// Why the drive refuses a read or a write: the error number of the profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refusal(pub u16);

impl Refusal {
    pub(super) const UNKNOWN: Self = Self(0x00);
    pub(super) const READ_ONLY: Self = Self(0x01);
    pub(super) const LIMIT: Self = Self(0x02);
    pub(super) const SUBINDEX: Self = Self(0x03);
    pub(super) const NO_ARRAY: Self = Self(0x04);
    pub(super) const PRIORITY: Self = Self(0x0B);
    pub(super) const STATE: Self = Self(0x11);
    pub(super) const VALUE: Self = Self(0x14);
}
