//! Two axes at once on a real network, each on a thread of its own. Both turn until Ctrl-C, then both ramp down. When one
//! fails, the other one is stopped too. Moves both axes!
//!
//! `cargo run -p examples --example two_axes -- eth0 akd-1 akd-2`
//!
//! Without hardware: `profidrive simulate --name akd-1 --count 2 --ip 192.168.77.11/24` on the other end of a cable, see
//! README.

use std::error::Error;
use std::process::ExitCode;
use std::thread;
use std::time::Duration;

use profidrive::client::axis::Trouble;
use profidrive::client::{Axis, AxisSettings, Session, StopHandle};
use profidrive::{Access, ForcedExit, Opening, Stop, Wait};

const RPM: f64 = 60.0;
const SECOND: Duration = Duration::from_secs(1);

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [interface, left, right] = arguments.as_slice() else {
        return Err("give a network interface and two drives: eth0 akd-1 akd-2".into());
    };

    // the first Ctrl-C stops along the ramp, the second one by quick stop, the third one ends the program
    let stop = Stop::on_signals_with(ForcedExit::Third)?;
    let network = Opening::new(Access::Cyclic)
        .on(interface)
        .stopped_by(stop)
        .open()?;
    let left = take(&network, left)?;
    let right = take(&network, right)?;
    let (stop_left, stop_right) = (left.stop_handle(), right.stop_handle());
    let ends = thread::scope(|scope| {
        let left = scope.spawn(move || operate(left, &stop_right));
        let right = scope.spawn(move || operate(right, &stop_left));
        [left.join(), right.join()]
    });
    for end in ends {
        end.map_err(|_| "a thread panicked; its axis was stopped")??;
    }
    Ok(())
}

fn take(network: &Session, name: &str) -> Result<Axis, Box<dyn Error>> {
    let mut session = network.clone();
    let mut drive = session.find(&name.parse()?).wait()?;
    Ok(session.take_axis(&mut drive, AxisSettings::default()).wait()?)
}

/// Turns an axis until Ctrl-C, a failure or the stop of the other one, which it then stops too.
fn operate(mut axis: Axis, other: &StopHandle) -> Result<(), profidrive::client::Error> {
    let turned = turn(&mut axis);
    other.stop();
    let released = axis.release().wait();
    match turned {
        Err(
            profidrive::client::Error::Interrupted
            | profidrive::client::Error::Axis {
                trouble: Trouble::Stopped,
                ..
            },
        ) => released,
        turned => turned.and(released),
    }
}

fn turn(axis: &mut Axis) -> Result<(), profidrive::client::Error> {
    let drive = axis.drive().label();
    let mut enabled = axis.enable().wait()?;
    enabled.reach_speed(RPM, None).wait()?;
    loop {
        enabled.keep_speed(RPM, SECOND).wait()?;
        let speed = enabled.status().and_then(|status| status.speed_actual);
        println!("{drive}: {:.2} rpm", speed.unwrap_or(f64::NAN));
    }
}
