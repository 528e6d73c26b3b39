//! Who a device is.

/// What I&M0 to 3 say about the device; empty where the device does not say.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Identity {
    /// I&M0: vendor.
    pub vendor_id: u16,
    /// I&M0: order number.
    pub order_id: String,
    /// I&M0: serial number.
    pub serial_number: String,
    /// I&M0: hardware revision.
    pub hardware_revision: u16,
    /// I&M0: software revision, for example `V1.17.0`.
    pub software_revision: String,
    /// I&M0: profile, 0x3A00 for PROFIdrive.
    pub profile_id: u16,
    /// I&M0: type within the profile.
    pub profile_type: u16,
    /// I&M1: function.
    pub function: String,
    /// I&M1: location.
    pub location: String,
    /// I&M2: installation date.
    pub installed: String,
    /// I&M3: descriptor.
    pub descriptor: String,
}
