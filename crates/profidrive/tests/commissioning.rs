//! A machine file carried out on drives of three vendors in a plant in memory.
#![cfg(feature = "simulate")]
#![allow(clippy::unwrap_used)]

use std::path::PathBuf;
use std::pin::pin;
use std::time::Duration;

use futures::future::{Either, select};
use profidrive::client::change::Saved;
use profidrive::client::{Drive, ErrorKind, WriteMode};
use profidrive::commissioning::{self, Planned, Purpose};
use profidrive::machine::Machine;
use profidrive::motion::{self, Control, Home, MotionError, Observer, Run};
use profidrive::{Access, Network, Opening, Wait, settings};

const PLANT: &str = r#"
[[drive]]
name = "akd-1"
mac = "02:00:00:00:00:01"
ip = "192.168.0.11/24"
[[drive]]
name = "new"
mac = "02:00:00:00:00:02"
[[drive]]
name = "vlt-1"
model = "vlt"
ip = "192.168.0.31/24"
[[drive]]
name = "vacon-1"
model = "vacon"
ip = "192.168.0.41/24"
"#;

const MACHINE: &str = r#"
[[drive]]
name = "akd-1"
model = "akd"
telegram = 9
[drive.parameters]
"DRV.ACC" = "5000rpm/s"
"DRV.DEC" = "4000rpm/s"
[[drive]]
name = "akd-2"
model = "akd"
mac = "02:00:00:00:00:02"
ip = "192.168.0.12/24"
[drive.parameters]
"DRV.ACC" = "2000rpm/s"
[[drive]]
name = "vlt-1"
model = "vlt"
[drive.parameters]
"3-41" = "4s"
[[drive]]
name = "vacon-1"
model = "vacon"
ip = "192.168.0.41/24"
"#;

struct Bench {
    opening: Opening,
    network: Network,
    folder: PathBuf,
    machine: Machine,
}

