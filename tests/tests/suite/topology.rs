//! Who is whose neighbour, asked of both ends by tools that we did not write: net-snmp, lldpd and the dissector.

use std::collections::BTreeMap;
use std::time::Duration;

use serde_json::Value;
use system_tests::{Finished, Lab, Side, built, judge, root, simulate_at, wait_until};

const SHORT: Duration = Duration::from_secs(20);
/// LLDP goes out every 5 s; twice that, and the start of the programs.
const SEEN: Duration = Duration::from_secs(15);
/// lldpRemChassisId, lldpRemPortId and lldpRemSysName.
const REMOTE_CHASSIS: &str = ".1.0.8802.1.1.2.1.4.1.1.5.";
const REMOTE_PORT: &str = ".1.0.8802.1.1.2.1.4.1.1.7.";
const REMOTE_NAME: &str = ".1.0.8802.1.1.2.1.4.1.1.9.";
const LOCAL_CHASSIS: &str = ".1.0.8802.1.1.2.1.3.2.0";
const LOCAL_PORT: &str = ".1.0.8802.1.1.2.1.3.7.1.3.1";
const SYSTEM_NAME: &str = ".1.3.6.1.2.1.1.5.0";

fn ask(lab: &Lab, side: Side, program: &str, version: &str, address: &str, rest: &[&str]) -> Finished {
    // what it keeps goes with the laboratory
    let kept = "SNMP_PERSISTENT_DIR=/run/snmp";
    let mut arguments = vec![kept, program, version, "-c", "public", "-t", "3", "-On", address];
    arguments.extend(rest);
    lab.run(side, "env", arguments, SHORT)
}

/// Everything behind `from`, by its identifier.
#[track_caller]
fn walk(lab: &Lab, side: Side, program: &str, version: &str, address: &str) -> BTreeMap<String, String> {
    let walked = ask(lab, side, program, version, address, &["1"]).ok();
    let lines = walked.out.lines().filter_map(|line| line.split_once(" = "));
    lines
        .filter(|(_, value)| !value.starts_with("No more variables"))
        .map(|(name, value)| (name.to_owned(), value.to_owned()))
        .collect()
}

fn column<'a>(table: &'a BTreeMap<String, String>, column: &str) -> Vec<&'a str> {
    let rows = table.iter().filter(|(name, _)| name.starts_with(column));
    rows.map(|(_, value)| value.as_str()).collect()
}

/// Returns the report of a drive on its neighbours in the end: the column of names has so many rows.
#[track_caller]
fn neighbours(lab: &Lab, side: Side, address: &str, count: usize) -> BTreeMap<String, String> {
    let mut table = BTreeMap::new();
    let seen = wait_until(SEEN, || {
        table = walk(lab, side, "snmpbulkwalk", "-v2c", address);
        let all = column(&table, REMOTE_NAME).len() == count;
        if !all {
            // the next word of a neighbour takes its time
            std::thread::sleep(Duration::from_millis(300));
        }
        all
    });
    assert!(seen, "{count} neighbours at {address}: {table:#?}");
    table
}

