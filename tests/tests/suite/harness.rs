//! The harness itself: a test that cannot fail proves nothing.

use std::path::Path;
use std::time::Duration;

use client::Wait;
use profile::parameter::Dialect;
use system_tests::{Lab, Side, capture_files, compare, judge, memory};

const SHORT: Duration = Duration::from_secs(10);

#[test]
fn two_ends_of_a_cable_reach_each_other_and_nothing_else() {
    let lab = Lab::new("harness-cable");
    lab.address(Side::Device, "192.168.77.50/24");
    let capture = lab.capture("ping");
    lab.run(
        Side::Controller,
        "ping",
        ["-c", "2", "-i", "0.2", "192.168.77.50"],
        SHORT,
    )
    .ok();
    let file = capture.stop();
    judge::judge(&file).clean().saw("icmp", 4).saw("arp", 2);
    let links = lab.run(Side::Device, "ip", ["-o", "link"], SHORT).ok();
    assert_eq!(links.out.lines().count(), 2, "only lo and dev0: {}", links.out);
}

#[test]
fn programs_end_with_their_lab() {
    let lab = Lab::new("harness-end");
    let sleeper = lab.spawn(Side::Device, "sleep", ["1000"]);
    let process = format!("/proc/{}", sleeper.pid());
    assert!(Path::new(&process).join("exe").exists());
    drop(lab);
    assert!(system_tests::wait_until(SHORT, || !Path::new(&process)
        .join("exe")
        .exists()));
    drop(sleeper);
}

#[test]
fn a_program_that_does_not_end_is_ended_and_fails_the_test() {
    let lab = Lab::new("harness-limit");
    let sleeper = lab.spawn(Side::Device, "sleep", ["1000"]);
    let process = format!("/proc/{}", sleeper.pid());
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        let _ = sleeper.finish(Duration::from_millis(300));
    }));
    assert!(outcome.is_err());
    assert!(system_tests::wait_until(SHORT, || !Path::new(&process)
        .join("exe")
        .exists()));
}

#[test]
fn the_judge_finds_what_is_wrong_and_accepts_what_is_right() {
    let files = capture_files();
    assert_eq!(files.len(), 8);
    for file in files {
        let verdict = judge::judge(&file);
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        // one recording holds a write that was made too short on purpose
        let expected = usize::from(name == "pnio-profinetpy-full.pcapng");
        assert_eq!(verdict.errors.len(), expected, "{name}: {:?}", verdict.errors);
        verdict.saw("pn_dcp", 2);
    }
}

#[test]
fn the_dissector_reads_parameter_requests() {
    let file = system_tests::root().join("captures/pnet-profinetpy-b02e-refused.pcapng");
    let frames = judge::parameter_frames(&file);
    let request = &frames[0];
    assert_eq!(request.frame, 19);
    assert_eq!((request.request_id, request.response_id), (Some(1), None));
    assert_eq!(request.addresses, [(0x10, 0, 944, 0)]);
}

/// Every parameter of a drive is read: many have one octet, so the answers carry pad octets, which the dissector does not
/// know. Those frames are not held against us; the same frames with one octet of real damage are.
#[test]
fn a_pad_octet_is_no_damage_and_damage_is_no_pad_octet() {
    let (mut session, world) = memory::network();
    let traffic = memory::listen(world.wire().segment_mut());
    let mut drive = memory::find(&mut session);
    let all = memory::everything(&drive);
    let readings = session.read(&mut drive, &all).wait().unwrap();
    // arrays give one reading for each element
    assert!(readings.len() >= all.len());
    session.close().wait().unwrap();
    let traffic = traffic.lock().unwrap().clone();
    let file = memory::save("every-parameter.pcapng", &traffic);
    let verdict = judge::judge(&file);
    verdict.clean().saw("dcerpc", 100);
    assert!(!verdict.exempted.is_empty(), "no frame with a pad octet");
    let misread = compare::misread(&file);
    assert!(verdict.exempted.is_subset(&misread.padded));
    let jobs = compare::same_parameters(&file, &Dialect::AKD);
    assert!(misread.padded.len() < jobs, "each answer has a pad octet");

    // one parameter more than there is: we do not read such an answer either, so it is not exempted
    for number in verdict.exempted.iter().take(3) {
        let mut damaged = traffic.clone();
        let frame = &mut damaged[number - 1].1;
        // Ethernet, IPv4, UDP, RPC, NDR, read header, then reference, response, axis, count
        let count = 14 + 20 + 8 + 80 + 20 + 64 + 3;
        frame[count] += 1;
        let verdict = judge::judge(&memory::save("damaged.pcapng", &damaged));
        assert!(!verdict.exempted.contains(number));
        assert!(
            verdict
                .errors
                .iter()
                .chain(&verdict.warnings)
                .any(|note| note.starts_with(&format!("{number} |"))),
            "frame {number}: {verdict:?}"
        );
    }
}
