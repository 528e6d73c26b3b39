//! Every cause once, and which one wins.

use super::*;

#[test]
fn each_cause_has_one_rule_in_the_order_of_weight() {
    let causes: Vec<Cause> = rules::RULES.iter().map(|rule| rule.cause).collect();
    assert_eq!(causes, Cause::ALL);
}

/// Text in braces that is not a known action stays in the advice as it is.
#[test]
fn every_brace_of_the_advice_is_an_action() {
    let own = generated::ADVICE.iter().map(|(_, _, text)| *text);
    let disables = generated::DISABLES.iter().map(|(_, _, text)| *text);
    let general = Cause::ALL.iter().map(|cause| cause.advice());
    for text in own.chain(disables).chain(general) {
        let braces = text.matches('{').count();
        assert_eq!(Advice::from(text).actions().count(), braces, "{text}");
    }
}

fn running() -> DriveStatus {
    DriveStatus {
        drive: "akd-1".into(),
        model: "AKD",
        controller: Some(Some("plc".into())),
        stw1: Some(Stw1(0x047F)),
        zsw1: Some(Zsw1(0x0337)),
        telegram: Some(1),
        carries_speed: Some(true),
        carries_tasks: Some(false),
        mode: Some(1),
        command_source: Some(1),
        disable_sources: Some(0),
        motion_disable_sources: Some(0),
        motion: Some(0),
        torque_allowed: Some(true),
        negative_switch: Some(false),
        positive_switch: Some(false),
        software_limits: Some(0),
        speed_set: Some(60.0),
        speed_actual: Some(59.7),
        ..DriveStatus::default()
    }
}

/// In position mode, homed, standing at its target.
fn positioned() -> DriveStatus {
    DriveStatus {
        stw1: Some(Stw1(0x043F)),
        zsw1: Some(Zsw1(0x2F37)),
        telegram: Some(9),
        carries_speed: Some(false),
        carries_tasks: Some(true),
        mode: Some(2),
        speed_set: None,
        speed_actual: Some(0.0),
        ..running()
    }
}

fn fault(number: u16, meaning: Option<&'static str>) -> FaultEntry {
    FaultEntry {
        meaning,
        number,
        ..FaultEntry::default()
    }
}

fn words(status: &mut DriveStatus, stw1: u16, zsw1: u16) {
    (status.stw1, status.zsw1) = (Some(Stw1(stw1)), Some(Zsw1(zsw1)));
}

type Change = fn(&mut DriveStatus);

