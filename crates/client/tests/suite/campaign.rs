//! Clients that are killed, frozen or cut off at random moments of a motion, in virtual time: every action that `status`
//! recommends afterwards works, and the axis is at rest in the end.
//!
//! A failure prints its case and its seed.

// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::panic, clippy::unwrap_used)]

use std::time::Duration;
use testbench::running_on;
use testbench::shared::On;

use profidrive_client::axis::{Jog, Move, Purpose};
use profidrive_client::status::{Cause, Diagnosis, diagnose};
use profidrive_client::{Action, Advice, AxisSettings, Drive, Error, StopWay, Wait, WriteMode};
use profile::notation::Position;
use profile::parameter::{Keep, ParameterAccess};
use testbench::world::{Accident, Transport, World};
use virtual_drive::model::{self, Model as Virtual};

const SECOND: Duration = Duration::from_secs(1);
/// How often each case is tried.
const SEEDS: u64 = 5;
/// Rounds of advice after which the axis has to be at rest.
const MOST_ROUNDS: usize = 4;

/// A drive and the settings that decide what it does without its controller: numbers of the vendor and values.
struct Subject {
    model: &'static Virtual,
    name: &'static str,
    settings: &'static [&'static [(u16, u64)]],
    motions: &'static [Motion],
    transports: &'static [Transport],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Motion {
    Run,
    Jog,
    Move,
    Home,
}

use Motion::{Home, Jog as Jogging, Move as Moving, Run};
use Transport::{Fc, Profinet, Uss};

const SUBJECTS: [Subject; 6] = [
    Subject {
        model: &model::AKD,
        name: "akd",
        // FBUS.PARAM02 bit 0
        settings: &[&[(2158, 0)], &[(2158, 1)]],
        motions: &[Run, Jogging, Moving, Home],
        transports: &[Profinet],
    },
    // no setting of it is about a line
    Subject {
        model: &model::AKD,
        name: "akd",
        settings: &[&[]],
        motions: &[Run, Jogging],
        transports: &[Fc, Uss],
    },
    Subject {
        model: &model::VLT,
        name: "vlt",
        // 8-04 and 8-03
        settings: &[
            &[(804, 0)],
            &[(804, 1)],
            &[(804, 2)],
            &[(804, 3)],
            &[(804, 4)],
            &[(804, 5)],
            &[(804, 2), (803, 200)],
            &[(804, 5), (803, 1)],
        ],
        motions: &[Run, Jogging],
        transports: &[Profinet, Fc, Uss],
    },
    Subject {
        model: &model::VACON,
        name: "vacon",
        // ID 733
        settings: &[&[(733, 0)], &[(733, 1)], &[(733, 2)], &[(733, 3)]],
        motions: &[Run, Jogging],
        transports: &[Profinet],
    },
    // its control word at a line has no jog
    Subject {
        model: &model::VACON,
        name: "vacon",
        settings: &[&[(733, 0)], &[(733, 1)], &[(733, 2)], &[(733, 3)]],
        motions: &[Run],
        transports: &[Fc, Uss],
    },
    // a drive without tables
    Subject {
        model: &model::VACON,
        name: "standard",
        settings: &[&[(733, 0)], &[(733, 2)]],
        motions: &[Run],
        transports: &[Profinet],
    },
];

/// Small, fast, the same in each run.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }

    fn time(&mut self, limit: Duration) -> Duration {
        let micros = u64::try_from(limit.as_micros()).expect("short");
        Duration::from_micros(self.below(micros))
    }
}

fn prepare(world: &World, settings: &[(u16, u64)]) {
    world.look(|drive| {
        for &(number, value) in settings {
            let parameter = drive.model().numbered(number).expect("known");
            let index = parameter.base.unwrap_or(0);
            ParameterAccess::write(drive, parameter.pnu, index, value, Keep::Volatile).expect("taken");
        }
    });
}

fn found(world: &World, subject: &Subject, transport: Transport, seed: u64) -> (On<World>, Drive) {
    let (mut session, mut drive) = world.client(subject.name, transport, seed).expect("found");
    if subject.name == "standard" {
        session.find_channel(&mut drive).wait().expect("it has one");
    }
    (session, drive)
}

