//! What a network can have that a laboratory with one drive has not: two subnets, two stations of one name or address, a
//! user without the right to raw sockets.

use std::time::Duration;

use system_tests::{Finished, Lab, Side, built, client, judge, simulate, simulate_at};

const SHORT: Duration = Duration::from_secs(20);
/// Shorter than any wait for an answer that cannot come.
const AT_ONCE: Duration = Duration::from_secs(3);

#[track_caller]
fn refused(finished: &Finished, code: i32, words: &[&str]) {
    assert_eq!(finished.code, Some(code), "{finished:?}");
    for words in words {
        assert!(finished.err.contains(words), "{words}: {finished:?}");
    }
}

/// A second address on the interface, and the drive in its subnet.
#[test]
fn the_own_address_is_that_of_the_subnet_of_the_drive() {
    let lab = Lab::new("networks-second");
    lab.address(Side::Controller, "10.0.5.1/24");
    let capture = lab.capture("traffic");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "10.0.5.11/24"]);
    for address in ["akd-1", "10.0.5.11"] {
        let read = client(&lab, &["read", address, "DRV.ACC"]).ok();
        assert!(read.out.contains("3000"), "{read:?}");
    }
    // the drive calls back when the connection is ready: at the address it was spoken to from
    let run = [
        "run",
        "akd-1",
        "--velocity",
        "60rpm",
        "--for",
        "1s",
        "--watchdog",
        "15",
    ];
    client(&lab, &run).ok();
    // both addresses of this machine are its own
    for own in ["192.168.77.11/24", "10.0.5.1/24"] {
        let taken = client(&lab, &["ip", "akd-1", own]);
        refused(&taken, 3, &["this machine's own, on ctl0"]);
    }
    // and from one subnet to the other
    client(&lab, &["ip", "akd-1", "192.168.77.50/24"]).ok();
    client(&lab, &["read", "akd-1", "DRV.ACC"]).ok();
    judge::judge(&capture.stop()).clean().saw("pn_io", 100);
}

#[test]
fn a_drive_in_another_subnet_is_reported_before_any_request() {
    let lab = Lab::new("networks-far");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.5.11/24"]);
    for verb in [
        &["read", "akd-1", "DRV.ACC"][..],
        &["run", "192.168.5.11", "--velocity", "60rpm"],
    ] {
        let mut all = vec!["-i", "ctl0"];
        all.extend(verb);
        let finished = lab.run(Side::Controller, built("profidrive"), all, AT_ONCE);
        refused(
            &finished,
            4,
            &[
                "akd-1 has 192.168.5.11/24, ctl0 has 192.168.77.11/24: two subnets",
                &format!("profidrive ip {} A.B.C.D/NN", verb[1]),
                "ip address add A.B.C.D/24 dev ctl0",
            ],
        );
        assert!(!finished.err.contains("moves the axis"), "{finished:?}");
    }
    // what the hint says helps
    lab.address(Side::Controller, "192.168.5.1/24");
    client(&lab, &["read", "akd-1", "DRV.ACC"]).ok();
}

#[test]
fn two_drives_of_one_name_are_selected_by_mac() {
    let lab = Lab::new("networks-name");
    let (first, second) = ("02:50:4e:00:00:71", "02:50:4e:00:00:72");
    let _one = simulate(
        &lab,
        &["--name", "akd-1", "--ip", "192.168.77.50/24", "--mac", first],
    );
    let _two = simulate(
        &lab,
        &["--name", "akd-1", "--ip", "192.168.77.51/24", "--mac", second],
    );
    for verb in [
        &["read", "akd-1", "DRV.ACC"][..],
        &["write", "akd-1", "DRV.ACC=100rpm/s"],
        &["run", "akd-1", "--velocity", "60rpm"],
        &["name", "akd-1", "akd-3"],
    ] {
        refused(&client(&lab, verb), 4, &[first, second, "use the MAC address"]);
    }
    let scan = client(&lab, &["scan"]).ok();
    assert!(scan.err.contains("2 stations have the name akd-1"), "{scan:?}");
    client(&lab, &["write", second, "DRV.ACC=100rpm/s"]).ok();
    for (drive, acceleration) in [(first, "3000"), (second, "100"), ("192.168.77.51", "100")] {
        let read = client(&lab, &["read", drive, "DRV.ACC"]).ok().out;
        assert!(read.contains(acceleration), "{drive}: {read}");
    }
    client(&lab, &["name", second, "akd-2"]).ok();
    let read = client(&lab, &["read", "akd-2", "DRV.ACC"]).ok().out;
    assert!(read.contains("100"), "{read}");
}