/// Two drives, one at each end of a cable: each is the other's neighbour, by SNMP, by the records of its port, and in the
/// words of the client.
#[test]
fn two_drives_at_one_cable_see_each_other() {
    let lab = Lab::new("topology-cable");
    lab.address(Side::Device, "192.168.77.12/24");
    let capture = lab.capture("traffic");
    let _one = simulate_at(
        &lab,
        Side::Device,
        &["--name", "akd-1", "--ip", "192.168.77.50/24"],
    );
    let _two = simulate_at(
        &lab,
        Side::Controller,
        &["--name", "akd-2", "--ip", "192.168.77.60/24"],
    );
    // each is asked from the other end
    let one = neighbours(&lab, Side::Controller, "192.168.77.50", 1);
    let two = neighbours(&lab, Side::Device, "192.168.77.60", 1);
    for (own, other, name, neighbour) in [(&one, &two, "akd-1", "akd-2"), (&two, &one, "akd-2", "akd-1")] {
        let quoted = |text: &str| format!("STRING: \"{text}\"");
        assert_eq!(own[SYSTEM_NAME], quoted(name));
        assert_eq!(column(own, REMOTE_NAME), [quoted(neighbour)]);
        // what one says of itself is what the other says of it
        assert_eq!(column(own, REMOTE_CHASSIS), [&other[LOCAL_CHASSIS]]);
        assert_eq!(column(own, REMOTE_PORT), [&other[LOCAL_PORT]]);
    }

    // both ways of walking, and the older version without what it does not know
    let slow = walk(&lab, Side::Controller, "snmpwalk", "-v2c", "192.168.77.50");
    let old = walk(&lab, Side::Controller, "snmpwalk", "-v1", "192.168.77.50");
    assert!(slow.keys().eq(one.keys()), "{slow:#?}");
    let without_wide = one.iter().filter(|(_, value)| !value.starts_with("Counter64"));
    assert!(old.keys().eq(without_wide.map(|(name, _)| name)), "{old:#?}");
    assert!(slow.len() > 80 && old.len() < slow.len());

    // nothing can be set, and other communities get no answer
    let name = [SYSTEM_NAME, "s", "mine"];
    let set = ask(&lab, Side::Controller, "snmpset", "-v2c", "192.168.77.50", &name);
    assert!(set.code != Some(0) && set.err.contains("noAccess"), "{}", set.err);
    let set = ask(&lab, Side::Controller, "snmpset", "-v1", "192.168.77.50", &name);
    assert!(
        set.code != Some(0) && set.err.contains("noSuchName"),
        "{}",
        set.err
    );
    let stranger = ["-c", "private", "-t", "1", "-r", "0", SYSTEM_NAME];
    let stranger = ask(
        &lab,
        Side::Controller,
        "snmpget",
        "-v2c",
        "192.168.77.50",
        &stranger,
    );
    assert!(stranger.err.contains("Timeout"), "{}", stranger.err);

    let info = ["--json", "-i", "ctl0", "info", "192.168.77.50"];
    let info = lab.run(Side::Controller, built("profidrive"), info, SHORT).ok();
    let info: Value = serde_json::from_str(&info.out).unwrap();
    let peer = &info["neighbours"][0];
    assert_eq!(
        (&peer["own_port"], &peer["port"]),
        (&"port-001".into(), &"port-001".into())
    );
    assert_eq!(peer["station"], "akd-2");

    let file = capture.stop();
    let verdict = judge::judge(&file);
    verdict.clean().saw("lldp", 3).saw("snmp", 100).saw("dcerpc", 10);
    assert!(verdict.warnings.is_empty(), "{:?}", verdict.warnings);
    // the dissector reads the same
    let rows = judge::fields(
        &file,
        "lldp",
        &[
            "lldp.tlv.system.name",
            "lldp.port.id",
            "lldp.profinet.cm_mac_add",
            "eth.src",
        ],
    );
    for name in ["akd-1", "akd-2"] {
        let line = rows
            .iter()
            .find(|line| line[0] == name)
            .unwrap_or_else(|| panic!("{rows:?}"));
        assert_eq!((&line[1][..], &line[2]), ("port-001", &line[3]));
    }
    let columns = ["pn_io.peer_port_id", "pn_io.peer_chassis_id"];
    let peers = judge::fields(&file, columns[0], &columns);
    assert_eq!(peers[0], ["port-001", "akd-2"]);
}

// lldpd changes to a user of its own. A user namespace has only one user: here that user gets its name, and dropping
// further groups, which is forbidden there, succeeds without effect.
const SPEAKER: &str = r#"set -e
mkdir -p /run/lldpd /run/etc
sed 's/^_lldpd:.*/_lldpd:x:0:0::\/run\/lldpd:\/bin\/false/' /etc/passwd >/run/etc/passwd
sed 's/^_lldpd:.*/_lldpd:x:0:/' /etc/group >/run/etc/group
mount --bind /run/etc/passwd /etc/passwd
mount --bind /run/etc/group /etc/group
exec strace -f -qqq -o /dev/null --seccomp-bpf -e trace=setgroups -e inject=setgroups:retval=0 \
    lldpd -d -I ctl0 -u "$1" -O /dev/null -L "$2"
