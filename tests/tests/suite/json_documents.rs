//! Every document of `--json` is what its schema in `docs/schema` says, for every vendor, after success and failure. A
//! Python package that validates JSON Schema is the judge.

use std::io::Write as _;
use std::process::{Command, Stdio};
use std::time::Duration;

use system_tests::{Lab, Running, Side, built, peer, python, root, simulate};

const PLANT: &str = r#"
    [[drive]]
    model = "vacon"
    name = "vacon-1"
    ip = "192.168.77.51/24"
    [[drive]]
    model = "vlt"
    name = "vlt-1"
    ip = "192.168.77.52/24"
    [[drive]]
    name = "akd-1"
    ip = "192.168.77.53/24"
"#;

/// A call and the exit codes that it may end with.
type Call = (&'static str, &'static [i32]);

/// Each drive with a parameter and a fault of its vendor (`PARAM`, `FAULT`) and the name of another drive (`DOUBLE`).
const DRIVES: [[&str; 4]; 3] = [
    ["akd-1", "DRV.ACC", "vlt-1", "439"],
    ["vlt-1", "3-41", "akd-1", "2"],
    ["vacon-1", "ID103", "akd-1", "1"],
];

/// What is called for each drive.
const OF_DRIVES: &[Call] = &[
    ("info", &[0]),
    ("status", &[0, 5]),
    ("status --short", &[0, 5]),
    ("faults", &[0]),
    ("faults --history", &[0]),
    ("read PARAM 922", &[0]),
    ("read NO.SUCH.NAME 922", &[2]),
    ("read 64999", &[3]),
    ("list --filter 922", &[0]),
    ("list --filter 922 --values", &[0]),
    ("list --filter nothing-like-it", &[1]),
    ("describe PARAM", &[0]),
    ("backup", &[0, 1]),
    ("write PARAM=100 --dry-run", &[0, 2]),
    ("write 64999=1", &[2, 3]),
    ("describe NO.SUCH.NAME", &[2]),
    ("blink --for 1ms", &[0]),
    ("name other-1 --dry-run", &[0]),
    ("name Not_Valid", &[2]),
    ("name DOUBLE", &[3]),
    ("ip 192.168.77.60/24 --dry-run", &[0]),
    ("ip 192.168.77.50/24 --gateway 192.168.77.1 --force", &[0]),
    ("read", &[2]),
    ("monitor PARAM 64999 --for 10ms", &[0]),
    ("run --velocity 60rpm --dry-run", &[0, 6]),
    ("run --velocity 20% --for 10ms --may-run-on", &[0, 1, 6]),
    ("step --velocity 0:60rpm --for 100ms", &[0, 1, 6]),
    ("jog --velocity 30rpm --for 100ms --dry-run", &[0, 1, 6]),
    ("jog --velocity 30rpm --for 100ms", &[0, 1, 6]),
    (
        "move --to 1rev --velocity 60rpm --dry-run --set-mode",
        &[0, 1, 5, 6],
    ),
    ("home --set-mode", &[0, 1, 6]),
    ("task 1 --set-mode", &[0, 1, 3, 6]),
    ("stop", &[0]),
    ("ack", &[0]),
    ("backup -o FILE", &[0, 1]),
    ("write PARAM=7", &[0]),
    ("restore FILE --dry-run", &[0]),
    ("restore FILE --only PARAM", &[0]),
    ("restore FILE", &[0, 5]),
    ("inject fault=FAULT", &[0]),
    ("status", &[5]),
    ("status --short", &[5]),
    ("faults", &[0]),
    ("run --velocity 60rpm --may-run-on --for 100ms", &[1, 3]),
    ("ack", &[0]),
    ("faults --history", &[0]),
];

