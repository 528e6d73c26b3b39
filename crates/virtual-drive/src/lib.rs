//! virtual-drive
#![forbid(unsafe_code)]
