//! The cyclic connection of a command on an ordinary PC: calm where nothing else is requested, and measured before
//! anything is enabled. In virtual time.

use std::time::Duration;
use testbench::shared::On;

use network::host::Host;
use network::segment::SegmentMedium;
use profidrive_client::axis::Purpose;
use profidrive_client::{AxisSettings, DriveAddress, Engine, Network, Wait, Wire};
use profinet::cyclic::Timing;
use profinet::device::Stored;
use profinet::{Instant, MacAddress, Medium};
use testbench::{bench_of, find, ip, parts_of, running_on};
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

/// The one of the stations that takes update times from 4 ms on.
const VLT: &str = "drive-2";
const MS: Duration = Duration::from_millis(1);

/// A medium whose waits end late: what a busy PC is.
struct Busy {
    medium: SegmentMedium,
    late: Duration,
}

impl Wire for Busy {
    type Error = std::convert::Infallible;

    fn now(&self) -> Instant {
        Medium::now(&self.medium)
    }

    fn step(&mut self, client: &mut Engine, until: Instant) -> Result<(), Self::Error> {
        let end = until + self.late;
        while Wire::now(self) < end {
            Medium::step(&mut self.medium, client, end)?;
        }
        Ok(())
    }
}

fn stations() -> Vec<Box<Host<Station>>> {
    let station = |(last, model)| {
        let mut config = StationConfig::new(model, MacAddress([2, 0, 0, 0, 0, last]));
        config.network = Stored {
            name: format!("drive-{last}"),
            ip: ip(last),
            ..Stored::default()
        };
        Box::new(Host::new(Station::new(config)))
    };
    (1..).zip(model::ALL).map(station).collect()
}

/// A PC that does nothing for 90 ms while a motor turns keeps its connection, whatever the vendor.
#[test]
fn a_default_connection_outlives_a_busy_pc() {
    let (mut session, ids) = bench_of(stations());
    for (number, _) in (1..).zip(ids) {
        let mut drive = find(&mut session, &format!("drive-{number}")).expect("there");
        let mut axis = session
            .take_axis(&mut drive, running_on(Purpose::Speed))
            .wait()
            .expect("connected");
        assert_eq!(axis.cycle(), MS * 16);
        let mut enabled = axis.enable().wait().expect("enabled");
        enabled.reach_speed(300.0, None).wait().expect("turns");
        for _ in 0..3 {
            let end = session.now() + MS * 90;
            session.medium().segment_mut().run_until(end);
            enabled.hold(MS * 500).wait().expect("still connected");
        }
        drop(enabled);
        axis.release().wait().expect("released");
    }
}

/// The delays of the PC are known before the power stage is on, and judged by the cycle that is requested.
#[test]
fn a_cycle_the_pc_cannot_keep_is_detected_before_enabling() {
    let strained = |late, cycle, watchdog, purpose| {
        let (medium, config, ids) = parts_of(stations());
        let mut session = On::new(Network::on(Busy { medium, late }, config));
        let address: DriveAddress = VLT.parse().expect("an address");
        let mut drive = session.find(&address).wait().expect("there");
        let settings = AxisSettings {
            cycle,
            watchdog,
            ..running_on(purpose)
        };
        let axis = session.take_axis(&mut drive, settings).wait().expect("connected");
        let strained = axis.strained();
        let medium = session.medium();
        let host = medium
            .medium
            .segment()
            .station::<Host<Station>>(ids[1])
            .expect("the drive");
        assert!(!host.endpoint().drive().is_enabled());
        strained.map(|strained| strained.to_string())
    };
    let late = MS * 9;
    let words = strained(late, Some(MS * 4), None, Purpose::Speed).expect("9 ms are more than 4 ms");
    assert!(
        words.starts_with("this PC holds a cycle of 4 ms badly: longest delay 9 ms"),
        "{words}"
    );
    assert_eq!(strained(late, None, None, Purpose::Speed), None);
    assert_eq!(
        strained(Duration::ZERO, Some(MS * 4), Some(3), Purpose::Speed),
        None
    );
    assert!(strained(late, None, Some(2), Purpose::Speed).is_some(), "32 ms");
    // who stops or acknowledges is not made to wait
    assert_eq!(strained(late, Some(MS * 4), None, Purpose::Control), None);
}

/// The device description decides over the update times, also over those requested.
#[test]
fn update_times_are_those_of_the_device_description() {
    let (mut session, _) = bench_of(stations());
    let mut drive = find(&mut session, VLT).expect("there");
    let times = |times: &[u64]| {
        let times = times.iter().map(|&time| Timing::for_interval(MS * time as u32));
        times.collect::<Option<Vec<_>>>().expect("update times")
    };
    for (allowed, cycle) in [(times(&[1, 2, 4, 8]), MS * 8), (times(&[32, 64]), MS * 32)] {
        drive.vendor_timings = allowed;
        let axis = session
            .take_axis(&mut drive, running_on(Purpose::Speed))
            .wait()
            .expect("connected");
        assert_eq!(axis.cycle(), cycle);
        axis.release().wait().expect("released");
    }
    let asked = AxisSettings {
        cycle: Some(MS * 4),
        ..running_on(Purpose::Speed)
    };
    let error = session
        .take_axis(&mut drive, asked)
        .wait()
        .expect_err("not in the description");
    assert!(error.to_string().contains("update time"), "{error}");
}
