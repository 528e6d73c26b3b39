// Generated from data/profile/vendors.csv by `cargo run -p xtask -- gen`.

/// VendorIDs, rising, with names.
pub(super) static VENDORS: &[(u16, &str)] = &[
    (0x002A, "Siemens"),
    (0x0080, "Danfoss"),
    (0x0105, "Kollmorgen"),
    (0x0106, "Lenze"),
    (0x010A, "SEW-Eurodrive"),
    (0x011F, "Bosch Rexroth"),
    (0x014D, "Festo"),
    (0x0173, "KEB"),
    (0x01BA, "Vacon"),
];
