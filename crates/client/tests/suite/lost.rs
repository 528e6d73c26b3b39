//! A connection that is lost while an axis stops, in virtual time.

use std::time::Duration;
use testbench::running_on;
use testbench::shared::Shared;

use profidrive_client::axis::Purpose;
use profidrive_client::{Action, AxisSettings, Error, Wait, WriteMode};
use profile::value::Assignment;
use testbench::watched::bench;
use testbench::world::{Accident, Transport, World};
use virtual_drive::model;

/// Steps of the medium from the begin of the stop until the cable is cut: well inside the ramp.
const STEPS: usize = 40;

/// Standstill was not seen: a release that claims it would send people to a machine that may turn.
#[test]
fn a_connection_lost_on_the_ramp_is_no_success() {
    let mut bench = bench();
    let slow: Assignment = "DRV.DEC=100rpm/s".parse().expect("an assignment");
    bench
        .session
        .write(&mut bench.drive, &[slow], WriteMode::Write)
        .wait()
        .expect("taken");
    let stops = Shared::new(None);
    let since = stops.clone();
    bench.on_each_step(move |step, wire| {
        if since.get().is_some_and(|begin| step == begin + STEPS) {
            wire.segment.cut(wire.id);
        }
    });
    let mut axis = bench
        .session
        .take_axis(&mut bench.drive, running_on(Purpose::Speed))
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(600.0, None).wait().expect("runs");
    enabled
        .keep_speed(600.0, Duration::from_millis(100))
        .wait()
        .expect("keeps it");
    stops.set(Some(bench.steps.get()));
    drop(enabled);
    axis.stopped().wait().expect("reported with the release");
    let last = axis.status().expect("a status");
    assert!(
        last.lost && last.speed_actual.is_some_and(|speed| speed > 100.0),
        "on the ramp: {last:?}"
    );
    let error = axis.release().wait().expect_err("standstill not seen");
    assert!(matches!(error, Error::ConnectionLost { .. }), "{error}");
}

/// When the medium fails before there is cyclic data, the drive that is out of reach is named anyway.
#[test]
fn a_medium_that_fails_before_cyclic_data_names_the_drive() {
    for transport in [Transport::Profinet, Transport::Fc] {
        let mut failed = 0;
        for at in (0..400).step_by(7).map(Duration::from_millis) {
            let world = World::new(&model::VLT, transport, 7);
            let (mut session, mut drive) = world.client("vlt", transport, 1).expect("found");
            world.plan(at, Accident::Killed);
            let settings = AxisSettings {
                reference_speed: Some(1500.0),
                ..running_on(Purpose::Speed)
            };
            let Err(error) = session.take_axis(&mut drive, settings).wait().map(|_| ()) else {
                continue;
            };
            failed += 1;
            assert!(
                matches!(error, Error::CarrierLost { .. }),
                "{transport:?} {at:?}: {error:?}"
            );
            let text = error.to_string();
            assert!(
                text.starts_with(&format!("{}: connection lost: ", drive.label())),
                "{text}"
            );
            assert!(
                error.advice().is_some_and(|advice| {
                    advice
                        .actions()
                        .any(|action| matches!(action, Action::Status | Action::Stop))
                }),
                "{error:?}"
            );
        }
        assert!(failed > 3, "{transport:?}: {failed}");
    }
}
