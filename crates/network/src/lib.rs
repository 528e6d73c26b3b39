//! Carries endpoints: whole Ethernet stations around protocol engines, an in-memory segment in virtual time, raw
//! Ethernet on Linux (feature `raw-ethernet`), UDP, capture files.
//!
//! The only room with sockets, threads and clocks. It uses PROFINET's [`Endpoint`](profinet::Endpoint) and
//! [`Medium`](profinet::Medium) and nothing of drives.
//!
//! | module | what it holds |
//! |---|---|
//! | [`host`] | [`Host`](host::Host): ARP, IPv4, ICMP echo and UDP around an endpoint; [`Station`](host::Station): frames in, frames out, next deadline |
//! | [`segment`] | [`Segment`](segment::Segment): a switch with stations, virtual time, seeded faults; [`SegmentMedium`](segment::SegmentMedium) |
//! | [`impaired`] | [`Impaired`](impaired::Impaired): a station behind a bad cable |
//! | [`probe`] | [`Probe`](probe::Probe): a station that checks by ARP whether an address is in use |
//! | [`ethernet`] | [`Runner`](ethernet::Runner): stations on an interface; [`PacketMedium`](ethernet::PacketMedium) for clients |
//! | [`system`] | [`UdpMedium`](system::UdpMedium) for clients; clock, interfaces, Ctrl-C, folders |
//! | [`serial`] | [`Port`](serial::Port) and [`Line`](serial::Line): serial ports, for drives without a network |
//! | [`pcap`] | capture files: pcapng writer, pcap and pcapng reader |
//! | [`files`] | files that are replaced whole or not at all |

pub mod ethernet;
pub mod files;
pub mod host;
pub mod impaired;
pub mod pcap;
pub mod probe;
pub mod segment;
pub mod serial;
pub mod system;