const VELOCITY: &[(Cause, Verdict, Change, &str)] = &[
    (Cause::Silent, Verdict::Held, |s| s.zsw1 = None, "status word"),
    (
        Cause::Fault,
        Verdict::Held,
        |s| {
            words(s, 0x047F, 0x0278);
            s.faults = vec![fault(439, Some("Following error")), fault(702, None)];
        },
        "fault F439 is present: Following error, then F702",
    ),
    (
        Cause::Fault,
        Verdict::Held,
        |s| words(s, 0x047E, 0x0278),
        "(ZSW1 bit 3), the drive does not report its number",
    ),
    (
        Cause::Sto,
        Verdict::Held,
        |s| s.torque_allowed = Some(false),
        "STO.STATE is 0",
    ),
    (
        Cause::NoPower,
        Verdict::Held,
        |s| {
            words(s, 0x047E, 0x0231);
            (s.bus_voltage, s.bus_lowest) = (Some(12.0), Some(90.0));
        },
        "has 12 V, it needs 90 V",
    ),
    (
        Cause::HardwareDisable,
        Verdict::Held,
        |s| s.disable_sources = Some(4),
        "bit 2",
    ),
    (
        Cause::ControlledStop,
        Verdict::Held,
        |s| s.disable_sources = Some(0x21),
        "bit 5",
    ),
    (
        Cause::DisableSource,
        Verdict::Held,
        |s| s.disable_sources = Some(0x11),
        "0x0011",
    ),
    (
        Cause::CommandSource,
        Verdict::Held,
        |s| (s.command_source, s.command_source_text) = (Some(3), Some("Analog")),
        "DRV.CMDSOURCE is 3, Analog",
    ),
    (
        Cause::NoController,
        Verdict::Waits,
        |s| {
            words(s, 0, 0x0240);
            (s.controller, s.speed_actual, s.command_source) = (Some(None), Some(0.0), Some(0));
        },
        "no controller is connected",
    ),
    (
        Cause::LocalOperation,
        Verdict::Held,
        |s| words(s, 0x047F, 0x0137),
        "ZSW1 bit 9",
    ),
    (
        Cause::OtherMode,
        Verdict::Held,
        |s| s.mode = Some(0x8000),
        "0x8000",
    ),
    (
        Cause::NoController,
        Verdict::Waits,
        |s| {
            words(s, 0, 0x0240);
            (s.controller, s.speed_actual) = (Some(None), Some(0.0));
        },
        "no controller is connected (the drive is in S1",
    ),
    (
        Cause::TurnsOwnerless,
        Verdict::Held,
        |s| s.controller = Some(None),
        "59.7 rpm though no controller",
    ),
    (
        Cause::EnabledOwnerless,
        Verdict::Held,
        |s| (s.controller, s.speed_actual) = (Some(None), Some(0.0)),
        "its power stage is on though no controller is connected",
    ),
    (
        Cause::MovedExternally,
        Verdict::Held,
        |s| {
            words(s, 0x0000, 0x0240);
            s.controller = Some(None);
        },
        "59.7 rpm with its power stage off",
    ),
    (
        Cause::NoControl,
        Verdict::Waits,
        |s| words(s, 0x007F, 0x0231),
        "controller \"plc\" does not take control",
    ),
    (
        Cause::CoastStop,
        Verdict::Held,
        |s| words(s, 0x047D, 0x0260),
        "OFF2",
    ),
    (
        Cause::QuickStop,
        Verdict::Held,
        |s| words(s, 0x047B, 0x0250),
        "OFF3",
    ),
    (
        Cause::Stopping,
        Verdict::Waits,
        |s| words(s, 0x047E, 0x0233),
        "S5",
    ),
    (
        Cause::Inhibited,
        Verdict::Held,
        |s| words(s, 0x047F, 0x0270),
        "still sends ON",
    ),
    (Cause::NotReady, Verdict::Held, |s| words(s, 0x047E, 0x0270), "S1"),
    (
        Cause::SelfTest,
        Verdict::Waits,
        |s| words(s, 0x047E, 0x0200),
        "0x0200",
    ),
    (
        Cause::Off,
        Verdict::Waits,
        |s| words(s, 0x047E, 0x0231),
        "STW1 bit 0 is 0",
    ),
    (
        Cause::OperationDisabled,
        Verdict::Waits,
        |s| words(s, 0x0477, 0x0233),
        "STW1 bit 3 is 0",
    ),
    (
        Cause::SwitchingOn,
        Verdict::Waits,
        |s| words(s, 0x047F, 0x0233),
        "S3",
    ),
    (
        Cause::MotionHeld,
        Verdict::Held,
        |s| s.motion_disable_sources = Some(4),
        "0x0004",
    ),
    (
        Cause::TaskTelegram,
        Verdict::Held,
        |s| (s.telegram, s.carries_speed) = (Some(9), Some(false)),
        "telegram 9 carries no speed",
    ),
    (Cause::Moves, Verdict::Runs, |_| {}, "59.7 rpm"),
    (
        Cause::LimitSwitch,
        Verdict::Held,
        |s| (s.positive_switch, s.speed_actual) = (Some(true), Some(0.0)),
        "positive limit switch",
    ),
    (
        Cause::SoftwareLimit,
        Verdict::Held,
        |s| (s.software_limits, s.speed_actual) = (Some(2), Some(0.0)),
        "SWLS.STATE is 2",
    ),
    (
        Cause::TwoJogs,
        Verdict::Waits,
        |s| {
            words(s, 0x070F, 0x0337);
            s.speed_actual = Some(0.0);
        },
        "(STW1 bits 8 and 9)",
    ),
    (
        Cause::JogHeld,
        Verdict::Held,
        |s| {
            words(s, 0x060F, 0x0337);
            s.speed_actual = Some(0.0);
        },
        "(STW1 bit 9) does not move the axis",
    ),
    (
        Cause::RampOff,
        Verdict::Waits,
        |s| {
            words(s, 0x046F, 0x0337);
            s.speed_actual = Some(0.0);
        },
        "STW1 bit 4",
    ),
    (
        Cause::SetpointOff,
        Verdict::Waits,
        |s| {
            words(s, 0x043F, 0x0337);
            s.speed_actual = Some(0.0);
        },
        "STW1 bit 6",
    ),
    (
        Cause::RampFrozen,
        Verdict::Waits,
        |s| {
            words(s, 0x045F, 0x0337);
            s.speed_actual = Some(0.0);
        },
        "STW1 bit 5",
    ),
    (
        Cause::ZeroSetpoint,
        Verdict::Waits,
        |s| (s.speed_set, s.speed_actual) = (Some(0.0), Some(0.0)),
        "setpoint of 0",
    ),
    (
        Cause::DoesNotTurn,
        Verdict::Held,
        |s| s.speed_actual = Some(0.0),
        "setpoint of 60.0 rpm",
    ),
    (
        Cause::Operation,
        Verdict::Runs,
        |s| (s.speed_set, s.speed_actual) = (None, None),
        "operation",
    ),
];