impl Bench {
    fn new(name: &str, text: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("profidrive-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("machine.toml");
        std::fs::write(&path, text).unwrap();
        let opening = Opening::new(Access::Records).in_plant(PLANT.parse().unwrap());
        let network = opening.clone().open().unwrap();
        let machine = Machine::read(&path).unwrap();
        Self {
            opening,
            network,
            folder,
            machine,
        }
    }

    fn plan(&mut self, purpose: Purpose) -> Vec<Planned> {
        commissioning::plan(&self.opening, &mut self.network, &self.machine, purpose)
            .wait()
            .unwrap()
    }

    fn carry_out(&mut self, planned: Vec<Planned>) -> Vec<Planned> {
        commissioning::carry_out(&self.opening, &mut self.network, &self.machine, planned, |_| {})
            .wait()
            .unwrap()
    }

    fn find(&mut self, name: &str) -> Drive {
        self.network.find(&name.parse().unwrap()).wait().unwrap()
    }

    fn value(&mut self, name: &str, parameter: &str) -> Option<f64> {
        let mut drive = self.find(name);
        let selection = drive.select(parameter).unwrap();
        let reading = self.network.read_one(&mut drive, &selection).wait().unwrap();
        reading.number()
    }

    fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

fn problems(planned: &[Planned]) -> Vec<String> {
    let objections = planned.iter().flat_map(|one| &one.objections);
    objections.map(ToString::to_string).collect()
}

fn changing(planned: &[Planned]) -> Vec<&str> {
    let changing = planned.iter().filter(|one| one.is_change());
    changing.map(|one| one.wanted.name.as_str()).collect()
}

#[test]
fn a_machine_is_commissioned_once_and_then_nothing_changes() {
    let mut bench = Bench::new("commission", MACHINE);
    let planned = bench.plan(Purpose::Commission);
    assert_eq!(problems(&planned), [""; 0]);
    assert_eq!(changing(&planned), ["akd-1", "akd-2", "vlt-1"]);
    // a plan changes nothing
    assert_eq!(bench.value("akd-1", "DRV.ACC"), Some(3000.0));
    assert_eq!(bench.files(), ["machine.toml"]);

    let done = bench.carry_out(planned);
    assert_eq!(problems(&done), [""; 0]);
    assert!(done.iter().all(|one| one.verified));
    assert_eq!(bench.value("akd-1", "DRV.ACC"), Some(5000.0));
    assert_eq!(bench.value("akd-1", "922"), Some(9.0));
    assert_eq!(bench.value("akd-2", "DRV.ACC"), Some(2000.0));
    assert_eq!(bench.value("vlt-1", "3-41"), Some(4.0));
    assert_eq!(bench.find("akd-2").station.ip.address.to_string(), "192.168.0.12");
    let files = bench.files();
    let ways_back = [
        "machine.toml",
        "machine.toml.akd-1.before-1",
        "machine.toml.akd-2.before-1",
        "machine.toml.vlt-1.before-1",
    ];
    assert_eq!(files, ways_back);

    let again = bench.plan(Purpose::Commission);
    assert_eq!((changing(&again), problems(&again)), (vec![], vec![]));
    let again = bench.carry_out(again);
    assert!(again.iter().all(|one| one.verified && one.way_back.is_none()));
    assert_eq!(bench.files(), ways_back);

    // the way back works
    let way_back = settings::read(&bench.folder.join("machine.toml.akd-1.before-1")).unwrap();
    let mut drive = bench.find("akd-1");
    let request = settings::Restore::default();
    let plan = settings::plan(&mut bench.network, &mut drive, &way_back, &request)
        .wait()
        .unwrap();
    assert_eq!(plan.set.changes()[0].new.number(), Some(3000.0));
}

#[test]
fn drift_is_found_and_nothing_is_written() {
    let mut bench = Bench::new("drift", MACHINE);
    let planned = bench.plan(Purpose::Commission);
    bench.carry_out(planned);
    let mut drive = bench.find("akd-1");
    let assignment = ["DRV.DEC=100rpm/s".parse().unwrap()];
    let written = bench
        .network
        .write(&mut drive, &assignment, WriteMode::Write)
        .wait();
    written.unwrap().accepted().unwrap();
    let drift = bench.plan(Purpose::Compare);
    assert_eq!(changing(&drift), ["akd-1"]);
    let changes = drift[0].settings.as_ref().unwrap().plan.set.changes();
    let names: Vec<_> = changes.iter().map(|change| change.new.name).collect();
    assert_eq!(names, [Some("DRV.DEC")]);
}

#[test]
fn all_objections_come_before_anything_is_written() {
    let text = r#"
[[drive]]
name = "akd-1"
model = "vlt"
[[drive]]
name = "vlt-1"
model = "vlt"
ip = "192.168.0.41/24"
[[drive]]
name = "absent-1"
model = "akd"
[[drive]]
name = "vacon-1"
mac = "02:00:00:00:00:02"
model = "vacon"
[[drive]]
name = "akd-2"
mac = "02:00:00:00:00:07"
model = "akd"
backup = "missing.backup"
"#;
    let mut bench = Bench::new("objections", text);
    let planned = bench.plan(Purpose::Commission);
    let found = problems(&planned);
    for (found, words) in found.iter().zip([
        "akd-1 (line 3): the file says",
        "the address 192.168.0.41 is taken already",
        "absent-1 (line 10) does not answer",
        "vacon-1 (line 13): the station with this name has the MAC address",
        "akd-2 (line 17) does not answer, neither by its name nor as 02:00:00:00:00:07",
    ]) {
        assert!(found.contains(words), "{found}");
    }
    assert_eq!(found.len(), 5, "{found:?}");
    let kinds: Vec<ErrorKind> = planned.iter().map(|one| one.objections[0].kind()).collect();
    assert_eq!(kinds[0], ErrorKind::Safety);
    assert_eq!(kinds[2], ErrorKind::Unreachable);
    // a caller who goes on all the same changes nothing either
    bench.carry_out(planned);
    assert_eq!(bench.files(), ["machine.toml"]);
}

#[test]
fn what_the_drive_cannot_have_has_the_line_of_the_file() {
    let text = r#"
[[drive]]
name = "vacon-1"
model = "vacon"
telegram = 149
[[drive]]
name = "akd-1"
model = "akd"
[drive.parameters]
"DRV.NVSAVE" = 1
"#;
    let mut bench = Bench::new("lines", text);
    let found = problems(&bench.plan(Purpose::Commission));
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].starts_with("vacon-1 (line 3): "), "{found:?}");
    assert!(found[1].starts_with("akd-1 (line 10): DRV.NVSAVE"), "{found:?}");
}

