//! A firmware that answers parameter requests, speaks PROFINET and USS and reads device descriptions would begin like this.
#![no_std]

extern crate alloc;

use alloc::string::ToString;
use core::panic::PanicInfo;

use profile::model;
use profile::value::Parameters;
use profinet::controller::{Controller, ControllerConfig};
use profinet::{IpSuite, MacAddress};

#[global_allocator]
static HEAP: dlmalloc::GlobalDlmalloc = dlmalloc::GlobalDlmalloc;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {}
}

/// Uses something of every crate; what it returns means nothing.
pub extern "C" fn proof() -> usize {
    let parameters = Parameters::of(&model::AKD);
    let found = parameters.select(&"DRV.ACC".parse().unwrap_or_else(|_| loop {}));
    let config = ControllerConfig::new(MacAddress::default(), IpSuite::NONE, "plc", 1);
    let controller = Controller::new(config);
    let description = gsdml::parse(b"<ISO15745Profile/>");
    let telegram = uss::Telegram::decode(&[0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00, 0xDD]);
    found.map_or(0, |found| found.label().len())
        + usize::from(description.is_ok())
        + telegram.map_or_else(|error| error.to_string().len(), |telegram| telegram.data.len())
        + core::mem::size_of_val(&controller)
}