/// Returns the settings for taking the axis: they include the reference of a drive that does not report it.
fn settings_for(drive: &Drive, purpose: Purpose) -> AxisSettings {
    let known = drive.model.catalogue.is_some() && !drive.is_on_line();
    AxisSettings {
        reference_speed: (!known).then_some(1500.0),
        ..running_on(purpose)
    }
}

/// The motion that something happens to. How it ends does not matter here.
fn motion(session: &mut On<World>, drive: &mut Drive, motion: Motion) -> Result<(), Error> {
    let purpose = match motion {
        Run => Purpose::Speed,
        Jogging => Purpose::Jog,
        Moving => Purpose::Move,
        Home => Purpose::Home,
    };
    let mut axis = session.take_axis(drive, settings_for(drive, purpose)).wait()?;
    let mut enabled = axis.enable().wait()?;
    match motion {
        Run => {
            enabled.reach_speed(600.0, None).wait()?;
            enabled.keep_speed(600.0, SECOND * 20).wait()?;
        }
        Jogging => {
            enabled.jog(Jog::One).wait()?;
            enabled.hold(SECOND * 20).wait()?;
        }
        Moving => {
            enabled.home(None).wait()?;
            enabled.move_to(&Move::to(Position::Turns(40.0), 300.0)).wait()?;
        }
        Home => enabled.home(None).wait()?,
    }
    enabled.disable().wait()?;
    axis.release().wait()
}

/// What the report of a status recommends.
fn recommended(diagnosis: &Diagnosis) -> Vec<Action> {
    let notes = diagnosis.notes.iter().filter_map(|note| note.next.as_ref());
    let texts = diagnosis.next.iter().chain(notes);
    texts.flat_map(Advice::actions).cloned().collect()
}

fn carry_out(session: &mut On<World>, drive: &mut Drive, action: &Action) -> Result<(), Error> {
    let mut stop = |way| -> Result<(), Error> {
        let outcome = session.stop_drive(drive, way, SECOND * 15).wait()?;
        assert!(outcome.at_rest, "{action}: {outcome:?}");
        Ok(())
    };
    match action {
        Action::Stop => stop(StopWay::Stop),
        Action::Disable => stop(StopWay::Disable),
        Action::Acknowledge => {
            let settings = running_on(Purpose::Control);
            let mut axis = session.take_axis(drive, settings).wait()?;
            axis.ready_or_fault().wait()?;
            axis.acknowledge().wait()?;
            axis.release().wait()
        }
        Action::Write { parameter, value } => {
            let assignment = format!("{parameter}={value}");
            let assignment = assignment.parse().expect("an assignment");
            let outcomes = session.write(drive, &[assignment], WriteMode::Write).wait()?;
            assert!(outcomes.accepted().is_ok(), "{action}: {outcomes:?}");
            Ok(())
        }
        Action::Read { parameters } => {
            for name in parameters {
                let selection = drive.select(name)?;
                session.read(drive, &[selection]).wait()?;
            }
            Ok(())
        }
        // what begins a motion is not begun here, but everything that it needs is there
        Action::Run => session
            .plan_axis(drive, &settings_for(drive, Purpose::Speed))
            .wait()
            .map(drop),
        Action::Move => session
            .plan_axis(drive, &settings_for(drive, Purpose::Move))
            .wait()
            .map(drop),
        Action::Jog => {
            session.jog_speed(drive, Jog::One).wait()?;
            session
                .plan_axis(drive, &settings_for(drive, Purpose::Jog))
                .wait()
                .map(drop)
        }
        Action::Home => session
            .plan_axis(drive, &settings_for(drive, Purpose::Home))
            .wait()
            .map(drop),
        Action::Status | Action::Info | Action::Faults | Action::Find { .. } => Ok(()),
        other => panic!("{other}: not carried out by this test yet"),
    }
}

struct Case<'a> {
    subject: &'a Subject,
    transport: Transport,
    settings: &'a [(u16, u64)],
    motion: Motion,
    accident: &'static str,
    seed: u64,
}

