//! Drives that the client cannot know by their device id: a known make under another one, and a vendor of which there
//! are no tables, in virtual time.

use std::time::Duration;

use network::host::{Host, StationId};
use profidrive_client::backup::{Backup, compare};
use profidrive_client::change::Choice;
use profidrive_client::{AxisSettings, Drive, Wait, WriteMode};
use profile::catalogue::VACON;
use profinet::MacAddress;
use profinet::device::Stored;
use testbench::{Bench, bench_of, drive_mut, find, ip, select};
use virtual_drive::drive::Injection;
use virtual_drive::model;
use virtual_drive::station::{Station, StationConfig};

/// A virtual Vacon that says it is something else.
fn vacon_as(vendor_id: u16, device_id: u16) -> (Bench, StationId, Drive) {
    let mut config = StationConfig::new(&model::VACON, MacAddress([2, 0, 0, 0, 0, 1]));
    config.description.identity.vendor_id = vendor_id;
    config.description.identity.device_id = device_id;
    config.network = Stored {
        name: "foo-1".into(),
        ip: ip(1),
        ..Stored::default()
    };
    let (mut session, ids) = bench_of(vec![Box::new(Host::new(Station::new(config)))]);
    let mut drive = find(&mut session, "foo-1").expect("there");
    assert!(drive.model.catalogue.is_none(), "not known by its device id");
    session
        .recognise(&mut drive, &mut |_, _| {})
        .wait()
        .expect("learned");
    (session, ids[0], drive)
}

/// The element of a parameter, as it is.
fn raw(session: &mut Bench, drive: &mut Drive, text: &str) -> i64 {
    let selection = select(drive, text);
    let reading = session.read_one(drive, &selection).wait().expect("a value");
    reading.raw().expect("a number")
}

fn write(session: &mut Bench, drive: &mut Drive, text: &str) {
    let assignment = text.parse().expect("an assignment");
    let outcomes = session
        .write(drive, &[assignment], WriteMode::Write)
        .wait()
        .expect("written");
    outcomes.accepted().expect("accepted");
}

/// What every drive can do, whoever made it: its page, its faults, its settings there and back.
fn serves(session: &mut Bench, id: StationId, drive: &mut Drive, change: Option<&str>) {
    let info = session.info(drive).wait().expect("a page");
    assert!(info.refused.is_empty(), "{:?}", info.refused);
    let elements = |pnu| info.readings.iter().filter(|reading| reading.pnu == pnu).count();
    assert_eq!((elements(964), elements(975)), (6, 8));

    assert!(session.faults(drive).wait().expect("answered").is_empty());
    drive_mut(session, id).inject("fault=1".parse::<Injection>().expect("a fault"));
    session
        .pass(Duration::from_millis(100))
        .wait()
        .expect("time passes");
    let report = session.fault_report(drive).wait().expect("a report");
    let present: Vec<_> = report.present().map(|fault| fault.number).collect();
    assert_eq!((present, report.shape.elements()), (vec![1], 8));
    let status = session.status(drive).wait().expect("a status");
    assert_eq!(status.faults.len(), 1, "{status:?}");
    drive_mut(session, id).inject("fault=1".parse::<Injection>().expect("a fault"));

    let first = session.backup(drive, &mut |_, _| {}).wait().expect("saved");
    let read = Backup::read(first.to_string()).expect("read back");
    assert!(compare(&first, &read).is_empty());
    assert!(read.readings().len() >= 32, "{read:?}");
    let Some(change) = change else { return };
    write(session, drive, change);
    let second = session.backup(drive, &mut |_, _| {}).wait().expect("saved");
    assert_eq!(compare(&first, &second).len(), 1);
    let mut plan = session
        .plan(drive, &read, &Choice::default())
        .wait()
        .expect("a plan");
    assert_eq!(plan.set.changes().len(), 1, "{plan:?}");
    session.apply(drive, &mut plan.set).wait().expect("restored");
    assert!(plan.set.is_done(), "{}", plan.set);
}

#[test]
fn a_vacon_under_another_device_id_is_a_vacon() {
    let (mut session, id, mut drive) = vacon_as(VACON.device.vendor_id, 0x0777);
    let tables = drive.model.catalogue.expect("the tables");
    assert!(std::ptr::eq(tables, &VACON) && !drive.model.learned);
    serves(&mut session, id, &mut drive, Some("ID 103=7.5s"));
    let mut axis = session
        .take_axis(&mut drive, AxisSettings::default())
        .wait()
        .expect("connected");
    axis.ready_or_fault().wait().expect("there");
    axis.acknowledge().wait().expect("acknowledged");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(600.0, None).wait().expect("turns");
    drop(enabled);
    axis.release().wait().expect("at rest");
}

#[test]
fn a_strange_drive_is_learned_whatever_size_its_arrays_have() {
    let (mut session, id, mut drive) = vacon_as(0x0ABC, 7);
    let tables = drive.model.catalogue.expect("its own tables");
    assert!(drive.model.learned);
    let sizes = [(915, 16), (923, 151), (947, 8), (964, 6), (980, 24)];
    for (pnu, elements) in sizes {
        let row = tables.by_pnu(pnu).map(|row| row.elements);
        assert_eq!(row, Some(elements), "{pnu}");
        assert_eq!(select(&drive, &pnu.to_string()).count, elements);
    }
    assert_eq!(tables.by_pnu(930).map(|row| row.name), Some("Operating mode"));
    assert_eq!(raw(&mut session, &mut drive, "964[1]"), 2);
    // by number and element, as the collected parameters are unknown
    assert_eq!(raw(&mut session, &mut drive, "10001[103]"), 50);
    serves(&mut session, id, &mut drive, None);
    write(&mut session, &mut drive, "10001[103]=75");
    assert_eq!(raw(&mut session, &mut drive, "10001[103]"), 75);
}
