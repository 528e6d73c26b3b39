//! `--save` of a VLT on PROFINET uses request 0x42, which only PROFIBUS manuals name: a drive that refuses it is
//! commanded to save by 9-71, and where it refuses that too, the set names it. Where a value is refused, 9-71 is
//! not sent.

use client::change::{ChangeSet, Choice, Saved, Step};
use client::{Drive, Network, Wait, WriteMode};
use network::host::Host;
use network::segment::{Pace, Segment, SegmentMedium};
use profile::catalogue::{Access, Catalogue, Parameter, VLT};
use profile::model::Model as Known;
use profile::parameter::{Dialect, ErrorNumber, RequestId};
use profinet::controller::ControllerConfig;
use profinet::device::Stored;
use profinet::{IpSuite, MacAddress};
use virtual_drive::model::{self, Model};
use virtual_drive::station::{Station, StationConfig};

/// 9-71, saves all settings.
const SAVE: u16 = 971;

/// 3-42, ramp-down time.
const RAMP_DOWN: u16 = 342;

/// Returns a VLT whose option does not know request 0x42, and which refuses to change these parameters.
fn vlt(refused: &[u16]) -> &'static Model {
    static DIALECT: Dialect = Dialect {
        requests: &[RequestId::Read, RequestId::Change],
        ..Dialect::VLT
    };
    static KNOWN: Known = Known {
        dialect: &DIALECT,
        ..profile::model::VLT
    };
    let own = |parameter: &Parameter| Parameter {
        access: match parameter.pnu {
            pnu if refused.contains(&pnu) => Access::ReadOnly,
            _ => parameter.access,
        },
        ..*parameter
    };
    let parameters = VLT.parameters.iter().map(own).collect();
    let own = Catalogue::assemble(VLT.model, VLT.notation, VLT.scaling, VLT.device, parameters);
    Box::leak(Box::new(Model {
        known: &KNOWN,
        catalogue: Box::leak(Box::new(own)),
        derived: std::sync::OnceLock::new(),
        ..model::VLT
    }))
}

fn session(model: &'static Model) -> (Network, Drive) {
    let ip = |last| IpSuite {
        address: [10, 0, 0, last].into(),
        mask: [255, 255, 255, 0].into(),
        gateway: [0; 4].into(),
    };
    let mut drive = StationConfig::new(model, MacAddress([2, 0x50, 0x4E, 0, 0, 1]));
    drive.network = Stored {
        name: "vlt-1".into(),
        ip: ip(1),
        ..Stored::default()
    };
    let mut segment = Segment::new(1);
    segment.attach(Box::new(Host::new(Station::new(drive))));
    let config = ControllerConfig::new(MacAddress([2, 0x50, 0x4E, 0, 0, 2]), ip(2), "plc", 1);
    let (mut session, _) = Network::on(SegmentMedium::new(segment, Pace::Virtual), config);
    let drive = session.find(&"vlt-1".parse().unwrap()).wait().expect("there");
    (session, drive)
}

/// Returns the parameters of the changes and of the command that saves, and the error number that each was refused with.
fn numbers(set: &ChangeSet) -> Vec<(u16, Option<ErrorNumber>)> {
    let changes = set.changes().iter().chain(set.save_command());
    changes
        .map(|change| {
            let refusal = change.refusal().map(|refusal| refusal.number);
            (change.selection.pnu, refusal)
        })
        .collect()
}

#[test]
fn a_save_that_is_refused_by_request_and_by_parameter_is_named() {
    for (can_save, expected) in [(true, None), (false, Some(ErrorNumber::NOT_CHANGEABLE))] {
        let (mut session, mut drive) = session(vlt(if can_save { &[] } else { &[SAVE] }));
        let change = ["3-41=7.5".parse().unwrap()];
        let set = session
            .write(&mut drive, &change, WriteMode::Save)
            .wait()
            .expect("tried");
        assert_eq!(numbers(&set), [(341, None), (SAVE, expected)]);
        let value = &set.changes()[0];
        assert!(value.is_done(), "the value is written all the same");
        assert_eq!(set.is_saved(value), can_save);
        if let Saved::Refused(refusal) = set.saved() {
            assert!(refusal.to_string().contains("9-71"), "{refusal}");
        }
        // a restore that is to save says so too
        let wanted = session.backup(&mut drive, &mut |_, _| {}).wait().expect("read");
        let back = ["3-41=9".parse().unwrap()];
        session
            .write(&mut drive, &back, WriteMode::Write)
            .wait()
            .expect("written");
        let plan = session.plan(&mut drive, &wanted, &Choice::default()).wait();
        let mut set = plan.expect("a plan").set;
        set.save(&drive).expect("a way to save");
        session.apply(&mut drive, &mut set).wait().expect("restored");
        match (set.saved(), can_save) {
            (Saved::Yes, true) => {}
            (Saved::Refused(refusal), false) => {
                assert_eq!(Some(refusal.number), expected);
            }
            (saved, _) => panic!("{saved:?}: {set}"),
        }
    }
}

/// The values are only in RAM then, and the set says so.
#[test]
fn the_save_that_is_not_sent_after_a_refused_value_is_named() {
    let (mut session, mut drive) = session(vlt(&[RAMP_DOWN]));
    let changes = ["3-41=7.5", "3-42=7.5"].map(|text| text.parse().expect("an assignment"));
    let set = session
        .write(&mut drive, &changes, WriteMode::Save)
        .wait()
        .expect("tried");
    let expected = [
        (341, None),
        (RAMP_DOWN, Some(ErrorNumber::NOT_CHANGEABLE)),
        (SAVE, None),
    ];
    assert_eq!(numbers(&set), expected);
    let save = set.save_command().expect("a command");
    assert_eq!(
        (save.step, set.saved()),
        (Step::NotWritten, Saved::No),
        "{save:?}"
    );
    assert!(!set.is_saved(&set.changes()[0]));
}
