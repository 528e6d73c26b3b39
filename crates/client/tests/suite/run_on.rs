//! A drive that no setting stops when its controller is lost is enabled with explicit consent only.

use std::time::Duration;

use profidrive_client::axis::Purpose;
use profidrive_client::{Action, AxisSettings, Choice, Drive, Error, ErrorKind, Session, Wait, WriteMode};
use testbench::running_on;
use testbench::shared::On;
use testbench::world::{Transport, World};
use virtual_drive::model::{self, Model as Virtual};

/// The purposes that move a converter.
const MOVING: [Purpose; 2] = [Purpose::Speed, Purpose::Jog];
/// A drive that may run on.
struct Delivered {
    model: &'static Virtual,
    name: &'static str,
    /// Makes it run on.
    cause: &'static str,
    /// How the message names that.
    named: &'static str,
    /// Makes it stop.
    remedy: &'static str,
}

const DRIVES: [Delivered; 2] = [
    Delivered {
        model: &model::VLT,
        name: "vlt",
        cause: "8-04=0",
        named: "8-04 is Off",
        remedy: "8-04=5",
    },
    Delivered {
        model: &model::VACON,
        name: "vacon",
        cause: "ID 733=0",
        named: "ID 733 is No action",
        remedy: "ID 733=2",
    },
];

impl Delivered {
    fn found(&self) -> (World, On<World>, Drive) {
        let world = World::new(self.model, Transport::Profinet, 7);
        let (mut session, mut drive) = world.client(self.name, Transport::Profinet, 1).expect("found");
        write(&mut session, &mut drive, self.cause);
        (world, session, drive)
    }
}

fn taken(session: &mut Session, drive: &mut Drive, settings: AxisSettings) -> Result<(), Error> {
    let mut axis = session.take_axis(drive, settings).wait()?;
    let enabled = axis.enable().wait().map(|_| ());
    enabled.and(axis.release().wait())
}

fn is_untouched(world: &World) -> bool {
    world.look(|drive| drive.control_word().0 == 0 && !drive.is_enabled())
}

fn write(session: &mut On<World>, drive: &mut Drive, text: &str) {
    let assignment = text.replace(' ', "").parse().expect("an assignment");
    let outcomes = session
        .write(drive, &[assignment], WriteMode::Write)
        .wait()
        .expect("written");
    assert!(outcomes.is_done(), "{outcomes:?}");
}

#[test]
fn without_consent_nothing_is_sent() {
    for one in DRIVES {
        let (world, mut session, mut drive) = one.found();
        for purpose in MOVING {
            let settings = AxisSettings::for_purpose(purpose);
            let planned = session.plan_axis(&mut drive, &settings).wait().map(|_| ());
            let error = taken(&mut session, &mut drive, settings).expect_err("no consent");
            assert_eq!(planned.expect_err("no consent").to_string(), error.to_string());
            assert_eq!(error.kind(), ErrorKind::Safety);
            let text = error.to_string();
            assert!(text.contains("drive-1") && text.contains(one.named), "{text}");
            let advice = error.advice().expect("a remedy");
            let actions: Vec<&Action> = advice.actions().collect();
            assert_eq!(actions[0].to_string(), format!("write {}", one.remedy));
            assert_eq!(actions[1], &Action::Choose(Choice::RunOn));
            world.pass(Duration::from_secs(1));
            assert!(is_untouched(&world), "{}: {purpose:?}", one.name);
        }
    }
}

#[test]
fn consent_or_the_remedy_enables_it() {
    for one in DRIVES {
        let (_world, mut session, mut drive) = one.found();
        taken(&mut session, &mut drive, running_on(Purpose::Speed)).expect("consented");
        write(&mut session, &mut drive, one.remedy);
        taken(&mut session, &mut drive, AxisSettings::default()).expect("it stops by itself");
    }
}

/// Control alone is what stops and acknowledges: it is never refused, and enabling from there is.
#[test]
fn control_without_a_motion_needs_no_consent() {
    let world = World::new(&model::VLT, Transport::Profinet, 7);
    let (mut session, mut drive) = world.client("vlt", Transport::Profinet, 1).expect("found");
    let settings = AxisSettings::for_purpose(Purpose::Control);
    let mut axis = session.take_axis(&mut drive, settings).wait().expect("free");
    axis.ready().wait().expect("ready");
    let error = axis.enable().wait().map(|_| ()).expect_err("no consent");
    assert!(matches!(error, Error::RunsOn { .. }), "{error}");
    axis.stop().wait().expect("stopped");
    axis.release().wait().expect("released");
}