/// What is called besides.
const OTHERS: &[Call] = &[
    ("scan", &[0]),
    ("scan --quick", &[0]),
    ("doctor", &[0, 1]),
    ("doctor akd-1,absent", &[1]),
    ("doctor absent@", &[2]),
    ("doctor fc:no-such-port/1", &[0]),
    ("bundle akd-1,absent -o FOLDER/state.zip", &[4]),
    ("bundle -o FOLDER/state.zip", &[1]),
    ("report vlt-1,vacon-1 -o FOLDER/machine.html", &[0]),
    ("report -o FOLDER/machine.html", &[1]),
    ("status", &[0, 5]),
    ("status akd-1,vlt-1 --short", &[0, 5]),
    ("status absent,akd-1", &[4]),
    ("info all", &[0]),
    ("faults all --history", &[0]),
    ("read all 922", &[0]),
    ("read akd-*,vlt-1 64999", &[3]),
    ("read no-* 922", &[4]),
    ("read all,,akd-1 922", &[2]),
    ("write akd-1,vlt-1 64999=1 --yes", &[2, 3]),
    ("write akd-*,absent DRV.ACC=100 --yes", &[4]),
    ("write akd-* DRV.ACC=100 --dry-run", &[0]),
    ("write akd-* DRV.ACC=100", &[6]),
    ("write akd-*,model=akd DRV.ACC=100 --yes", &[0]),
    ("backup all -o FOLDER/all", &[0, 1]),
    ("backup all", &[2]),
    ("monitor all 922 --for 10ms", &[0]),
    ("record akd-1,vlt-1 922 --for 50ms -o FOLDER/r.csv", &[0]),
    (
        "record akd-1 all --every cycle --for 200ms -o FOLDER/r.parquet",
        &[0, 3, 6],
    ),
    ("record absent 922 -o FOLDER/s.csv", &[4]),
    ("ack all", &[0]),
    ("stop all", &[0]),
    ("stop absent,akd-1", &[4]),
    ("run all --velocity 60rpm", &[2]),
    ("diff akd-1 akd-1", &[0]),
    ("diff akd-1 vlt-1", &[2]),
    ("inject", &[0]),
    ("inject akd-1 fault=439", &[0]),
    ("inject absent fault=439", &[4]),
    ("faults akd-1", &[0]),
    ("ack akd-1 --by-parameter", &[0]),
    ("inject akd-1 fault=439", &[0]),
    ("ack akd-1", &[0]),
    ("ack vlt-1 --by-parameter", &[1]),
    ("home akd-1 --set-mode", &[0]),
    (
        "move akd-1 --to 1rev --relative --velocity 300rpm --set-mode",
        &[0],
    ),
    ("run akd-1 --velocity 9000rpm", &[6]),
    ("inject akd-1 fault=439", &[0]),
    ("status akd-1", &[5]),
    ("info akd-1", &[0]),
    ("info absent", &[4]),
    ("write akd-1 DRV.DEC=1234.567rpm/s MT.NUM=0 AIN.ZERO=1", &[3]),
    ("backup akd-1 -o FOLDER/akd-1.txt", &[0, 1]),
    ("restore vlt-1 FOLDER/akd-1.txt", &[6]),
    ("status absent", &[4]),
    ("read absent 922", &[4]),
    ("reset akd-1 --mode communication", &[6]),
    ("reset akd-1 --mode communication --yes --force", &[0]),
    ("scan --no-such-option", &[2]),
];

/// What is called without any drive.
const WITHOUT_DRIVES: &[Call] = &[
    ("explain 0x047F --as stw1", &[0]),
    ("explain 0x0337 --as zsw1 --mode position", &[0]),
    ("explain 0x047C --as ctw-fc", &[0]),
    ("explain S4 --as state", &[0]),
    ("explain 0x0337 --as state", &[0]),
    ("explain 702 --as fault", &[0]),
    ("explain 999 --as fault --model vlt", &[0]),
    ("explain 0x65 --as error", &[0]),
    ("explain 2 --as error --model vacon", &[0]),
    ("explain 0x42 --as format", &[0]),
    ("explain DE80B500 --as pnio", &[0]),
    ("explain 0x15FA --as pke --model vlt", &[0]),
    ("explain 0x40000001 --as alarm-word", &[0]),
    ("explain nothing --as stw1", &[2]),
    ("decode --hex 0501010110010000032200", &[0, 1]),
    ("decode --hex 047F0000 --telegram 1", &[0]),
    ("decode --hex 15FA000100000000 --as pkw-fc --model vlt", &[0]),
    ("demo --fast --pcap FILE", &[0]),
    ("decode FILE", &[0]),
    ("decode FILE --frame 12", &[0]),
    ("decode FILE --frame 1000000", &[2]),
    ("decode ROOT/captures/README.md", &[1]),
    ("gsdml export --model akd -o FOLDER", &[0]),
    (
        "gsdml show ROOT/tests/descriptions/GSDML-V2.32-Kollmorgen-DriveObject-20170601-103000.xml",
        &[0],
    ),
    (
        "gsdml check ROOT/tests/descriptions/GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml",
        &[0, 1, 5],
    ),
    (
        "simulate ROOT/examples/plants/first.toml --virtual-time --for 5s",
        &[0],
    ),
    ("simulate ROOT/examples/plants/press.toml --virtual-time", &[0]),
    (
        "simulate ROOT/examples/plants/press.toml --virtual-time --for 1s",
        &[5],
    ),
];

