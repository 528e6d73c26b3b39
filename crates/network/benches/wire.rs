//! What the wire side costs, over a veth pair between two processes in two network namespaces:
//! round trips beside two plain UDP processes, and CPU time per 1,000 cycles of one station.
//!
//! `cargo bench -p profidrive-network --bench wire`; needs `unshare` and `ip`, no root.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::io::{BufRead, BufReader};
use std::net::{Ipv4Addr, SocketAddrV4, UdpSocket};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant as Wall};

use profidrive_network::ethernet::{PacketMedium, Runner};
use profidrive_network::host::Host;
use profidrive_network::system::{InterfaceInfo, ServerPort, now};
use profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Medium, RPC_PORT, Transmit};

const ROUNDS: usize = 20_000;
const PAYLOAD: usize = 180; // a record read request is about this long
const HOST_MAC: MacAddress = MacAddress([0x02, 0x50, 0x4E, 0, 0, 1]);
const PEER_MAC: MacAddress = MacAddress([0x02, 0x50, 0x4E, 0, 0, 9]);
const HOST_IP: Ipv4Addr = Ipv4Addr::new(10, 0, 0, 1);
const PEER_IP: Ipv4Addr = Ipv4Addr::new(10, 0, 0, 9);

/// Answers datagrams; sends a frame per cycle.
struct Station {
    mac: MacAddress,
    peer: MacAddress,
    ip: IpSuite,
    answer: [u8; MAX_FRAME],
    to: Option<(SocketAddrV4, usize)>,
    cycle: Option<Duration>,
    next: Instant,
    received: u64,
    due: bool,
    got: bool,
}

impl Station {
    fn new(mac: MacAddress, peer: MacAddress, address: Ipv4Addr, cycle: Option<Duration>) -> Self {
        let ip = IpSuite {
            address,
            mask: Ipv4Addr::new(255, 255, 255, 0),
            gateway: Ipv4Addr::UNSPECIFIED,
        };
        let next = now() + Duration::from_millis(1);
        Self {
            mac,
            peer,
            ip,
            answer: [0; MAX_FRAME],
            to: None,
            cycle,
            next,
            received: 0,
            due: false,
            got: false,
        }
    }
}

impl Endpoint for Station {
    fn mac(&self) -> MacAddress {
        self.mac
    }
    fn ip(&self) -> IpSuite {
        self.ip
    }
    fn handle_frame(&mut self, _: Instant, _: &[u8]) {
        self.received += 1;
    }
    fn handle_datagram(&mut self, _: Instant, source: SocketAddrV4, _: u16, payload: &[u8]) {
        self.got = true;
        if self.mac == HOST_MAC {
            self.answer[..payload.len()].copy_from_slice(payload);
            self.to = Some((source, payload.len()));
        }
    }
    fn handle_timeout(&mut self, now: Instant) {
        if let Some(cycle) = self.cycle
            && self.next <= now
        {
            self.next += cycle;
            self.due = true;
        }
    }
    fn poll_transmit(&mut self, _: Instant, buffer: &mut [u8]) -> Option<Transmit> {
        if std::mem::take(&mut self.due) {
            buffer[..64].fill(0);
            buffer[..6].copy_from_slice(&self.peer.0);
            buffer[6..12].copy_from_slice(&self.mac.0);
            buffer[12..18].copy_from_slice(&[0x81, 0, 0xC0, 0, 0x88, 0x92]);
            return Some(Transmit::Frame { length: 64 });
        }
        let (destination, length) = self.to.take()?;
        buffer[..length].copy_from_slice(&self.answer[..length]);
        let source_port = if self.mac == HOST_MAC { RPC_PORT } else { 0xC000 };
        Some(Transmit::Datagram {
            destination,
            source_port,
            length,
        })
    }
    fn poll_timeout(&self) -> Option<Instant> {
        self.cycle.map(|_| self.next)
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.iter().position(|a| a.starts_with("--role=")) {
        None => {
            let itself = std::env::current_exe().unwrap();
            let status = Command::new("unshare")
                .args(["--user", "--map-root-user", "--net"])
                .arg(itself)
                .arg("--role=client")
                .status()
                .unwrap();
            assert!(status.success());
        }
        Some(at) => match arguments[at].trim_start_matches("--role=") {
            "client" => client(),
            "plain" => plain_server(),
            sleeper if sleeper.starts_with("sleep-") => sleeper_server(sleeper[6..].parse().unwrap()),
            cycle => station_server(cycle.parse().unwrap()),
        },
    }
}

fn sh(command: &str) {
    let status = Command::new("sh").args(["-c", command]).status().unwrap();
    assert!(status.success(), "{command}");
}

/// Starts the other process in a namespace of its own and connects it by a veth pair: `va` here, `vb` there.
fn server(role: &str) -> Child {
    let _ = Command::new("sh")
        .args(["-c", "ip link delete va 2>/dev/null"])
        .status();
    let itself = std::env::current_exe().unwrap();
    let mut child = Command::new("unshare")
        .arg("--net")
        .arg(itself)
        .arg(format!("--role={role}"))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // unshare replaces itself by the program: same process.
    std::thread::sleep(Duration::from_millis(100));
    sh(&format!(
        "ip link add va type veth peer name vb netns {} && ip link set va up",
        child.id()
    ));
    sh("ip address add 10.0.0.9/24 dev va");
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap())
        .read_line(&mut line)
        .unwrap();
    assert_eq!(line, "ready\n");
    child
}

fn wait_for_interface() {
    while InterfaceInfo::find("vb").is_err() {
        std::thread::sleep(Duration::from_millis(5));
    }
    sh("ip link set vb up");
}

