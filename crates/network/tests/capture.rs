//! What the writer writes is what independent readers read.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::net::{Ipv4Addr, SocketAddrV4};
use std::process::Command;

use profidrive_network::host::Host;
use profidrive_network::pcap::{Reader, Writer};
use profidrive_network::segment::Segment;
use profinet::{Endpoint, Instant, IpSuite, MacAddress, RPC_PORT, Transmit};

/// Sends one datagram to its peer as soon as it can, and answers what it gets.
struct Greeter {
    number: u8,
    greeting: Option<SocketAddrV4>,
}

impl Endpoint for Greeter {
    fn mac(&self) -> MacAddress {
        MacAddress([0x02, 0x50, 0x4E, 0, 0, self.number])
    }
    fn ip(&self) -> IpSuite {
        IpSuite {
            address: Ipv4Addr::new(10, 0, 0, self.number),
            mask: Ipv4Addr::new(255, 255, 255, 0),
            gateway: Ipv4Addr::UNSPECIFIED,
        }
    }
    fn handle_frame(&mut self, _: Instant, _: &[u8]) {}
    fn handle_datagram(&mut self, _: Instant, source: SocketAddrV4, _: u16, _: &[u8]) {
        if self.number == 2 {
            self.greeting = Some(source);
        }
    }
    fn handle_timeout(&mut self, _: Instant) {}
    fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        let destination = self.greeting.take()?;
        buffer.get_mut(..3)?.copy_from_slice(b"abc");
        Some(Transmit::Datagram {
            destination,
            source_port: 0xC000 + u16::from(self.number),
            length: 3,
        })
    }
    fn poll_timeout(&self) -> Option<Instant> {
        None
    }
}

#[test]
fn tshark_reads_a_capture_of_the_segment_without_complaint() {
    let path = std::env::temp_dir().join(format!("network-capture-{}.pcapng", std::process::id()));
    let mut segment = Segment::new(1);
    let file = std::fs::File::create(&path).unwrap();
    segment.add_tap(Box::new(Writer::starting_now(file, "segment").unwrap()));
    let peer = SocketAddrV4::new(Ipv4Addr::new(10, 0, 0, 2), RPC_PORT);
    segment.attach(Box::new(Host::new(Greeter {
        number: 1,
        greeting: Some(peer),
    })));
    segment.attach(Box::new(Host::new(Greeter {
        number: 2,
        greeting: None,
    })));
    segment.run_until(Instant::from_millis(5000));
    segment.finish_taps().unwrap();

    let read: Vec<_> = Reader::new(std::fs::File::open(&path).unwrap())
        .unwrap()
        .map(Result::unwrap)
        .collect();
    assert_eq!(read.len() as u64, segment.statistics().sent);

    let output = Command::new("tshark")
        .args([
            "-o",
            "ip.check_checksum:TRUE",
            "-o",
            "udp.check_checksum:TRUE",
            "-r",
        ])
        .arg(&path)
        .args([
            "-T",
            "fields",
            "-e",
            "frame.number",
            "-e",
            "frame.interface_name",
            "-e",
            "_ws.expert.message",
        ])
        .args(["-e", "ip.checksum.status", "-e", "udp.checksum.status"])
        .output()
        .expect("tshark is needed: apt-get install tshark");
    std::fs::remove_file(&path).unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert_eq!(text.lines().count(), read.len(), "{text}");
    let mut datagrams = 0;
    for line in text.lines() {
        let [_, interface, expert, ip, udp] = line.split('\t').collect::<Vec<_>>()[..] else {
            panic!("{line}");
        };
        assert_eq!((interface, expert), ("segment", ""), "{line}");
        if !udp.is_empty() {
            datagrams += 1;
            assert_eq!((ip, udp), ("1", "1"), "checksum status good: {line}");
        }
    }
    assert!(datagrams >= 1, "{text}");
}
