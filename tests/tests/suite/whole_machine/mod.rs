//! Tests that measure times or load the machine, so that no other laboratory runs beside them ([`Lab::alone`](system_tests::Lab::alone)).
//! Tests begin in the order of their names: these come last, and none of the others waits for them.

mod docs;
mod flood;
mod many_axes;
mod many_drives;
mod peer_pnio;
mod peer_pnio_ppo;
mod recording;
