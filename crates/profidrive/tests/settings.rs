//! Settings of drives in a plant in memory: saved, compared, restored with every check.
#![cfg(feature = "simulate")]

use profidrive::client::backup::Backup;
use profidrive::client::change::Choice;
use profidrive::client::{Drive, ErrorKind, WriteMode};
use profidrive::settings::{
    self, BackupFile, CompareError, Comparison, FileError, Restore, RestoreError, Shortfall, carry_out,
};
use profidrive::{Explained, Network, Outcome, Wait};

const PLANT: &str = r#"
[[drive]]
name = "akd-1"
ip = "10.0.0.1/24"
[[drive]]
name = "akd-2"
ip = "10.0.0.2/24"
[[drive]]
name = "vlt-1"
model = "vlt"
ip = "10.0.0.3/24"
[[controller]]
drive = "akd-2"
telegram = 1
"#;

fn find(network: &mut Network, name: &str) -> Drive {
    network
        .find(&name.parse().expect("a name"))
        .wait()
        .expect("there")
}

fn open(name: &str) -> (Network, Drive) {
    let mut network = profidrive::open_plan(PLANT.parse().expect("a plant")).expect("opens");
    let drive = find(&mut network, name);
    (network, drive)
}

fn saved(network: &mut Network, drive: &mut Drive) -> Backup {
    let read = settings::backup(network, drive, |_, _| {}).wait().expect("read");
    assert_eq!(read.outcome, settings::outcome(&read.report));
    read.report
}

fn write(network: &mut Network, drive: &mut Drive, assignment: &str) {
    let assignment = assignment.parse().expect("an assignment");
    let set = network.write(drive, &[assignment], WriteMode::Write).wait();
    set.expect("answered").accepted().expect("accepted");
}

