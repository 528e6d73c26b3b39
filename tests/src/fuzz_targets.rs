//! What the fuzzers call, one plain function for each parser of foreign bytes. `tests/tests/suite/corpus.rs` replays the
//! committed corpus through them; `make fuzz` looks for more.
//!
//! A target fails by panicking. Beyond "does not panic" each checks what must hold for every input that is accepted:
//! what was decoded encodes to something that decodes to the same.

mod backup;
mod captures;
mod controller;
mod descriptions;
mod drive;
mod frames;
mod host;
mod machines;
mod neighbourhood;
mod parameters;
mod plants;
mod recordings;
mod records;
mod rpc;
mod serial;
mod steps;

pub use backup::backup;
pub use captures::{capture, octets, pcap};
pub use controller::controller;
pub use descriptions::gsdml;
pub use drive::{converter, drive, state};
pub use frames::{alarm, blocks, dcp, rt};
pub use host::host;
pub use machines::machine;
pub use neighbourhood::{lldp, snmp};
pub use parameters::{description, notation, parameter_request, parameter_response, setting};
pub use plants::plant;
pub use recordings::earlier_step;
pub use records::records;
pub use rpc::{rpc, rpc_client, rpc_server};
pub use serial::{pkw, serial};

/// A target: takes any bytes, must not panic.
pub type Target = fn(&[u8]);

/// All targets by name. `fuzz/fuzz_targets/<name>.rs` and `fuzz/corpus/<name>/` exist for each.
pub const TARGETS: &[(&str, Target)] = &[
    ("alarm", alarm),
    ("backup", backup),
    ("blocks", blocks),
    ("capture", capture),
    ("controller", controller),
    ("converter", converter),
    ("dcp", dcp),
    ("description", description),
    ("drive", drive),
    ("earlier_step", earlier_step),
    ("gsdml", gsdml),
    ("host", host),
    ("lldp", lldp),
    ("machine", machine),
    ("notation", notation),
    ("octets", octets),
    ("parameter_request", parameter_request),
    ("parameter_response", parameter_response),
    ("pcap", pcap),
    ("pkw", pkw),
    ("plant", plant),
    ("records", records),
    ("rpc", rpc),
    ("rpc_client", rpc_client),
    ("rpc_server", rpc_server),
    ("rt", rt),
    ("serial", serial),
    ("setting", setting),
    ("snmp", snmp),
    ("state", state),
];