"#;

/// Two drives behind one interface and an independent speaker of LLDP at the other end.
#[test]
fn lldpd_sees_the_drives_and_they_see_it() {
    let lab = Lab::new("topology-lldpd");
    let socket = "/run/lldpd.socket";
    // where the system keeps it, it is for administrators only
    let control = root().join("target/lldpcli");
    assert!(control.exists(), "lldpcli is not there: run `make setup`");
    let control = control.to_str().unwrap();
    let arguments = ["-c", SPEAKER, "speaker", socket, control];
    let mut speaker = lab.spawn(Side::Controller, "sh", arguments);
    speaker.wait_for("lldpd should resume operations", SHORT);
    let ask_speaker = |words: &[&str]| {
        let mut arguments = vec!["-u", socket, "-f", "json"];
        arguments.extend(words);
        lab.run(Side::Controller, control, arguments, SHORT).ok().out
    };
    ask_speaker(&["configure", "lldp", "tx-interval", "1"]);
    let drives = ["--name", "akd", "--count", "2", "--ip", "192.168.77.50/24"];
    let drives = simulate_at(&lab, Side::Device, &drives);

    let mut seen = BTreeMap::new();
    let found = wait_until(SEEN, || {
        let shown: Value = serde_json::from_str(&ask_speaker(&["show", "neighbors"])).unwrap();
        seen = interfaces(&shown);
        seen.len() == 2
    });
    assert!(found, "{seen:?}");
    for (name, address) in [("akd-1", "192.168.77.50"), ("akd-2", "192.168.77.51")] {
        assert_eq!(seen[name], ("port-001".into(), address.into()));
        let table = neighbours(&lab, Side::Controller, address, 1);
        assert_eq!(table[SYSTEM_NAME], format!("STRING: \"{name}\""));
        let mac = "Hex-STRING: 02 50 4E 00 00 02 ";
        assert_eq!(column(&table, REMOTE_PORT)[0].trim_end(), mac.trim_end());
        let described = column(&table, ".1.0.8802.1.1.2.1.4.1.1.8.");
        assert_eq!(described, ["STRING: \"ctl0\""]);
    }

    // a drive that is named takes its old name back at once; one that is silent is forgotten after 20 s
    let name = ["-i", "ctl0", "name", "akd-2", "akd-9", "--force"];
    lab.run(Side::Controller, built("profidrive"), name, SHORT).ok();
    let renamed = wait_until(Duration::from_secs(5), || {
        let shown: Value = serde_json::from_str(&ask_speaker(&["show", "neighbors"])).unwrap();
        seen = interfaces(&shown);
        seen.keys().eq(["akd-1", "akd-9"])
    });
    assert!(renamed, "{seen:?}");
    speaker.kill();
    let forgotten = wait_until(Duration::from_secs(10), || {
        let table = walk(&lab, Side::Controller, "snmpbulkwalk", "-v2c", "192.168.77.50");
        column(&table, REMOTE_NAME).is_empty()
    });
    assert!(forgotten, "a neighbour with a TTL of 4 s stays for longer");
    drives.interrupt(Duration::from_secs(5)).ok();
}

/// Name, port and address of every neighbour that lldpd shows.
fn interfaces(shown: &Value) -> BTreeMap<String, (String, String)> {
    let list = match &shown["lldp"]["interface"] {
        Value::Array(list) => list.clone(),
        Value::Object(_) => vec![shown["lldp"]["interface"].clone()],
        _ => Vec::new(),
    };
    list.iter()
        .filter_map(|interface| {
            let seen = &interface["ctl0"];
            let (name, chassis) = seen["chassis"].as_object()?.iter().next()?;
            let port = seen["port"]["id"]["value"].as_str()?;
            let address = chassis["mgmt-ip"].as_str()?;
            Some((name.clone(), (port.to_owned(), address.to_owned())))
        })
        .collect()
}
