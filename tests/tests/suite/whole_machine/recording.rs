//! Recordings on a wire, counted against a capture.

use std::collections::HashMap;
use std::path::Path;

use serde_json::Value;
use system_tests::judge::fields;
use system_tests::{Lab, undisturbed};

use crate::recording::{DRIVES, drives, path, record};

/// Every frame between the first and the last row of a drive is a row.
#[test]
fn no_row_is_missing_that_was_on_the_wire() {
    undisturbed(|| {
        let lab = Lab::alone("record-wire");
        let _drives = drives(&lab);
        let file = path(&lab, "wire.csv");
        let capture = lab.capture("wire");
        let every = [
            "--every",
            "cycle",
            "--for",
            "3s",
            "--watchdog",
            "60",
            "--json",
            "-o",
            &file,
        ];
        let done = record(&lab, &[&["akd-*", "all"], &every[..]].concat()).ok();
        let capture = capture.stop();
        let report: Value = serde_json::from_str(&done.out).unwrap();
        assert_eq!(report["signals"].as_array().map(Vec::len), Some(16), "{report}");
        let rows = rows_of(Path::new(&file));
        assert_eq!(rows.len(), DRIVES);
        let on_wire = frames_of(&capture);
        for (drive, times) in &rows {
            let (first, last) = (times[0], times[times.len() - 1]);
            let frames = on_wire[drive]
                .iter()
                .filter(|time| **time > first && **time <= last)
                .count();
            if times.len() < 100 || frames > times.len() {
                return Err(format!("{drive}: {} rows, {frames} frames", times.len()));
            }
        }
        Ok(())
    });
}

/// Times of day of the rows with values, for each drive, s.
fn rows_of(file: &Path) -> HashMap<String, Vec<f64>> {
    let mut rows: HashMap<String, Vec<f64>> = HashMap::new();
    for line in std::fs::read_to_string(file).unwrap().lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        if cells[3] == "false" {
            rows.entry(cells[2].to_owned())
                .or_default()
                .push(time_of_day(cells[1]));
        }
    }
    rows
}

/// Seconds since midnight of `2026-11-24T10:05:11.300811113Z`.
fn time_of_day(text: &str) -> f64 {
    let time = text.split('T').nth(1).unwrap().trim_end_matches('Z');
    let parts: Vec<f64> = time.split(':').map(|part| part.parse().unwrap()).collect();
    parts[0] * 3600.0 + parts[1] * 60.0 + parts[2]
}

/// Times of day of the cyclic frames of each drive.
fn frames_of(capture: &Path) -> HashMap<String, Vec<f64>> {
    let names: HashMap<String, String> = fields(
        capture,
        "pn_dcp.suboption_device_nameofstation && pn_dcp.service_type == 1",
        &["eth.src", "pn_dcp.suboption_device_nameofstation"],
    )
    .into_iter()
    .map(|row| (row[0].clone(), row[1].clone()))
    .collect();
    let mut frames: HashMap<String, Vec<f64>> = HashMap::new();
    // cyclic real-time frames only
    for row in fields(capture, "pn_rt.cycle_counter", &["eth.src", "frame.time_epoch"]) {
        if let Some(name) = names.get(&row[0]) {
            let time: f64 = row[1].parse().unwrap();
            frames.entry(name.clone()).or_default().push(time % 86_400.0);
        }
    }
    frames
}
