//! Record the traffic of a plant in memory and read it back.
//!
//! `cargo run -p examples --example capture -- traffic.pcapng`

use std::error::Error;
use std::fs::File;
use std::io::BufReader;

use network::files;
use network::pcap::{Reader, Writer};
use profidrive::Transport;
use profidrive::client::{DriveAddress, Wait};
use profinet::wire::ethernet::Frame;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("give a file to write")?;
    let file = files::create(path.as_ref())?;
    let mut network = profidrive::open_plant("examples/plants/one_drive.toml")?;
    let Transport::Plant(plant) = network.transport().clone() else {
        return Err("not a plant".into());
    };
    let tap = Box::new(Writer::starting_now(file, "plant")?);
    plant.with_world(|world| world.add_tap(tap));
    network.find(&DriveAddress::Name("akd-1".into())).wait()?;
    network.close().wait()?;
    plant.with_world(|world| world.finish_taps())?;
    for captured in Reader::new(BufReader::new(File::open(&path)?))? {
        let captured = captured?;
        match Frame::parse(&captured.frame) {
            Some(frame) => println!("{} -> {}  {:?}", frame.source, frame.destination, frame.frame_id),
            None => println!("{} octets that are no PROFINET frame", captured.frame.len()),
        }
    }
    Ok(())
}