const POSITION: &[(Cause, Verdict, Change, &str)] = &[
    (
        Cause::SpeedTelegram,
        Verdict::Held,
        |s| (s.telegram, s.carries_tasks) = (Some(1), Some(false)),
        "telegram 1 carries no traversing tasks",
    ),
    (
        Cause::Moves,
        Verdict::Runs,
        |s| words(s, 0x043F, 0x4F37),
        "ZSW1 bit 13 is 0",
    ),
    (
        Cause::FeedrateZero,
        Verdict::Held,
        |s| {
            words(s, 0x047F, 0x5B37);
            s.feedrate = Some(0.0);
        },
        "(MT_FEEDRATE)",
    ),
    (Cause::Homing, Verdict::Runs, |s| s.motion = Some(8), "bit 3"),
    (
        Cause::HomingFailed,
        Verdict::Held,
        |s| {
            words(s, 0x043F, 0x2337);
            s.motion = Some(16);
        },
        "bit 4",
    ),
    (
        Cause::NotHomed,
        Verdict::Held,
        |s| words(s, 0x043F, 0x2337),
        "ZSW1 bit 11 is 0",
    ),
    (
        Cause::TwoJogs,
        Verdict::Waits,
        |s| words(s, 0x070F, 0x2337),
        "two jogs at once (STW1 bits 8 and 9)",
    ),
    (
        Cause::TwoJogs,
        Verdict::Waits,
        |s| words(s, 0x150F, 0x2F37),
        "two jogs at once (STW1 bits 8 and 12)",
    ),
    (
        Cause::JogHeld,
        Verdict::Held,
        |s| words(s, 0x140F, 0x2337),
        "the jog that controller \"plc\" commands (STW1 bit 12)",
    ),
    (
        Cause::Rejected,
        Verdict::Waits,
        |s| words(s, 0x042F, 0x2F37),
        "STW1 bit 4",
    ),
    (
        Cause::IntermediateStop,
        Verdict::Waits,
        |s| words(s, 0x041F, 0x2B37),
        "STW1 bit 5",
    ),
    (
        Cause::TaskRefused,
        Verdict::Held,
        |s| words(s, 0x047F, 0x2B37),
        "ZSW1 bit 12",
    ),
    (
        Cause::TaskRefused,
        Verdict::Held,
        |s| s.motion = Some(1 << 10),
        "ZSW1 bit 12",
    ),
    (Cause::AtTarget, Verdict::Waits, |_| {}, "ZSW1 bit 10"),
    (
        Cause::AtTarget,
        Verdict::Waits,
        |s| s.command_source = Some(0),
        "ZSW1 bit 10",
    ),
    (
        Cause::CommandSource,
        Verdict::Held,
        |s| s.command_source = Some(2),
        "DRV.CMDSOURCE is 2",
    ),
    (
        Cause::TaskHeld,
        Verdict::Held,
        |s| words(s, 0x043F, 0x6B37),
        "its task is held",
    ),
    (
        Cause::NoTask,
        Verdict::Waits,
        |s| words(s, 0x043F, 0x2B37),
        "edge of STW1 bit 6",
    ),
];

