//! Controller and device exchange data without allocating, shown by an allocator that counts.

use std::net::SocketAddrV4;
use std::time::{Duration, Instant as Wall};

use profidrive_profinet::controller::{
    ConnectConfig, Controller, ControllerConfig, Event, ModuleConfig, Resolve, SubmoduleConfig, Target,
};
use profidrive_profinet::cyclic::Timing;
use profidrive_profinet::device::{
    self, Device, DeviceConfig, Identity, ModuleDescription, Stored, SubmoduleDescription,
};
use profidrive_profinet::wire::rt::Iops;
use profidrive_profinet::{Endpoint, Instant, IpSuite, MAX_FRAME, MacAddress, Transmit};

const DRIVE: MacAddress = MacAddress([2, 0, 0, 0, 0, 1]);

fn ip(last: u8) -> IpSuite {
    IpSuite {
        address: [10, 0, 0, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0; 4].into(),
    }
}

fn device() -> Device {
    let identity = Identity {
        vendor_id: 0x0105,
        device_id: 1,
        instance: 1,
        station_type: "AKD".into(),
        order_id: "AKD".into(),
        serial_number: "1".into(),
        hardware_revision: 1,
        software_prefix: 'V',
        software_revision: [1, 0, 0],
        profile_id: 0x3A00,
        profile_specific_type: 0,
    };
    let telegram = SubmoduleDescription {
        subslot: 1,
        ident: 0x11,
        api: 0x3A00,
        input_length: 4,
        output_length: 4,
    };
    let modules = vec![ModuleDescription {
        ident: 0x10,
        slots: vec![1],
        submodules: vec![telegram],
    }];
    Device::new(
        DeviceConfig::new(DRIVE, identity, modules),
        Stored {
            name: "drive".into(),
            ip: ip(2),
            ..Stored::default()
        },
    )
}

/// Carries everything that is due, without storing any of it.
fn exchange(now: Instant, a: &mut Controller, b: &mut Device) {
    let mut buffer = [0; MAX_FRAME];
    loop {
        let mut quiet = true;
        while let Some(transmit) = a.poll_transmit(now, &mut buffer) {
            quiet = false;
            give(b, now, ip(1), transmit, &buffer);
        }
        while let Some(transmit) = b.poll_transmit(now, &mut buffer) {
            quiet = false;
            give(a, now, ip(2), transmit, &buffer);
        }
        if quiet {
            return;
        }
    }
}

fn give(to: &mut dyn Endpoint, now: Instant, from: IpSuite, transmit: Transmit, buffer: &[u8]) {
    match transmit {
        Transmit::Frame { length } => to.handle_frame(now, &buffer[..length]),
        Transmit::Datagram {
            destination,
            source_port,
            length,
        } => {
            let source = SocketAddrV4::new(from.address, source_port);
            to.handle_datagram(now, source, destination.port(), &buffer[..length]);
        }
    }
}

fn step(now: &mut Instant, a: &mut Controller, b: &mut Device) {
    exchange(*now, a, b);
    *now = [a.poll_timeout(), b.poll_timeout()]
        .into_iter()
        .flatten()
        .min()
        .expect("cyclic data");
    a.handle_timeout(*now);
    b.handle_timeout(*now);
    exchange(*now, a, b);
}

#[test]
fn cyclic_data_costs_no_allocation_on_either_side() {
    let mut controller = Controller::new(ControllerConfig::new(
        MacAddress([2, 0, 0, 0, 0, 9]),
        ip(1),
        "plc",
        1,
    ));
    let mut device = device();
    let mut now = Instant::ZERO;
    let target = Target {
        name: "drive".into(),
        mac: Some(DRIVE),
        ip: ip(2),
        vendor_id: 0x0105,
        device_id: 1,
        instance: 1,
    };
    let telegram = SubmoduleConfig {
        subslot: 1,
        ident: 0x11,
        input_length: 4,
        output_length: 4,
    };
    let modules = vec![ModuleConfig {
        api: 0x3A00,
        slot: 1,
        ident: 0x10,
        submodules: vec![telegram],
    }];
    let timing = Timing::for_interval(Duration::from_millis(1)).expect("1 ms");
    let config = ConnectConfig {
        resolve: Resolve::Trust,
        ..ConnectConfig::new(modules, timing)
    };
    let ar = controller
        .connect(now, target, config)
        .expect("a good configuration");
    let mut running = false;
    for _ in 0..200 {
        step(&mut now, &mut controller, &mut device);
        while let Some(event) = device.poll_event() {
            if let device::Event::ParameterEnd { ar } = event {
                device.application_ready(now, ar);
            }
        }
        while let Some(event) = controller.poll_event() {
            running |= matches!(event, Event::Running { .. });
        }
    }
    assert!(running);
    let start = Wall::now();
    let cycles = 20_000u32;
    let end = now + Duration::from_millis(u64::from(cycles));
    let allocated = allocations::made_by(|| {
        while now < end {
            let [.., c, d] = (now.as_millis() as u32).to_be_bytes();
            controller
                .set_output(ar, 1, 1, &[4, 0x7F, c, d])
                .expect("the connection is open");
            device.set_input(1, 1, &[0x0F, c, d, 0], Iops::GOOD);
            step(&mut now, &mut controller, &mut device);
        }
    });
    let took = start.elapsed();
    assert_eq!(allocated, 0, "allocations in {cycles} cycles");
    let statistics = controller.statistics(ar).expect("cyclic data");
    assert!(
        statistics.missed == 0 && statistics.received >= 20_000,
        "{statistics:?}"
    );
    println!(
        "{} ns per cycle, both sides and both directions",
        took.as_nanos() / u128::from(cycles)
    );
}
