//! An independent PROFINET device for the system tests: the `pnio` crate with four modules, or those of a converter.
//!
//! `pnio-device INTERFACE STATION-NAME IP` serves slot 1 (64 octets in), 2 (4 in), 3 (64 out), 4 (4 out) and mirrors
//! outputs to inputs; with `ppo` behind the address what [`ppo`] describes. Prints `ready` once it listens and every change of its connection state; ends when killed or when its
//! standard input closes.
#![forbid(unsafe_code)]

mod ppo;

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
    let (interface, name, ip, converter) = match arguments.as_slice() {
        [interface, name, ip] => (interface, name, ip, None),
        [interface, name, ip, kind] if kind == "ppo" => (interface, name, ip, Some(ppo::Converter::new())),
        _ => {
            eprintln!("usage: pnio-device INTERFACE STATION-NAME IP [ppo]");
            return ExitCode::from(2);
        }
    };
    match serve(interface, name, ip, converter) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("pnio-device: {error}");
            ExitCode::FAILURE
        }
    }
}

fn serve(
    interface: &str,
    name: &str,
    ip: &str,
    mut converter: Option<ppo::Converter>,
) -> Result<(), Box<dyn std::error::Error>> {
    let address: std::net::Ipv4Addr = ip.parse()?;
    let builder = DeviceConfig::builder(name)
        .station_type("pnio device")
        .im0(Im0 {
            order_id: "PNIO-PEER".into(),
            ..Im0::default()
        })
        .min_device_interval(32);
    let builder = if converter.is_some() {
        ppo::modules(builder)
    } else {
        builder
            .input(Slot(1), &[FieldType::Real; 16])
            .input(Slot(2), &[FieldType::Bool; 32])
            .output(Slot(3), &[FieldType::Real; 16])
            .output(Slot(4), &[FieldType::Bool; 32])
    };
    let config = builder.build()?;
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
        if let Some(converter) = &mut converter {
            if device.ready() {
                // a connection that has just ended is reported by the state above
                let _ = converter.work(&device);
            }
        } else if device.ready()
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