#[test]
fn a_backup_gives_the_settings_and_the_file_has_the_last_word() {
    let text = r#"
[[drive]]
name = "akd-2"
mac = "02:00:00:00:00:02"
ip = "192.168.0.12/24"
model = "akd"
backup = "feed.backup"
[drive.parameters]
"DRV.ACC" = "2500rpm/s"
"#;
    let mut bench = Bench::new("backup", text);
    let mut drive = bench.find("akd-1");
    let assignments = [
        "DRV.ACC=6000rpm/s".parse().unwrap(),
        "DRV.DEC=7000rpm/s".parse().unwrap(),
    ];
    let written = bench
        .network
        .write(&mut drive, &assignments, WriteMode::Write)
        .wait();
    written.unwrap().accepted().unwrap();
    let saved = settings::backup(&mut bench.network, &mut drive, |_, _| {})
        .wait()
        .unwrap();
    std::fs::write(bench.folder.join("feed.backup"), saved.report.to_string()).unwrap();
    let planned = bench.plan(Purpose::Commission);
    assert_eq!(problems(&planned), [""; 0]);
    let done = bench.carry_out(planned);
    assert_eq!(problems(&done), [""; 0]);
    assert_eq!(bench.value("akd-2", "DRV.ACC"), Some(2500.0));
    assert_eq!(bench.value("akd-2", "DRV.DEC"), Some(7000.0));
    let again = bench.plan(Purpose::Commission);
    assert_eq!((changing(&again), problems(&again)), (vec![], vec![]));
}

/// A note of a run that did not end: the settings may be in the drive and not saved.
#[test]
fn a_run_that_did_not_end_is_finished_by_the_next_one() {
    let mut bench = Bench::new("unfinished", MACHINE);
    let planned = bench.plan(Purpose::Commission);
    bench.carry_out(planned);
    let note = bench.folder.join("machine.toml.akd-1.unfinished");
    std::fs::write(&note, "").unwrap();
    let planned = bench.plan(Purpose::Commission);
    assert_eq!(changing(&planned), ["akd-1"]);
    let done = bench.carry_out(planned);
    assert_eq!(problems(&done), [""; 0]);
    let settings = done[0].settings.as_ref().unwrap();
    assert_eq!(settings.plan.set.saved(), Saved::Yes);
    assert!(!note.exists());
}

/// A machine file that was written from the drives says what they are.
#[test]
fn a_file_of_the_drives_that_are_there_differs_from_none_of_them() {
    let mut bench = Bench::new("from", MACHINE);
    let path = bench.folder.join("there.toml");
    let file = commissioning::MachineFile::at(&path, false).unwrap();
    let selector = "akd-1,vlt-1,vacon-1".parse().unwrap();
    let found = bench
        .opening
        .select(&mut bench.network, &selector)
        .wait()
        .unwrap();
    let read = commissioning::from_drives(&bench.network, found.members, &file, |_| {}).wait();
    assert_eq!(read.written.unwrap(), 3);
    for member in read.drives {
        let (drive, backup) = (member.drive.unwrap(), member.result.unwrap());
        assert_eq!(backup.header.ip, Some(drive.station.ip));
        assert!(backup.header.telegram.is_some(), "{}", member.name);
        assert_eq!(settings::read(&file.backup_of(&drive)).unwrap(), backup);
    }
    bench.machine = Machine::read(&path).unwrap();
    assert_eq!(bench.machine.drives.len(), 3);
    let planned = bench.plan(Purpose::Compare);
    assert_eq!((changing(&planned), problems(&planned)), (vec![], vec![]));
}

