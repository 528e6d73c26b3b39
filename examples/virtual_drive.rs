//! A virtual drive as a library: no PROFINET, only process data and parameters, in virtual time.
//!
//! `cargo run -p examples --example virtual_drive`

use std::error::Error;
use std::time::Duration;

use profile::state::Stw1;
use profinet::Instant;
use virtual_drive::drive::Drive;
use virtual_drive::model;

fn main() -> Result<(), Box<dyn Error>> {
    let mut drive = Drive::new(&model::AKD);
    drive.connect(1, Duration::from_millis(48))?;
    let mut now = Instant::ZERO;
    // Telegram 1: STW1 and NSOLL_A out, ZSW1 and NIST_A in. 164 is 60 rpm at the default PN.VELSCALING.
    for (stw1, nsoll_a, cycles) in [
        (Stw1::READY.0, 0_u16, 2),
        (Stw1::RUN.0, 164, 60),
        (Stw1::READY.0, 0, 10),
    ] {
        for _ in 0..cycles {
            let [s1, s0] = stw1.to_be_bytes();
            let [n1, n0] = nsoll_a.to_be_bytes();
            let mut inputs = [0; 4];
            drive.tick(now, Some(&[s1, s0, n1, n0]), &mut inputs);
            now += Duration::from_millis(16);
            let [z1, z0, a1, a0] = inputs;
            if now.as_millis().is_multiple_of(160) {
                println!(
                    "{:5} ms  STW1 0x{stw1:04X}  ZSW1 0x{:04X}  NIST_A {}",
                    now.as_millis(),
                    u16::from_be_bytes([z1, z0]),
                    i16::from_be_bytes([a1, a0])
                );
            }
        }
    }
    // The operating mode through the parameter manager, bytes as on the wire.
    let mut response = [0; 240];
    let length = drive.serve(&[5, 1, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0], &mut response)?;
    println!("PNU 930: {:02x?}", &response[..length]);
    Ok(())
}
