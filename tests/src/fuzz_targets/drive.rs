//! The virtual drives: their life, and what they saved.

use std::time::Duration;

use profile::parameter::Dialect;
use profinet::Instant;
use virtual_drive::drive::{Disconnect, Drive};
use virtual_drive::model;
use virtual_drive::store::Image;

use super::steps::{Step, Steps};

/// The virtual AKD: control words and setpoints (frames), parameter jobs (datagrams), connections lost and found (pauses).
pub fn drive(data: &[u8]) {
    let mut drive = Drive::new(&model::AKD);
    let mut now = Instant::ZERO;
    let mut out = [0; 512];
    let mut connected = false;
    for step in Steps(data) {
        match step {
            Step::Frame(outputs) => {
                now += Duration::from_millis(16);
                let mut inputs = [0; 4];
                let outputs = outputs.first_chunk::<4>();
                drive.tick(now, outputs.map(<[u8; 4]>::as_slice), &mut inputs);
            }
            Step::Datagram(job) => {
                if let Ok(length) = drive.serve(job, &mut out) {
                    assert!(length <= Dialect::AKD.max_block);
                    assert_eq!(out[0], job[0]);
                }
            }
            Step::Wait(time) => {
                if connected {
                    let cause = if time.as_millis() % 2 == 0 {
                        Disconnect::Lost
                    } else {
                        Disconnect::Released
                    };
                    drive.disconnect(cause);
                } else {
                    let _ = drive.connect(1, Duration::from_millis(48));
                }
                connected = !connected;
                now += time;
                drive.tick(now, None, &mut []);
            }
        }
        let speed = drive.axis().speed();
        assert!(
            speed.is_finite() && speed.abs() < 1e5,
            "the axis turns at {speed}"
        );
        let mut events = 0;
        while drive.poll_event().is_some() {
            events += 1;
            assert!(events < 1000);
        }
    }
}

/// A virtual VLT or Vacon with one of its telegrams, both chosen by the first octet: outputs with control words of the
/// model and its parameter channel (frames), parameter jobs in its dialect (datagrams), connections lost and found
/// (pauses).
pub fn converter(data: &[u8]) {
    let Some((choice, data)) = data.split_first() else {
        return;
    };
    let model = if choice & 1 == 0 {
        &model::VLT
    } else {
        &model::VACON
    };
    let telegrams = model.catalogue.device.telegrams;
    let telegram = &telegrams[usize::from(choice >> 1) % telegrams.len()];
    let mut drive = Drive::new(model);
    let mut now = Instant::ZERO;
    let (mut inputs, mut out) = (vec![0; telegram.inputs.into()], [0; 512]);
    drive
        .connect(telegram.telegram, Duration::from_millis(48))
        .unwrap();
    let mut connected = true;
    for step in Steps(data) {
        match step {
            Step::Frame(outputs) => {
                now += Duration::from_millis(16);
                let outputs = outputs.get(..telegram.outputs.into()).filter(|_| connected);
                drive.tick(now, outputs, &mut inputs);
            }
            Step::Datagram(job) => {
                if let Ok(length) = drive.serve(job, &mut out) {
                    assert!(length <= model.known.dialect.max_block);
                    assert_eq!(out[0], job[0]);
                }
            }
            Step::Wait(time) => {
                if connected {
                    let lost = time.as_millis() % 2 == 0;
                    drive.disconnect(if lost {
                        Disconnect::Lost
                    } else {
                        Disconnect::Released
                    });
                } else {
                    // a job may have chosen another telegram meanwhile
                    let _ = drive.connect(telegram.telegram, Duration::from_millis(48));
                }
                connected = !connected;
                now += time;
                drive.tick(now, None, &mut []);
            }
        }
        let speed = drive.axis().speed();
        assert!(
            speed.is_finite() && speed.abs() < 1e5,
            "the motor turns at {speed}"
        );
        let events = std::iter::from_fn(|| drive.poll_event()).take(1000).count();
        assert!(events < 1000);
    }
}

/// The saved state of a drive.
pub fn state(data: &[u8]) {
    if let Ok(image) = Image::decode(data) {
        // comments are not kept, so the text may differ; its contents may not
        let again = Image::decode(image.encode().as_bytes()).unwrap();
        assert!(image.entries().eq(again.entries()));
        assert_eq!(image.model(), again.model());
    }
}
