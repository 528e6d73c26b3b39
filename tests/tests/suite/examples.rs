//! All programs in `examples/` do what they are there to show: those with a plant in memory at once, those for a real network
//! in a laboratory.

use std::collections::BTreeSet;
use std::process::Command;
use std::time::Duration;

use system_tests::{Finished, Lab, Side, built, client, root, simulate, wait_until};

const SHORT: Duration = Duration::from_secs(20);

/// Examples without a network, with their arguments and parts of what they print. `FILE` is a file to write.
const IN_MEMORY: [(&str, &[&str], &[&str]); 10] = [
    ("capture", &["FILE"], &["01:0e:cf:00:00:00  FrameId(0xFEFE)"]),
    (
        "device_description",
        &[],
        &["octets, 0 problems", "Standard telegram 1"],
    ),
    (
        "first_program",
        &["examples/plants/one_drive.toml", "akd-1"],
        &["waits: not commanded", "DRV.ACC = 3000 rpm/s"],
    ),
    ("move_axis", &[], &["at 10.000 rev\nat 9.000 rev\nat 0.000 rev\n"]),
    ("parameter_bytes", &[], &["p0930 = Some(2)", "p65534 refused"]),
    (
        "read_and_write",
        &[],
        &["DRV.ACC 3000 -> 5000: written, read back"],
    ),
    ("record_samples", &[], &["time_ms,number,missed", "0x047F"]),
    ("run_axis", &[], &["60.04 rpm", "stopped at 0.00 rpm"]),
    ("state_machine", &[], &["S4 operation", "AKD manual 7.1.4"]),
    ("virtual_drive", &[], &["NIST_A 164", "NIST_A 0"]),
];
/// Examples that need a network.
const ON_A_NETWORK: [&str; 1] = ["two_axes"];

fn run(name: &str, arguments: &[&str]) -> Finished {
    let file = root().join("target/system").join(format!("example-{name}"));
    let arguments = arguments.iter().map(|argument| match *argument {
        "FILE" => file.clone().into_os_string(),
        other => other.into(),
    });
    std::fs::create_dir_all(root().join("target/system")).unwrap();
    let mut program = Command::new(built(&format!("examples/{name}")));
    let ended = program.current_dir(root()).args(arguments).output().unwrap();
    let [out, err] = [ended.stdout, ended.stderr].map(|text| String::from_utf8(text).unwrap());
    Finished {
        name: name.into(),
        code: ended.status.code(),
        out,
        err,
    }
}

#[test]
fn no_example_is_left_out() {
    let files = std::fs::read_dir(root().join("examples")).unwrap();
    let names = files.filter_map(|file| {
        Some(
            file.unwrap()
                .file_name()
                .to_str()?
                .strip_suffix(".rs")?
                .to_owned(),
        )
    });
    let tested = IN_MEMORY.iter().map(|(name, ..)| *name).chain(ON_A_NETWORK);
    assert_eq!(names.collect::<BTreeSet<_>>(), tested.map(String::from).collect());
}

#[test]
fn examples_in_memory_print_the_same_in_every_run() {
    for (name, arguments, parts) in IN_MEMORY {
        let finished = run(name, arguments).ok();
        for part in parts {
            assert!(finished.out.contains(part), "{part}: {finished:?}");
        }
        assert_eq!(run(name, arguments).out, finished.out);
    }
}

#[test]
fn an_example_without_its_plant_names_the_file() {
    let finished = run("first_program", &["examples/plants/none.toml", "akd-1"]);
    assert_eq!(finished.code, Some(1), "{finished:?}");
    assert!(finished.err.contains("examples/plants/none.toml"), "{finished:?}");
}

#[test]
fn the_first_program_on_a_real_network() {
    let lab = Lab::new("examples-first");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    let run = |interface: &str| {
        let program = built("examples/first_program");
        lab.run(Side::Controller, program, [interface, "akd-1"], SHORT)
    };
    let finished = run(Side::Controller.interface()).ok();
    for line in ["waits: not commanded", "DRV.ACC = 3000 rpm/s"] {
        assert!(finished.out.contains(line), "{line}: {finished:?}");
    }
    let finished = run("eth99");
    assert_eq!(finished.code, Some(1), "{finished:?}");
    assert!(finished.err.contains("eth99"), "{finished:?}");
}

#[test]
fn two_axes_turn_until_one_of_them_or_the_program_is_stopped() {
    let lab = Lab::new("examples-two-axes");
    let _drives = simulate(
        &lab,
        &["--name", "akd", "--count", "2", "--ip", "192.168.77.50/24"],
    );
    let names = ["akd-1", "akd-2"];
    let start = || {
        let program = built("examples/two_axes");
        let interface = Side::Controller.interface();
        let mut program = lab.spawn(Side::Controller, program, [interface, names[0], names[1]]);
        for name in names {
            let turns = format!("{name}: 60.");
            program.wait_for(&turns, SHORT);
        }
        program
    };
    let at_rest = || {
        for name in names {
            let rests = wait_until(SHORT, || {
                let status = client(&lab, &["status", name]).out;
                status.contains("not commanded") || status.contains("fault")
            });
            assert!(rests, "{name}: {}", client(&lab, &["status", name]).out);
        }
    };
    start().interrupt(SHORT).ok();
    at_rest();
    // a fault of the one stops the other
    let program = start();
    client(&lab, &["inject", "akd-1", "fault=439"]).ok();
    let finished = program.finish(SHORT);
    assert_eq!(finished.code, Some(1), "{finished:?}");
    assert!(finished.err.contains("akd-1"), "{finished:?}");
    at_rest();
}