#[test]
fn without_the_right_to_raw_sockets_records_go_by_udp_and_the_rest_is_explained() {
    let lab = Lab::new("networks-right");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    let program = built("profidrive");
    let client = |verb: &[&str]| {
        let mut all = vec!["--bounding-set", "-net_raw", program.to_str().unwrap()];
        all.extend(["-i", "ctl0"]);
        all.extend(verb);
        lab.run(Side::Controller, "setpriv", all, SHORT)
    };
    let read = client(&["read", "192.168.77.50", "DRV.ACC"]).ok();
    assert!(read.out.contains("3000"), "{read:?}");
    assert!(read.err.contains("going by UDP alone"), "{read:?}");
    client(&["write", "192.168.77.50", "DRV.ACC=100rpm/s"]).ok();
    let read = client(&["read", "192.168.77.50", "DRV.ACC"]).ok();
    assert!(read.out.contains("100"), "{read:?}");
    for verb in [
        &["scan"][..],
        &["read", "akd-1", "DRV.ACC"],
        &["run", "192.168.77.50", "--velocity", "60rpm"],
        &["name", "192.168.77.50", "akd-2"],
    ] {
        let finished = client(verb);
        assert!(finished.code.is_some_and(|code| code != 0), "{finished:?}");
        for words in ["cap_net_raw", "given by its IP needs no permission"] {
            let err = finished.err.to_lowercase();
            assert!(err.contains(&words.to_lowercase()), "{verb:?}: {finished:?}");
        }
    }
    let finished = lab.run(
        Side::Device,
        "setpriv",
        [
            "--bounding-set",
            "-net_raw",
            program.to_str().unwrap(),
            "simulate",
            "--name",
            "akd-2",
            "-i",
            "dev0",
        ],
        SHORT,
    );
    assert!(finished.code.is_some_and(|code| code != 0), "{finished:?}");
    assert!(
        finished.err.to_lowercase().contains("cap_net_raw"),
        "{finished:?}"
    );
}

/// Asked on the wire, of the simulations on the same interface, which receive nothing from each other, and of this computer.
#[test]
fn simulate_reports_duplicate_names_and_addresses() {
    let lab = Lab::new("networks-taken");
    let capture = lab.capture("traffic");
    let drive = ["--name", "akd-1", "--ip", "192.168.77.50/24"];
    // two that begin at once would find each other: the check of this one is over when it reports an address of its own computer
    lab.address(Side::Device, "192.168.77.50/24");
    let mut one = simulate(&lab, &drive);
    one.wait_for("this computer's own, on dev0", SHORT);
    let remove = ["addr", "del", "192.168.77.50/24", "dev", "dev0"];
    lab.run(Side::Device, "ip", remove, SHORT).ok();
    // the same again at either end: the two are indistinguishable
    for side in [Side::Device, Side::Controller] {
        let again = [&["simulate", "-i", side.interface()], &drive[..]].concat();
        let again = lab.run(side, built("profidrive"), again, SHORT);
        refused(
            &again,
            1,
            &["the MAC address of akd-1 is in use on this segment: akd-1 ("],
        );
    }
    // another drive of the same name and address may be what is to be tried
    for (side, mac) in [
        (Side::Device, "02:50:4e:00:00:71"),
        (Side::Controller, "02:50:4e:00:00:72"),
    ] {
        let mut other = simulate_at(&lab, side, &[&drive[..], &["--mac", mac]].concat());
        for words in [
            "the name akd-1 is taken on this segment: akd-1 (",
            "the address 192.168.77.50 of akd-1 is taken on this segment: akd-1 (",
        ] {
            other.wait_for(words, SHORT);
        }
        other.interrupt(SHORT).ok();
    }
    // who is no PROFINET station answers by ARP
    let mut plain = simulate(&lab, &["--name", "akd-2", "--ip", "192.168.77.11/24"]);
    let taken = "the address 192.168.77.11 of akd-2 is taken on this segment: 02:50:4e:00:00:02";
    plain.wait_for(taken, SHORT);
    drop(plain);
    let own = ["--name", "akd-2", "--ip", "192.168.77.11/24"];
    let mut own = simulate_at(&lab, Side::Controller, &own);
    own.wait_for("this computer's own, on ctl0", SHORT);
    drop(own);
    // and drives do not take one another for strangers; they are there before all answers are
    let free = [
        "--name",
        "akd-3",
        "--count",
        "3",
        "--ip",
        "192.168.77.60/24",
        "--for",
        "1s",
    ];
    let free = simulate(&lab, &free).finish(SHORT).ok();
    assert!(!free.err.contains("warning"), "{}", free.err);
    judge::judge(&capture.stop())
        .clean()
        .saw("arp", 10)
        .saw("pn_dcp", 10);
}