/// The new drive has neither name nor address; the old one is gone.
#[test]
fn a_new_drive_takes_the_place_of_an_old_one() {
    let mut bench = Bench::new("replace", MACHINE);
    let mut old = bench.find("akd-1");
    let assignments = ["DRV.ACC=6000rpm/s".parse().unwrap(), "922=9".parse().unwrap()];
    let written = bench
        .network
        .write(&mut old, &assignments, WriteMode::Write)
        .wait();
    written.unwrap().accepted().unwrap();
    let backup = settings::backup(&mut bench.network, &mut old, |_, _| {})
        .wait()
        .unwrap()
        .report;
    let file = bench.folder.join("akd-1.backup");
    std::fs::write(&file, backup.to_string()).unwrap();

    let new = bench.find("new");
    bench.machine = Machine::replacement(&new, "akd-1", &file, &backup);
    // as long as the old one answers there are two for one name
    let found = problems(&bench.plan(Purpose::Commission));
    assert!(
        found[0].contains("the station with this name has the MAC address"),
        "{found:?}"
    );

    let plant = PLANT.split_once("[[drive]]\nname = \"new\"").unwrap().1;
    let plant = format!("[[drive]]\nname = \"new\"{plant}");
    bench.opening = Opening::new(Access::Records).in_plant(plant.parse().unwrap());
    bench.network = bench.opening.clone().open().unwrap();
    let planned = bench.plan(Purpose::Commission);
    assert_eq!(problems(&planned), [""; 0]);
    assert!(planned[0].name.is_some() && planned[0].ip.is_some());
    let done = bench.carry_out(planned);
    assert_eq!(problems(&done), [""; 0]);
    let found = bench.find("akd-1");
    assert_eq!(
        (found.station.mac, found.station.ip),
        (new.station.mac, old.station.ip)
    );
    assert_eq!(bench.value("akd-1", "DRV.ACC"), Some(6000.0));
    assert_eq!(bench.value("akd-1", "922"), Some(9.0));
    let again = bench.plan(Purpose::Commission);
    assert_eq!((changing(&again), problems(&again)), (vec![], vec![]));
}

/// Carries a plan out for some virtual time and then ends like a killed program. Returns whether it was done before.
fn killed_after(bench: &mut Bench, time: Duration) -> bool {
    let planned = bench.plan(Purpose::Commission);
    assert_eq!(problems(&planned), [""; 0]);
    let mut clock = bench.network.clone();
    let (opening, machine) = (&bench.opening, &bench.machine);
    let network = &mut bench.network;
    let race = async {
        let work = pin!(commissioning::carry_out(
            opening,
            network,
            machine,
            planned,
            |_| {}
        ));
        let end = pin!(clock.pass(time));
        matches!(select(work, end).await, Either::Left(_))
    };
    race.wait()
}

