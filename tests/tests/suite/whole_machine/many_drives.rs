//! Our drives and our controller as programs of their own, over a cable.

use std::collections::HashSet;
use std::time::Duration;

use system_tests::{Lab, Side, built, judge, traffic};

/// 64 virtual drives on one interface, one controller process, 16 ms, 10 s. How many cycles a busy machine leaves out is
/// a figure of `make bench`; here no frame may be wrong, and no connection may end.
#[test]
fn sixty_four_drives_and_one_controller() {
    let lab = Lab::alone("many-drives");
    let arguments = [
        "simulate",
        "--model",
        "akd",
        "-i",
        "dev0",
        "--name",
        "akd",
        "--count",
        "64",
        "--ip",
        "192.168.77.101/24",
    ];
    let mut drives = lab.spawn(Side::Device, built("profidrive"), arguments);
    drives.wait_for("64 drives", Duration::from_secs(20));
    let capture = lab.capture("traffic");
    let names: Vec<String> = (1..=64).map(|n| format!("akd-{n}")).collect();
    let arguments = [
        "ctl0",
        "akd",
        &names.join(","),
        "cycle_us=16000",
        "seconds=10",
        "speed=164",
        "hold=10",
    ];
    let finished = lab
        .run(
            Side::Controller,
            built("test-controller"),
            arguments,
            Duration::from_secs(90),
        )
        .ok();
    let file = capture.stop();
    let steps = finished.json_lines();
    let exchanges: Vec<_> = steps.iter().filter(|s| s["step"] == "exchange").collect();
    assert_eq!(exchanges.len(), 64);
    for exchange in &exchanges {
        assert_eq!(
            (&exchange["rejected"], &exchange["disordered"]),
            (&0.into(), &0.into()),
            "{exchange}"
        );
        assert_eq!(exchange["good"], true, "{exchange}");
        // 625 cycles, of which a machine that is held up leaves some out
        let received = exchange["received"].as_u64().unwrap();
        assert!((300..=630).contains(&received), "{exchange}");
        // operation enabled, 60 rpm within a few counts
        let input = u32::from_str_radix(exchange["input"].as_str().unwrap(), 16).unwrap();
        assert_eq!(input >> 16 & 7, 7, "{exchange}");
        assert!((input & 0xFFFF).abs_diff(164) <= 8, "{exchange}");
    }
    let named: HashSet<&str> = exchanges.iter().map(|e| e["name"].as_str().unwrap()).collect();
    assert_eq!(named.len(), 64);
    assert_eq!(steps.iter().filter(|s| s["step"] == "im0").count(), 64);
    assert!(
        steps
            .iter()
            .any(|s| s["step"] == "released" && s["devices"] == 64)
    );

    let filter = "pn_rt.frame_id >= 0x8000 && pn_rt.frame_id < 0xc000 && eth.src != 02:50:4e:00:00:02";
    let addresses: HashSet<String> = judge::fields(&file, filter, &["eth.src"])
        .into_iter()
        .map(|row| row[0].clone())
        .collect();
    assert_eq!(
        addresses.len(),
        64,
        "each drive has an Ethernet address of its own"
    );
    judge::judge(&file)
        .clean()
        .saw("pn_rt", 64 * 2 * 300)
        .saw("pn_dcp", 64)
        .saw("pn_io", 64 * 8);
    let streams = traffic::streams(&file, 512);
    assert_eq!(streams.len(), 128);
    drives.interrupt(Duration::from_secs(5)).ok();
}