#[test]
fn every_cause_has_its_sentence() {
    let mut met = Vec::new();
    for (table, base) in [(VELOCITY, running()), (POSITION, positioned())] {
        for &(cause, verdict, change, words) in table {
            let mut status = base.clone();
            change(&mut status);
            let found = diagnose(&status);
            assert_eq!(
                (found.cause, found.verdict),
                (cause, verdict),
                "{}",
                found.sentence
            );
            assert!(found.sentence.contains(words), "{cause:?}: {}", found.sentence);
            assert!(!found.sentence.contains('\n') && !found.sentence.ends_with('.'));
            assert!(
                found.verdict != Verdict::Held || found.next.is_some(),
                "{cause:?}: what is to be done?"
            );
            assert!(
                found
                    .next
                    .is_none_or(|next| !next.to_string().contains(['{', '}'])),
                "{cause:?}: an action that there is not"
            );
            met.push(cause);
        }
    }
    for cause in Cause::ALL {
        assert!(met.contains(cause), "{cause:?} is never found");
    }
}

#[test]
fn names_for_programs_are_unique() {
    for (at, cause) in Cause::ALL.iter().enumerate() {
        assert!(Cause::ALL[at + 1..].iter().all(|other| other.id() != cause.id()));
    }
}

#[test]
fn what_weighs_more_wins() {
    let mut status = running();
    words(&mut status, 0x047E, 0x0278);
    status.faults = vec![fault(602, None)];
    status.torque_allowed = Some(false);
    status.controller = Some(None);
    assert_eq!(diagnose(&status).cause, Cause::Fault);
    status.faults.clear();
    words(&mut status, 0x047E, 0x0270);
    assert_eq!(diagnose(&status).cause, Cause::Sto);
    status.torque_allowed = Some(true);
    status.disable_sources = Some(1);
    status.speed_actual = Some(0.0);
    assert_eq!(
        diagnose(&status).cause,
        Cause::NoController,
        "bit 0 is no obstacle"
    );
}

#[test]
fn a_drive_that_reports_almost_nothing() {
    let silent = DriveStatus::default();
    assert_eq!(diagnose(&silent).cause, Cause::Silent);
    let only_a_word = DriveStatus {
        zsw1: Some(Zsw1(0x0337)),
        ..DriveStatus::default()
    };
    assert_eq!(diagnose(&only_a_word).cause, Cause::Operation);
    assert_eq!(diagnose(&only_a_word).next, None);
}

#[test]
fn the_advice_names_the_drive() {
    let mut status = running();
    words(&mut status, 0x047F, 0x0278);
    let next = diagnose(&status).next.unwrap();
    assert!(next.to_string().contains("[acknowledge]"), "{next}");
}

/// No connection, the power stage is off, the axis stands.
fn ownerless() -> DriveStatus {
    let mut status = running();
    words(&mut status, 0, 0x0240);
    (status.controller, status.speed_actual) = (Some(None), Some(0.0));
    status
}

fn ids(status: &DriveStatus) -> (Cause, Vec<&'static str>) {
    let found = diagnose(status);
    (found.cause, found.notes.iter().map(|note| note.id).collect())
}