/// At whatever moment a run is killed: the next one finishes and the values are saved, or the values before come back.
#[test]
fn a_run_that_is_killed_at_any_moment_is_finished_or_taken_back() {
    let mut moments = Vec::new();
    for step in 0..200 {
        let mut bench = Bench::new(&format!("killed-{step}"), MACHINE);
        let after = Duration::from_millis(step * 13);
        let done = killed_after(&mut bench, after);
        moments.push(bench.files().iter().any(|file| file.ends_with(".unfinished")));
        if step % 3 == 2 && !done {
            for name in ["akd-1", "vlt-1"] {
                let file = bench.folder.join(format!("machine.toml.{name}.before-1"));
                // without one, or with an empty one, nothing was written
                let Some(before) = settings::read(&file).ok() else {
                    continue;
                };
                let mut drive = bench.find(name);
                let mut request = settings::Restore::default();
                request.choice.network = true;
                let plan = settings::plan(&mut bench.network, &mut drive, &before, &request).wait();
                let mut plan = plan.unwrap();
                let again = settings::way_back(&file).unwrap();
                let network = &mut bench.network;
                let carried =
                    settings::carry_out(network, &mut drive, &before, &request, &mut plan, &again, |_| {});
                carried.wait().unwrap();
                assert_eq!(
                    settings::shortfall(&plan, &drive, &request),
                    None,
                    "{name} after {after:?}"
                );
            }
            assert_eq!(bench.value("akd-1", "DRV.ACC"), Some(3000.0), "after {after:?}");
            assert_eq!(bench.value("akd-1", "922"), Some(1.0), "after {after:?}");
            assert_eq!(bench.value("vlt-1", "3-41"), Some(3.0), "after {after:?}");
            continue;
        }
        let planned = bench.plan(Purpose::Commission);
        assert_eq!(problems(&planned), [""; 0], "after {after:?}");
        let finished = bench.carry_out(planned);
        assert_eq!(problems(&finished), [""; 0], "after {after:?}");
        assert!(finished.iter().all(|one| one.verified), "after {after:?}");
        let left: Vec<String> = bench
            .files()
            .into_iter()
            .filter(|file| file.ends_with(".unfinished"))
            .collect();
        assert_eq!(left, [""; 0], "after {after:?}");
        assert_eq!(
            changing(&bench.plan(Purpose::Commission)),
            [""; 0],
            "after {after:?}"
        );
        // what the killed run may not have saved is saved by this one
        let mut touched = finished.iter().filter(|one| one.is_change());
        assert!(
            touched.all(|one| one.settings.as_ref().unwrap().plan.set.saved() == Saved::Yes),
            "after {after:?}"
        );
        for (name, parameter, value) in [
            ("akd-1", "DRV.ACC", 5000.0),
            ("akd-1", "DRV.DEC", 4000.0),
            ("akd-2", "DRV.ACC", 2000.0),
            ("vlt-1", "3-41", 4.0),
        ] {
            assert_eq!(
                bench.value(name, parameter),
                Some(value),
                "{name} {parameter}, killed after {after:?}"
            );
        }
        if done {
            break;
        }
    }
    let amid = moments.iter().filter(|unfinished| **unfinished).count();
    assert!(amid > 10, "{amid} of {} moments were within a run", moments.len());
}

/// Speeds of a motion task and of homing are in the drive: only its own limit says that they are within that of the machine.
#[test]
fn the_limit_of_the_machine_counts_for_every_motion() {
    let text = "[[drive]]\nname = \"akd-1\"\nmodel = \"akd\"\nmax-speed = \"100rpm\"\n";
    let mut bench = Bench::new("limits", text);
    bench.opening = Opening::new(Access::Cyclic)
        .in_plant(PLANT.parse().unwrap())
        .on_machine(&bench.machine);
    bench.network = bench.opening.clone().open().unwrap();
    let mut drive = bench.find("akd-1");
    let control = Control {
        set_mode: true,
        ..Control::default()
    };
    let (network, observer) = (&mut bench.network, Observer::default());
    let run = |speed| Run {
        time: Some(Duration::from_millis(100)),
        control,
        ..Run::at(speed)
    };
    let home = Home {
        timeout: Duration::from_secs(20),
        control,
    };
    let above = motion::run(network, &mut drive, &run(101.0), &observer)
        .wait()
        .unwrap_err();
    assert!(
        matches!(above, MotionError::AboveBound { bound, .. } if bound.line == 4),
        "{above}"
    );
    let unknown = motion::home(network, &mut drive, &home, &observer)
        .wait()
        .unwrap_err();
    assert!(matches!(unknown, MotionError::NotBounded { .. }), "{unknown}");
    assert_eq!(unknown.kind(), ErrorKind::Safety);
    motion::run(network, &mut drive, &run(-100.0), &observer)
        .wait()
        .unwrap();
    let limits = [
        "VL.LIMITP=100rpm".parse().unwrap(),
        "VL.LIMITN=-100rpm".parse().unwrap(),
    ];
    let written = network.write(&mut drive, &limits, WriteMode::Write).wait();
    written.unwrap().accepted().unwrap();
    motion::home(network, &mut drive, &home, &observer)
        .wait()
        .unwrap();
}