fn folder(name: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("profidrive-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// The motion tasks take as long as the settings: progress that leaves them out would stand still.
#[test]
fn progress_counts_the_motion_tasks_too_and_reaches_its_end() {
    let (mut network, mut drive) = open("akd-1");
    let mut seen = Vec::new();
    let read = settings::backup(&mut network, &mut drive, |done, all| seen.push((done, all)))
        .wait()
        .expect("read");
    let settings = read.report.readings().len() + read.report.refused().len();
    let (done, all) = *seen.last().expect("reported");
    assert!(
        done == all && all > settings,
        "{done} of {all}, {settings} settings"
    );
    assert!(seen.iter().all(|&(done, of)| done <= of && of == all), "{seen:?}");
    assert!(seen.is_sorted(), "{seen:?}");
    let of_tasks = seen.iter().filter(|(done, _)| (all - 128..all).contains(done));
    assert!(of_tasks.count() >= 128, "each task is a step");
}

#[test]
fn a_changed_setting_is_found_restored_and_brought_back() {
    let (mut network, mut drive) = open("akd-1");
    let folder = folder("settings");
    let path = folder.join("akd-1.backup");
    let file = BackupFile::at(&path, false).expect("free");
    let before = saved(&mut network, &mut drive);
    assert_eq!(settings::outcome(&before), Outcome::Complete);
    assert!(file.write(&before).expect("written"));
    // the same content once more changes nothing
    assert!(!BackupFile::at(&path, false).unwrap().write(&before).unwrap());
    write(&mut network, &mut drive, "DRV.ACC=4000");
    let now = saved(&mut network, &mut drive);
    let read = settings::read(&path).expect("readable");
    let comparison = Comparison::new(&read, &now).expect("one model");
    assert_eq!((comparison.count(), comparison.of_connection()), (1, 0));
    assert_eq!(comparison.outcome(), Outcome::Difference);

    let wanted = Restore::default();
    let mut plan = settings::plan(&mut network, &mut drive, &read, &wanted)
        .wait()
        .expect("it fits");
    assert_eq!(plan.set.total(), 1);
    let short = settings::shortfall(&plan, &drive, &wanted);
    assert!(matches!(short, Some(Shortfall::Differs { .. })), "{short:?}");
    let way_back = settings::way_back(&path).expect("a place");
    // a way back is never over a file: nothing is written then
    std::fs::write(&way_back, "precious").expect("written");
    let refused = carry_out(
        &mut network,
        &mut drive,
        &read,
        &wanted,
        &mut plan,
        &way_back,
        |_| (),
    )
    .wait();
    let refused = refused.unwrap_err();
    assert!(
        matches!(refused, RestoreError::WayBack { .. }) && refused.kind() == ErrorKind::Local,
        "{refused}"
    );
    assert_eq!(std::fs::read_to_string(&way_back).expect("kept"), "precious");
    assert_eq!(
        plan.set.count(|step| *step != client::change::Step::NotWritten),
        0
    );
    let way_back = settings::way_back(&path).expect("the next place");
    carry_out(
        &mut network,
        &mut drive,
        &read,
        &wanted,
        &mut plan,
        &way_back,
        |_| (),
    )
    .wait()
    .expect("written");
    assert_eq!(settings::shortfall(&plan, &drive, &wanted), None);
    let restored = saved(&mut network, &mut drive);
    assert_eq!(
        Comparison::new(&read, &restored).unwrap().outcome(),
        Outcome::Complete
    );
    // the value before is in the way back
    let back = settings::read(&way_back).expect("a backup too");
    let value = |backup: &Backup| backup.reading(2108, None).and_then(|reading| reading.number());
    assert_eq!((value(&back), value(&restored)), (Some(4000.0), Some(3000.0)));
    std::fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn settings_of_another_kind_of_drive_are_refused_unless_forced() {
    let (mut network, mut akd) = open("akd-1");
    let of_akd = saved(&mut network, &mut akd);
    let mut vlt = find(&mut network, "vlt-1");
    let wanted = Restore::default();
    let error = settings::plan(&mut network, &mut vlt, &of_akd, &wanted)
        .wait()
        .map(|_| ())
        .unwrap_err();
    assert!(matches!(error, RestoreError::Misfit(_)), "{error}");
    assert_eq!(error.kind(), ErrorKind::Safety);
    let compared = settings::as_in(&mut network, &mut vlt, &of_akd).wait();
    assert!(matches!(compared, Err(CompareError::Misfit(_))));
    let of_vlt = saved(&mut network, &mut vlt);
    let error = Comparison::new(&of_akd, &of_vlt).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Usage);
    assert_eq!(
        error.to_string(),
        "AKD and VLT are two models: their parameters cannot be compared"
    );
    let forced = Restore {
        force: true,
        dry_run: true,
        ..Restore::default()
    };
    settings::plan(&mut network, &mut vlt, &of_akd, &forced)
        .wait()
        .expect("forced");
}

#[test]
fn a_controller_keeps_settings_from_being_restored() {
    let (mut network, mut free) = open("akd-1");
    let before = saved(&mut network, &mut free);
    let mut drive = find(&mut network, "akd-2");
    let plan = |network: &mut Network, drive: &mut Drive, wanted: &Restore| {
        settings::plan(network, drive, &before, wanted).wait()
    };
    let error = plan(&mut network, &mut drive, &Restore::default()).unwrap_err();
    assert!(
        matches!(&error, RestoreError::Controlled { drive, .. } if drive.contains("akd-2")),
        "{error}"
    );
    assert_eq!(error.kind(), ErrorKind::Safety);
    let looked = Restore {
        dry_run: true,
        ..Restore::default()
    };
    let mut looked_at = plan(&mut network, &mut drive, &looked).expect("a look only");
    let short = settings::shortfall(&looked_at, &drive, &looked).expect("without its motion tasks");
    assert_eq!(short.kind(), ErrorKind::Difference);
    assert!(
        short.to_string().contains("the motion tasks are left out ("),
        "{short}"
    );
    // a plan that was made without the check is not carried out without it
    let folder = folder("controlled");
    let way_back = folder.join("before");
    let refused = carry_out(
        &mut network,
        &mut drive,
        &before,
        &looked,
        &mut looked_at,
        &way_back,
        |_| (),
    )
    .wait();
    assert!(
        matches!(refused, Err(RestoreError::Controlled { .. })),
        "{refused:?}"
    );
    assert!(!way_back.exists());
    std::fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn a_choice_without_a_parameter_is_a_mistake() {
    let (mut network, mut drive) = open("akd-1");
    let before = saved(&mut network, &mut drive);
    let wanted = Restore {
        choice: Choice {
            only: vec!["NO.SUCH*".parse().expect("a pattern")],
            ..Choice::default()
        },
        ..Restore::default()
    };
    let error = settings::plan(&mut network, &mut drive, &before, &wanted)
        .wait()
        .map(|_| ())
        .unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Usage, "{error}");
}

#[test]
fn what_is_not_a_backup_is_not_replaced() {
    let folder = folder("settings-files");
    let path = folder.join("letter.txt");
    std::fs::write(&path, "Dear colleague").expect("written");
    let error = BackupFile::at(&path, false).unwrap_err();
    assert!(matches!(error, FileError::OtherContent(_)), "{error}");
    // nor is a file written of a drive that reported nothing
    let empty = Backup::read("profidrive backup 1\nmodel: AKD\nvendor: 0x0105\ndevice: 0x0001\n").unwrap();
    let error = BackupFile::at(&folder.join("empty.backup"), false)
        .unwrap()
        .write(&empty)
        .unwrap_err();
    assert!(matches!(error, FileError::NoSettings(_)), "{error}");
    assert!(!folder.join("empty.backup").exists());
    assert_eq!(error.kind(), ErrorKind::Local);
    assert!(matches!(settings::read(&path), Err(FileError::Wrong { .. })));
    let (mut network, mut drive) = open("akd-1");
    let backup = saved(&mut network, &mut drive);
    assert!(BackupFile::at(&path, true).unwrap().write(&backup).unwrap());
    assert_eq!(settings::read(&path).unwrap(), backup);
    let missing = settings::read(&folder.join("none")).unwrap_err();
    assert!(matches!(missing, FileError::Missing(_)), "{missing}");
    std::fs::remove_dir_all(folder).expect("removed");
}

/// A restore reads as long as it writes: what it reads is counted too.
#[test]
fn what_a_restore_reads_is_counted_to_its_end() {
    let (mut network, mut drive) = open("akd-1");
    let backup = saved(&mut network, &mut drive);
    let mut seen = Vec::new();
    let progress = |done, all| seen.push((done, all));
    settings::plan_with(&mut network, &mut drive, &backup, &Restore::default(), progress)
        .wait()
        .unwrap();
    assert!(
        seen.len() > 3 && seen.windows(2).all(|pair| pair[0].0 <= pair[1].0),
        "{seen:?}"
    );
    let (done, all) = seen[seen.len() - 1];
    assert!(done == all && all >= backup.readings().len(), "{seen:?}");
}