#[test]
fn further_obstacles_are_listed_with_the_cause() {
    assert_eq!(ids(&ownerless()), (Cause::NoController, vec![]));
    let mut status = ownerless();
    status.positive_switch = Some(true);
    status.software_limits = Some(2);
    status.brake_fitted = Some(true);
    status.brake_released = Some(false);
    status.warnings = vec![
        WarningEntry {
            number: 107,
            meaning: Some("Positive limit reached"),
            remedy: Some("move away"),
            ..WarningEntry::default()
        },
        WarningEntry {
            number: 304,
            meaning: Some("Motor foldback"),
            remedy: Some("less load"),
            ..WarningEntry::default()
        },
    ];
    let found = diagnose(&status);
    assert_eq!(found.verdict, Verdict::Waits);
    assert_eq!(
        ids(&status),
        (
            Cause::NoController,
            vec!["limit-switch", "software-limit", "brake", "warning"]
        )
    );
    let text = format!("{:?}", found.notes);
    assert!(
        text.contains("the positive limit switch is hit") && !text.contains("enabled (S4)"),
        "{text}"
    );
    assert!(
        text.contains("HWLS.POSSTATE") && text.contains("less load"),
        "{text}"
    );
    // what weighs more is the sentence, and not printed twice
    status.torque_allowed = Some(false);
    status.bus_voltage = Some(0.0);
    let (cause, notes) = ids(&status);
    assert_eq!((cause, notes[0]), (Cause::Sto, "no-power"));
    assert!(!notes.contains(&"sto"));
}

#[test]
fn an_axis_that_its_load_turns_is_not_sent_to_a_stop() {
    let mut status = ownerless();
    status.speed_actual = Some(-404.6);
    let found = diagnose(&status);
    assert_eq!(found.cause, Cause::MovedExternally);
    let next = found.next.unwrap().to_string();
    assert!(
        next.contains("MOTOR.BRAKE") && !next.contains("profidrive stop"),
        "{next}"
    );
    // beside a fault it is a note
    words(&mut status, 0, 0x0248);
    assert_eq!(ids(&status), (Cause::Fault, vec!["moved-from-outside"]));
    // and an ownerless drive can be stopped
    words(&mut status, 0, 0x0337);
    let found = diagnose(&status);
    assert_eq!(found.cause, Cause::TurnsOwnerless);
    assert_eq!(
        found.next.iter().flat_map(Advice::actions).next(),
        Some(&Action::Disable)
    );
    // standing in operation it is not a drive that waits
    status.speed_actual = Some(0.0);
    let found = diagnose(&status);
    assert_eq!(
        (found.cause, found.verdict),
        (Cause::EnabledOwnerless, Verdict::Held)
    );
    assert_eq!(
        found.next.iter().flat_map(Advice::actions).next(),
        Some(&Action::Disable)
    );
}

/// Following the advice for a VLT that does not start must not start it: 0x047E is a start there.
#[test]
fn no_bit_names_of_another_profile_appear() {
    let with = |profile: Profile, stw1: u16, zsw1: u16| DriveStatus {
        drive: "vlt-1".into(),
        model: "VLT",
        profile,
        control_word: Some(profile.control(Stw1(stw1))),
        controller: Some(Some("plc".into())),
        stw1: Some(Stw1(stw1)),
        zsw1: Some(Zsw1(zsw1)),
        ..DriveStatus::default()
    };
    // a level starts, so an old start prevents nothing
    let found = diagnose(&with(Profile::DanfossFc, 0x047F, 0x0270));
    assert_eq!(found.cause, Cause::NotReady);
    assert!(
        found.sentence.contains("though start is commanded"),
        "{}",
        found.sentence
    );
    assert!(found.next.unwrap().to_string().contains("terminal 27"));
    let found = diagnose(&with(Profile::DanfossProfidrive, 0x047F, 0x0270));
    assert_eq!(found.cause, Cause::Inhibited);
    assert_eq!(
        found.next.unwrap(),
        "in the controller: OFF first (control word 0x047E), then ON (0x047F) (Danfoss PROFIdrive)".into()
    );
    let fault = diagnose(&with(Profile::DanfossFc, 0x047F, 0x0278));
    assert_eq!(fault.cause, Cause::Fault);
    let next = fault.next.unwrap().to_string();
    assert!(
        next.contains("control word bit 7") && !next.contains("operation"),
        "{next}"
    );
    for profile in [Profile::DanfossFc, Profile::VaconPpo] {
        for zsw1 in (0..0x4000_u16).map(|bits| (bits >> 11 << 12) | (bits & 0x7FF)) {
            for stw1 in [0, 0x047C, 0x047E, 0x047F, 0x0477, 0x043F] {
                let diagnosis = diagnose(&with(profile, stw1, zsw1));
                let next = diagnosis.next.unwrap_or_default().to_string();
                for word in ["STW1", "0x047E", "0x047F"] {
                    let own = [Stw1::READY, Stw1::RUN].map(|stw1| format!("0x{:04X}", profile.control(stw1)));
                    assert!(!next.contains(word) || own.contains(&word.to_owned()), "{next}");
                }
            }
        }
    }
}