/// Runs a case; returns the highest speed before a new client came, rpm.
fn try_out(case: &Case<'_>, at: &str) -> f64 {
    let mut random = Random(case.seed ^ 0x9E37_79B9_7F4A_7C15);
    let world = World::new(case.subject.model, case.transport, case.seed);
    prepare(&world, case.settings);
    match case.motion {
        Moving => prepare(&world, &[(930, 2)]),
        // HOME.MODE 1 searches a limit switch, at 300 rpm (HOME.V_32): there is none
        Home => prepare(&world, &[(930, 2), (2203, 1), (2210, 300_000)]),
        Run | Jogging => {}
    }
    let accident = match case.accident {
        "killed" => Accident::Killed,
        "frozen" => Accident::Frozen(random.time(SECOND * 4)),
        _ => Accident::CableOut(random.time(SECOND * 4)),
    };
    {
        let (mut session, mut drive) = found(&world, case.subject, case.transport, 1);
        world.plan(random.time(SECOND * 9), accident);
        // whatever it says, it must be about the loss or none of ours
        if let Err(error) = motion(&mut session, &mut drive, case.motion) {
            assert!(!matches!(error, Error::Misuse(_)), "{at}: {error}");
        }
    }
    world.pass(random.time(SECOND * 3));
    // the cable is plugged again when a new client comes
    world.pass(SECOND * 5);
    let fastest = world.fastest();
    let (mut session, mut drive) = found(&world, case.subject, case.transport, 2);
    let mut last = String::new();
    for _ in 0..MOST_ROUNDS {
        let powered = world.look(|drive| drive.is_enabled());
        let status = session
            .status(&mut drive)
            .wait()
            .unwrap_or_else(|error| panic!("{at}: status: {error}"));
        let diagnosis = diagnose(&status);
        last = format!("{diagnosis:?}");
        let actions = recommended(&diagnosis);
        let before = world.fastest();
        for action in &actions {
            if let Err(error) = carry_out(&mut session, &mut drive, action) {
                panic!("{at}: `{action}` of {diagnosis:?}: {error}");
            }
        }
        let recovers =
            |action: &Action| matches!(action, Action::Stop | Action::Disable | Action::Acknowledge);
        if actions.iter().any(recovers) {
            assert!(world.fastest() <= before + 10.0, "{at}: faster by {actions:?}");
            continue;
        }
        let powered = powered && world.look(|drive| drive.is_enabled());
        assert!(!powered, "{at}: nothing ends its operation: {last}");
        if world.speed().abs() < 1.0 {
            break;
        }
        // what has no power coasts, and that is what is said of it
        assert_eq!(diagnosis.cause, Cause::MovedExternally, "{at}: {last}");
        world.pass(SECOND * 10);
        assert!(world.fastest() <= before + 1.0, "{at}: faster by itself");
    }
    let (speed, enabled) = (world.speed(), world.look(|drive| drive.is_enabled()));
    assert!(
        speed.abs() < 1.0 && !enabled,
        "{at}: {speed} rpm, enabled {enabled}: {last}"
    );
    session.close().wait().expect("closed");
    fastest
}

/// What it cannot do is refused before anything is sent, and `status` does not recommend it.
#[test]
fn a_vacon_on_a_serial_line_receives_no_jog_bits() {
    for transport in [Fc, Uss] {
        let world = World::new(&model::VACON, transport, 1);
        let (mut session, mut drive) = world.client("vacon", transport, 1).expect("found");
        let error = motion(&mut session, &mut drive, Jogging).expect_err("it has no jog");
        assert!(matches!(error, Error::NoJog { .. }), "{error}");
        let diagnosis = diagnose(&session.status(&mut drive).wait().expect("a status"));
        assert_eq!(diagnosis.cause, Cause::NoController);
        assert_eq!(recommended(&diagnosis), [Action::Run]);
    }
}

#[test]
fn whatever_happens_to_a_client_the_advice_of_status_brings_the_axis_to_rest() {
    let mut cases = 0;
    for subject in &SUBJECTS {
        for &transport in subject.transports {
            for &settings in subject.settings {
                for &motion in subject.motions {
                    let mut fastest: f64 = 0.0;
                    for accident in ["killed", "frozen", "cable out"] {
                        for seed in 0..SEEDS {
                            let case = Case {
                                subject,
                                transport,
                                settings,
                                motion,
                                accident,
                                seed,
                            };
                            let at = format!(
                                "{} {transport:?} {settings:?} {motion:?} {accident} seed {seed}",
                                subject.name
                            );
                            fastest = fastest.max(try_out(&case, &at));
                            cases += 1;
                        }
                    }
                    let name = subject.name;
                    assert!(
                        fastest > 40.0,
                        "{name} {transport:?} {motion:?}: {fastest} rpm is no motion"
                    );
                }
            }
        }
    }
    assert!(cases > 1000, "{cases}");
}