fn plain_server() {
    wait_for_interface();
    sh("ip address add 10.0.0.1/24 dev vb");
    let socket = UdpSocket::bind((HOST_IP, RPC_PORT)).unwrap();
    println!("ready");
    let mut buffer = [0; 2000];
    loop {
        let (length, from) = socket.recv_from(&mut buffer).unwrap();
        socket.send_to(&buffer[..length], from).unwrap();
    }
}

/// The least a process can do: sleep, send a datagram, once per cycle.
fn sleeper_server(cycle_ms: u64) {
    wait_for_interface();
    sh("ip address add 10.0.0.1/24 dev vb");
    let socket = UdpSocket::bind((HOST_IP, RPC_PORT)).unwrap();
    println!("ready");
    let mut next = Wall::now();
    loop {
        next += Duration::from_millis(cycle_ms);
        std::thread::sleep(next.saturating_duration_since(Wall::now()));
        socket.send_to(&[0; 46], (PEER_IP, 9)).unwrap();
    }
}

fn station_server(cycle_ms: u64) {
    wait_for_interface();
    let cycle = (cycle_ms > 0).then(|| Duration::from_millis(cycle_ms));
    let mut runner = Runner::open("vb").unwrap();
    runner
        .attach(Box::new(Host::new(Station::new(
            HOST_MAC, PEER_MAC, HOST_IP, cycle,
        ))))
        .unwrap();
    println!("ready");
    loop {
        runner.step(now() + Duration::from_secs(1)).unwrap();
    }
}

/// Round trips of a plain UDP client, sorted.
fn plain_client() -> Vec<Duration> {
    let socket = UdpSocket::bind((PEER_IP, 0)).unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(2))).unwrap();
    let mut buffer = [0; 2000];
    let mut took: Vec<Duration> = (0..ROUNDS)
        .map(|_| {
            let begin = Wall::now();
            socket.send_to(&[0x55; PAYLOAD], (HOST_IP, RPC_PORT)).unwrap();
            assert_eq!(socket.recv_from(&mut buffer).unwrap().0, PAYLOAD);
            begin.elapsed()
        })
        .collect();
    took.sort();
    took
}

/// Round trips of a client on a [`PacketMedium`], sorted.
fn medium_client() -> Vec<Duration> {
    let mut medium = PacketMedium::open("va", ServerPort::Required).unwrap();
    let mut client = Station::new(medium.interface().mac.unwrap(), HOST_MAC, PEER_IP, None);
    let mut took: Vec<Duration> = (0..ROUNDS)
        .map(|_| {
            let begin = Wall::now();
            client.got = false;
            client.to = Some((SocketAddrV4::new(HOST_IP, RPC_PORT), PAYLOAD));
            let end = now() + Duration::from_secs(2);
            while !client.got {
                assert!(now() < end, "no answer");
                medium.step(&mut client, end).unwrap();
            }
            begin.elapsed()
        })
        .collect();
    took.sort();
    took
}

/// Nanoseconds a process has spent on a CPU.
fn cpu_time(child: &Child) -> u64 {
    let text = std::fs::read_to_string(format!("/proc/{}/schedstat", child.id())).unwrap();
    text.split_whitespace().next().unwrap().parse().unwrap()
}

fn report(what: &str, took: &[Duration], reference: Option<Duration>) -> Duration {
    let median = took[took.len() / 2];
    let beside = reference.map_or(String::new(), |r| {
        format!("   {:.2} x plain", median.as_secs_f64() / r.as_secs_f64())
    });
    println!(
        "{what:<48} median {:6.2} us   99 % {:6.2} us{beside}",
        median.as_secs_f64() * 1e6,
        took[took.len() * 99 / 100].as_secs_f64() * 1e6,
    );
    median
}

fn client() {
    println!("round trip of {PAYLOAD} octets over veth, {ROUNDS} rounds, two processes:");
    for _ in 0..3 {
        let mut peer = server("plain");
        let plain = report("  plain UDP  <-> plain UDP", &plain_client(), None);
        report("  medium     <-> plain UDP", &medium_client(), Some(plain));
        peer.kill().unwrap();
        peer.wait().unwrap();
        let mut peer = server("0");
        report(
            "  plain UDP  <-> station on a runner",
            &plain_client(),
            Some(plain),
        );
        report(
            "  medium     <-> station on a runner",
            &medium_client(),
            Some(plain),
        );
        peer.kill().unwrap();
        peer.wait().unwrap();
    }
    println!("CPU time per 1,000 cycles of one station, one frame in and one out per cycle (limit 0.040 s),");
    println!("beside a process that only sleeps and sends one datagram per cycle:");
    for cycle in [1u64, 4, 16] {
        let [(floor, _), (station, received)] =
            [format!("sleep-{cycle}"), cycle.to_string()].map(|role| cycles(&role, cycle));
        println!(
            "  {cycle:>2} ms: station {station:.4} s ({received} frames received), only sleep and send {floor:.4} s"
        );
    }
}

/// CPU time of the other process during 1,000 cycles, and the frames received from it.
fn cycles(role: &str, cycle: u64) -> (f64, u64) {
    let mut peer = server(role);
    let mut runner = Runner::open("va").unwrap();
    let own = Station::new(
        PEER_MAC,
        HOST_MAC,
        Ipv4Addr::UNSPECIFIED,
        Some(Duration::from_millis(cycle)),
    );
    let id = runner.attach(Box::new(Host::new(own))).unwrap();
    let before = cpu_time(&peer);
    let end = now() + Duration::from_millis(1000 * cycle);
    while now() < end {
        runner.step(end).unwrap();
    }
    let spent = cpu_time(&peer) - before;
    peer.kill().unwrap();
    peer.wait().unwrap();
    (
        spent as f64 / 1e9,
        runner.station::<Host<Station>>(id).unwrap().endpoint().received,
    )
}
