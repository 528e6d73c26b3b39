//! An independent PROFINET device for the system tests: the `pnio` crate with four modules.
//!
//! `pnio-device INTERFACE STATION-NAME IP` serves slot 1 (64 octets in), 2 (4 in), 3 (64 out), 4 (4 out) and mirrors
//! outputs to inputs. Prints `ready` once it listens and every change of its connection state; ends when killed or when its
//! standard input closes.
#![forbid(unsafe_code)]

use std::io::Read;
use std::process::ExitCode;
use std::time::Duration;

use pnio::api::{IoDevice, StartOptions};
use pnio::config::{DeviceConfig, Slot};
use pnio::data::FieldType;
use pnio::device::RtOptions;
use pnio::im::Im0;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [interface, name, ip] = arguments.as_slice() else {
        eprintln!("usage: pnio-device INTERFACE STATION-NAME IP");
        return ExitCode::from(2);
    };
    match serve(interface, name, ip) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("pnio-device: {error}");
            ExitCode::FAILURE
        }
    }
}

fn serve(interface: &str, name: &str, ip: &str) -> Result<(), Box<dyn std::error::Error>> {
    let address: std::net::Ipv4Addr = ip.parse()?;
    let config = DeviceConfig::builder(name)
        .station_type("pnio device")
        .im0(Im0 {
            order_id: "PNIO-PEER".into(),
            ..Im0::default()
        })
        .min_device_interval(32)
        .input(Slot(1), &[FieldType::Real; 16])
        .input(Slot(2), &[FieldType::Bool; 32])
        .output(Slot(3), &[FieldType::Real; 16])
        .output(Slot(4), &[FieldType::Bool; 32])
        .build()?;
    let device = IoDevice::start(
        config,
        StartOptions {
            iface: interface.into(),
            ip: address.octets(),
            rt: Some(RtOptions {
                iface: interface.into(),
                cpu_pin: None,
                rt_priority: None,
                lock_memory: false,
            }),
            app_cpus: None,
            im_store: None,
        },
    )?;
    println!("ready");
    std::thread::spawn(|| {
        let mut rest = Vec::new();
        let _ = std::io::stdin().read_to_end(&mut rest);
        std::process::exit(0);
    });
    let mut state = device.ar_state();
    loop {
        let present = device.ar_state();
        if present != state {
            println!("{present:?}");
            state = present;
        }
        if device.ready()
            && let Ok(output) = device.outputs(Slot(3))
        {
            let _ = device.with_inputs(Slot(1), |input| -> Result<(), pnio::api::ApiError> {
                for index in 0..16 {
                    input.real(index, output.real(index)?)?;
                }
                Ok(())
            });
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
