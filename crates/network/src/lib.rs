//! Carries endpoints: whole Ethernet stations around protocol engines, an in-memory segment in virtual time, raw
//! Ethernet and UDP on Linux, capture files.
//!
//! The only room with sockets, threads and clocks. It knows PROFINET's [`Endpoint`](profinet::Endpoint) and
//! [`Medium`](profinet::Medium) and nothing of drives.
//!
//! | module | what it holds |
//! |---|---|
//! | [`host`] | [`Host`](host::Host): ARP, IPv4, ICMP echo and UDP around an endpoint; [`Station`](host::Station): frames in, frames out, next deadline |
//! | [`segment`] | [`Segment`](segment::Segment): a switch with stations, virtual time, seeded faults; [`SegmentMedium`](segment::SegmentMedium) |
//! | [`impaired`] | [`Impaired`](impaired::Impaired): a station behind a bad cable |
//! | [`probe`] | [`Probe`](probe::Probe): a station that asks who has an address before it is taken |
//! | [`linux`] | [`Runner`](linux::Runner): stations on an interface; [`PacketMedium`](linux::PacketMedium) and [`UdpMedium`](linux::UdpMedium) for clients |
//! | [`serial`] | [`Port`](serial::Port) and [`Line`](serial::Line): serial ports, for drives without a network |
//! | [`pcap`] | capture files: pcapng writer, pcap and pcapng reader |
//! | [`files`] | files that are replaced whole or not at all |

mod deadlines;
pub mod files;
pub mod host;
pub mod impaired;
#[cfg(target_os = "linux")]
#[allow(unsafe_code)] // system calls that std does not offer; each block says why it is sound
pub mod linux;
pub mod pcap;
pub mod probe;
pub mod segment;
#[cfg(target_os = "linux")]
pub mod serial;