#[test]
fn an_address_of_the_command_line_is_kept_like_one_by_dcp() {
    let lab = Lab::new("networks-kept");
    let state = lab.folder().join("state");
    let drive = ["--name", "akd-1", "--state", state.to_str().unwrap()];
    let with = |ip: &'static str| [&drive[..], &["--ip", ip]].concat();
    let mut first = simulate(&lab, &with("192.168.77.50/24"));
    client(&lab, &["write", "akd-1", "DRV.ACC=100rpm/s", "DRV.NVSAVE=1"]).ok();
    first.kill();
    let mut second = simulate(&lab, &drive);
    let read = client(&lab, &["read", "192.168.77.50", "DRV.ACC"]).ok();
    assert!(read.out.contains("100"), "{read:?}");
    client(&lab, &["ip", "akd-1", "192.168.77.60/24"]).ok();
    second.kill();
    // what the network said last counts, and is reported
    let third = simulate(&lab, &with("192.168.77.50/24"));
    let finished = "akd-1: the address 192.168.77.60 kept in --state counts, not 192.168.77.50";
    assert!(third.err().contains(finished), "{}", third.err());
    client(&lab, &["read", "192.168.77.60", "DRV.ACC"]).ok();
}

/// Sockets of simulations stand in one folder, whichever network they are in.
#[test]
fn inject_means_the_drive_of_its_own_network() {
    let lab = Lab::new("networks-inject");
    let simulated = |side, last: &str| {
        let mac = format!("02:50:4e:00:00:{last}");
        simulate_at(&lab, side, &["--name", "akd-1", "--mac", &mac])
    };
    let here = simulated(Side::Controller, "71");
    let there = simulated(Side::Device, "72");
    let inject = |side, what: &str| lab.run(side, built("profidrive"), ["inject", "akd-1", what], SHORT);
    let (mut here, mut there) = (here, there);
    inject(Side::Controller, "fault=439").ok();
    here.wait_for("! fault=439", SHORT);
    inject(Side::Device, "fault=702").ok();
    there.wait_for("! fault=702", SHORT);
    assert!(!here.out().contains("702") && !there.out().contains("439"));
    // a second one of the name in one network
    let second = simulated(Side::Controller, "73");
    let finished = inject(Side::Controller, "fault=439");
    refused(
        &finished,
        2,
        &[
            "2 simulations have a drive akd-1",
            "on ctl0, process",
            "IP or MAC",
        ],
    );
    // and two in another one only
    drop((here, second));
    let _second = simulated(Side::Device, "74");
    let finished = inject(Side::Controller, "fault=439");
    refused(&finished, 2, &["on dev0, process", "nsenter"]);
    drop(there);
    let finished = inject(Side::Controller, "fault=439").ok();
    assert!(
        finished.err.contains("is in another network namespace"),
        "{finished:?}"
    );
}

/// AKD PROFINET manual 4.2.5: no Modbus (502), and WorkBench's port 23 is closed too. A client of the kernel learns it at
/// once.
#[test]
fn tcp_connections_to_a_drive_are_refused() {
    let lab = Lab::new("networks-tcp");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    for port in [23, 502] {
        let connect = format!("exec 3<>/dev/tcp/192.168.77.50/{port}");
        let finished = lab.run(Side::Controller, "bash", ["-c", connect.as_str()], AT_ONCE);
        refused(&finished, 1, &["Connection refused"]);
    }
}