#[test]
fn other_vendors_are_described_with_their_own_bit_names() {
    let base = DriveStatus {
        drive: "vlt-1".into(),
        model: "VLT",
        profile: Profile::DanfossFc,
        control_word: Some(0x0438),
        controller: Some(Some("plc".into())),
        stw1: Some(Stw1(0x0476)),
        zsw1: Some(Zsw1(0x0231)),
        ..DriveStatus::default()
    };
    let off = diagnose(&base);
    assert_eq!(off.cause, Cause::Off);
    assert!(
        off.sentence.contains("(control word 0x0438, "),
        "{}",
        off.sentence
    );
    let next = off.next.unwrap().to_string();
    let word = Profile::DanfossFc.control(Stw1(0x047F));
    assert!(
        next.contains(&format!("0x{word:04X}")) && !next.contains("STW1"),
        "{next}"
    );
    let stopped = DriveStatus {
        warnings: vec![WarningEntry {
            number: 68,
            meaning: Some("Safe stop"),
            ..WarningEntry::default()
        }],
        ..base.clone()
    };
    let found = diagnose(&stopped);
    assert_eq!(found.cause, Cause::Sto);
    assert!(
        found.sentence.ends_with("n68 Safe stop") && found.notes.is_empty(),
        "{found:?}"
    );
    assert!(found.next.unwrap().to_string().contains("terminal 37"));
    // a word of the FC profile has other bits than STW1
    let jogs = DriveStatus {
        control_word: Some(0x0F3C),
        stw1: Some(Stw1(0x070F)),
        zsw1: Some(Zsw1(0x0337)),
        speed_actual: Some(0.0),
        ..base.clone()
    };
    let found = diagnose(&jogs);
    assert_eq!(found.cause, Cause::TwoJogs);
    assert!(
        found.sentence.contains("(control word 0x0F3C, ") && !found.sentence.contains("STW1"),
        "{}",
        found.sentence
    );
    let unpowered = DriveStatus {
        model: "VACON",
        profile: Profile::Profidrive,
        bus_voltage: Some(3.0),
        ..base
    };
    let found = diagnose(&unpowered);
    assert_eq!(found.cause, Cause::NoPower);
    assert!(found.next.unwrap().to_string().contains("ID7"));
}

/// In position mode bit 6 is the edge that starts a task: OFF and ON are words without it.
#[test]
fn the_words_for_off_and_on_start_no_task_in_position_mode() {
    let next = |base: DriveStatus, stw1: u16, zsw1: u16| {
        let mut status = base;
        words(&mut status, stw1, zsw1);
        diagnose(&status).next.expect("advice").to_string()
    };
    for (base, off, on) in [
        (running(), "0x047E", "0x047F"),
        (positioned(), "0x043E", "0x043F"),
    ] {
        assert_eq!(
            next(base.clone(), 0x043E, 0x2231),
            format!("in the controller: ON (STW1 {on})")
        );
        assert_eq!(
            next(base, 0x043F, 0x2270),
            format!("in the controller: OFF first (STW1 {off}), then ON ({on})")
        );
    }
}
