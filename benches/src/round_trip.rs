//! Record read over a veth pair: the same client asks two plain UDP processes, pnio and a virtual drive.

use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use profinet::RPC_PORT;
use profinet::wire::rpc::{Header, NdrRequest, operation};
use profinet::wire::{ByteOrder, Uuid, Writer};
use system_tests::{Lab, Side, built};

use crate::table::Row;

const COUNT: usize = 20_000;
/// Octets of the answer to a read of I&M0, which the plain UDP process sends too.
const ANSWER: usize = 224;

/// Runs all three and compares.
pub fn compare() -> Vec<Row> {
    let own = std::env::current_exe().unwrap();
    let lab = Lab::new("bench-round-trip");
    lab.address(Side::Device, "192.168.77.50/24");
    let ask = |address: &str, port: u16, vendor: u16| -> Duration {
        let [port, vendor, count] = [port.to_string(), vendor.to_string(), COUNT.to_string()];
        let arguments = ["ask", address, &port, &vendor, &count];
        let finished = lab
            .run(Side::Controller, &own, arguments, Duration::from_secs(60))
            .ok();
        let median = Duration::from_nanos(finished.out.trim().parse().unwrap());
        eprintln!("  {address}:{port} {:.1} us", micros(median));
        median
    };

    let mut echo = lab.spawn(Side::Device, &own, ["echo", "192.168.77.50:5000"]);
    echo.wait_for("ready", Duration::from_secs(5));
    let mut plain = vec![ask("192.168.77.50", 5000, 0)];
    let mut pnio = lab.spawn(
        Side::Device,
        built("pnio-device"),
        ["dev0", "pnio-dev", "192.168.77.50"],
    );
    pnio.wait_for("ready", Duration::from_secs(5));
    let peer = [
        ask("192.168.77.50", RPC_PORT, 0xFFFF),
        ask("192.168.77.50", RPC_PORT, 0xFFFF),
    ]
    .into_iter()
    .min()
    .unwrap();
    drop(pnio);
    plain.push(ask("192.168.77.50", 5000, 0));
    let drive = crate::drives::simulate(&lab, &["--ip", "192.168.77.60/24"]);
    let ours = [
        ask("192.168.77.60", RPC_PORT, 0x0105),
        ask("192.168.77.60", RPC_PORT, 0x0105),
    ]
    .into_iter()
    .min()
    .unwrap();
    drop(drive);
    plain.push(ask("192.168.77.50", 5000, 0));
    let plain = plain.into_iter().min().unwrap();

    let limit = plain.mul_f64(1.3);
    vec![
        Row::new(
            "record read over veth (median)",
            format!("{:.1} us", micros(ours)),
        )
        .beside(format!(
            "plain UDP {:.1} us, pnio {:.1} us",
            micros(plain),
            micros(peer)
        ))
        .limit(
            format!("{:.1} us (1.3 x plain), below pnio", micros(limit)),
            ours <= limit && ours < peer,
        ),
    ]
}

fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// The plain UDP process: answers every datagram with one of the length of a record answer.
pub fn echo(address: &str) {
    let socket = UdpSocket::bind(address).unwrap();
    println!("ready");
    let mut buffer = [0; 2048];
    loop {
        let (_, from) = socket.recv_from(&mut buffer).unwrap();
        socket.send_to(&buffer[..ANSWER], from).unwrap();
    }
}

/// The client: reads I&M0 without a connection again and again, prints the median round trip in nanoseconds.
pub fn ask(address: &str, port: &str, vendor: &str, count: &str) {
    let vendor = vendor.parse().unwrap();
    let target: SocketAddr = format!("{address}:{port}").parse().unwrap();
    let socket = UdpSocket::bind("192.168.77.11:0").unwrap();
    socket.connect(target).unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(1))).unwrap();
    let count: usize = count.parse().unwrap();
    let mut times = Vec::with_capacity(count);
    let mut buffer = [0; 2048];
    for sequence in 0..count + 500 {
        let request = read_identification(sequence, vendor);
        let start = Instant::now();
        socket.send(&request).unwrap();
        let length = socket
            .recv(&mut buffer)
            .unwrap_or_else(|e| panic!("no answer to read {sequence}: {e}"));
        let time = start.elapsed();
        assert_eq!(length, ANSWER, "not the answer to a read of I&M0");
        if sequence >= 500 {
            times.push(time);
        }
    }
    times.sort();
    println!("{}", times[times.len() / 2].as_nanos());
}

/// A client that asks at a steady pace and counts nothing: the load for a device's CPU time.
pub fn pace(address: &str, millis: &str, seconds: &str) {
    let socket = UdpSocket::bind("192.168.77.11:0").unwrap();
    socket.connect(address).unwrap();
    socket.set_read_timeout(Some(Duration::from_secs(1))).unwrap();
    let step = Duration::from_millis(millis.parse().unwrap());
    let start = Instant::now();
    let end = start + Duration::from_secs(seconds.parse().unwrap());
    let mut next = start;
    let mut buffer = [0; 2048];
    while next < end {
        std::thread::sleep(next.saturating_duration_since(Instant::now()));
        socket.send(&[0; 64]).unwrap();
        socket.recv(&mut buffer).unwrap();
        next += step;
    }
}

/// ReadImplicit of I&M0 at slot 0, subslot 1.
fn read_identification(sequence: usize, vendor: u16) -> Vec<u8> {
    let order = ByteOrder::Big;
    let object = Uuid::object(1, 1, vendor);
    let mut activity = *b"\x11\x22\x33\x44\x55\x66\x17\x88\x99\xAA\xBB\xCC\xDD\xEE\xFF\x00";
    activity[12..16].copy_from_slice(&std::process::id().to_be_bytes());
    let sequence = u32::try_from(sequence).unwrap();
    let interface = Uuid::DEVICE_INTERFACE;
    let header = Header::request(
        object,
        interface,
        Uuid(activity),
        sequence,
        operation::READ_IMPLICIT,
    );
    let mut block = Vec::new();
    block.bytes(&[0x00, 0x09, 0x00, 0x3C, 0x01, 0x00]);
    block.u16(u16::try_from(sequence & 0xFFFF).unwrap());
    block.zeros(16 + 4);
    block.u16(0);
    block.u16(1);
    block.u16(0);
    block.u16(0xAFF0);
    block.u32(4096);
    block.zeros(24);
    let mut out = Vec::new();
    header.encode(&mut out, 20 + block.len());
    NdrRequest {
        args_maximum: 4096 + 64,
        args_length: 64,
    }
    .encode(&mut out, order);
    out.extend_from_slice(&block);
    out
}