/// What stands before a call that uses the network.
const NETWORK: &[&str] = &["--json", "-i", Side::Controller.interface()];

/// Returns how the documents of these calls violate their schemas. `values` replaces words of the calls, `before` stands
/// before each.
#[track_caller]
fn judged(
    lab: &Lab,
    before: &[&str],
    calls: impl IntoIterator<Item = (String, &'static [i32])>,
    values: &[(&str, &str)],
) -> String {
    let mut printed = String::new();
    for (line, codes) in calls {
        let line = values
            .iter()
            .fold(line, |line, (word, value)| line.replace(word, value));
        let mut arguments = before.to_vec();
        arguments.extend(line.split(' '));
        let finished = lab.run(
            Side::Controller,
            built("profidrive"),
            arguments,
            Duration::from_secs(20),
        );
        let code = finished.code.unwrap_or(-1);
        assert!(codes.contains(&code), "{line}: {code} {finished:?}");
        assert!(finished.out.ends_with("}\n"), "{line}: {finished:?}");
        printed += &finished.out;
    }
    complaints(&printed)
}

/// Returns the violations of their schemas by documents.
fn complaints(documents: &str) -> String {
    let mut judge = Command::new(python())
        .arg(peer("json_schema.py"))
        .arg(root().join("docs/schema"))
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    judge
        .stdin
        .take()
        .unwrap()
        .write_all(documents.as_bytes())
        .unwrap();
    let output = judge.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// Returns a laboratory with the drives of [`PLANT`].
fn plant(name: &str) -> (Lab, Running) {
    let lab = Lab::new(&format!("json-documents-{name}"));
    let plant = lab.folder().join("plant.toml");
    std::fs::write(&plant, PLANT).unwrap();
    let drives = simulate(&lab, &[plant.to_str().unwrap()]);
    (lab, drives)
}

/// Calls what is called for each drive, and returns the violations.
fn of_drive([drive, parameter, other, fault]: [&str; 4]) -> String {
    let (lab, _drives) = plant(drive);
    let calls = OF_DRIVES.iter().map(|(line, codes)| {
        let (verb, rest) = line.split_once(' ').unwrap_or((line, ""));
        (format!("{verb} {drive} {rest}").trim_end().to_owned(), *codes)
    });
    let file = format!("{}/{drive}.txt", lab.folder().display());
    let values = [
        ("PARAM", parameter),
        ("DOUBLE", other),
        ("FAULT", fault),
        ("FILE", &file),
    ];
    judged(&lab, NETWORK, calls, &values)
}

#[test]
fn documents_of_every_vendor_are_what_their_schemas_say() {
    // a laboratory each, beside each other: most of the time of a call is waiting
    std::thread::scope(|scope| {
        for drive in DRIVES.map(|drive| scope.spawn(move || of_drive(drive))) {
            let found = drive.join().unwrap();
            assert!(found.is_empty(), "{found}");
        }
    });
}

#[test]
fn documents_of_all_other_calls_are_what_their_schemas_say() {
    let (lab, _drives) = plant("others");
    let (root, folder) = (root(), lab.folder().to_str().unwrap());
    let capture = format!("{folder}/demo.pcapng");
    let values = [
        ("ROOT", root.to_str().unwrap()),
        ("FOLDER", folder),
        ("FILE", &capture),
    ];
    let own = |&(line, codes): &Call| (line.to_owned(), codes);
    let mut found = judged(&lab, NETWORK, OTHERS.iter().map(own), &values);
    found += &judged(&lab, &["--json"], WITHOUT_DRIVES.iter().map(own), &values);
    assert!(found.is_empty(), "{found}");
}

/// A judge that accepts everything would be none.
#[test]
fn a_wrong_document_is_found() {
    let right = r#"{"schema":"profidrive/1","command":"blink","mac":"02:00:00:00:00:01"}"#;
    assert_eq!(complaints(right), "");
    for wrong in [
        r#"{"schema":"profidrive/1","command":"blink"}"#,
        r#"{"schema":"profidrive/1","command":"blink","mac":1}"#,
        r#"{"schema":"profidrive/1","command":"blink","mac":"02:00:00:00:00:01","more":1}"#,
        r#"{"schema":"profidrive/2","command":"blink","mac":"02:00:00:00:00:01"}"#,
        r#"{"schema":"profidrive/1","command":"blink","error":{"kind":"usage"}}"#,
        r#"{"schema":"profidrive/1","command":"error"}"#,
    ] {
        assert!(!complaints(wrong).is_empty(), "{wrong}");
    }
}
