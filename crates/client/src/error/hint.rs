//! What to do about an error.

use profile::catalogue::Part;
use profile::pkw::PkwErrorNames;
use profile::state::Mode;
use profinet::controller::{DcpError, LostCause, ServiceError};
use profinet::wire::PnioStatus;
use profinet::wire::dcp::BlockError;

use super::{Error, MoveEnd};
use crate::axis::{Objection, SpeedUnit, Trouble};
use crate::names::in_models;
use crate::{Action, Advice, Choice, Drive, LocalControl, LossReaction, Remedy};

/// What works without a cyclic connection.
const BY_READING: &str = "parameters can be read at an interval, which opens no cyclic connection";

impl Error {
    /// The drive is there, its parameters are not: they are silent, late or make no sense.
    #[must_use]
    pub const fn is_of_parameters(&self) -> bool {
        matches!(
            self,
            Self::Record { .. } | Self::Timeout { .. } | Self::Malformed { .. } | Self::Channel { .. }
        )
    }

    /// The next thing to do about an axis that may turn.
    fn action(&self) -> Option<Action> {
        match self {
            Self::Ownerless { stop, .. } => Some(stop.clone()),
            Self::LocalOperation {
                by: LocalControl::ServiceChannel,
                ..
            } => Some(Action::Disable),
            Self::ConnectionLost {
                reaction: Some(reaction),
                ..
            }
            | Self::LineSilent {
                reaction: Some(reaction),
                ..
            }
            | Self::CarrierLost {
                reaction: Some(reaction),
                ..
            } if !reaction.action.stops() => Some(Action::Stop),
            // no axis was under control: what was read is read again once the line is well
            Self::ConnectionLost { reaction: None, .. } => Some(Action::Doctor),
            Self::ConnectionLost { .. }
            | Self::LineSilent { .. }
            | Self::CarrierLost { .. }
            | Self::StopInterrupted { .. } => Some(Action::Status),
            _ => None,
        }
    }

    /// Returns the hint, with the parameters of the model of the drive.
    #[must_use]
    pub fn advice_for(&self, drive: &Drive) -> Option<Advice> {
        let advice = self.advice()?;
        let parts: &[Part] = match self {
            Self::SpeedNotReached { .. } => &[
                Part::Acceleration,
                Part::RampUpTime,
                Part::ForwardLimit,
                Part::BackwardLimit,
                Part::Reference,
                Part::PositiveCurrentLimit,
            ],
            Self::SpeedLost { .. } => &[Part::ForwardLimit, Part::BackwardLimit, Part::Reference],
            Self::Axis {
                trouble: Trouble::StuckIn { .. },
                ..
            } => &[Part::DisableSources],
            Self::Axis {
                trouble: Trouble::StillTurns,
                ..
            } => &[Part::Brake],
            Self::Axis {
                trouble: Trouble::HomingNotStarted | Trouble::HomingFailed,
                ..
            } => &[Part::HomeMode, Part::HomeSpeed],
            _ => &[],
        };
        let named = drive.named(parts);
        if named.is_empty() {
            return Some(advice);
        }
        let parameters = named.iter().map(|name| name.replace(' ', "")).collect();
        let more = Advice::from(Action::Read { parameters }).and(" shows more");
        Some(advice.then(more))
    }

    /// What to do about it, where there is something to do.
    #[must_use]
    pub fn advice(&self) -> Option<Advice> {
        let action = self.action().map(Action::sentence);
        let both = self.of_kind().into_iter().chain(action);
        both.reduce(Advice::then)
    }

    fn of_kind(&self) -> Option<Advice> {
        Some(match self {
            Self::Refused { refusal, .. } => refusal.remedy()?,
            Self::Parameter(problem) => super::problem::advice(problem)?,
            Self::Axis { trouble, .. } => of_trouble(trouble).into(),
            Self::Held { error, evidence } => evidence.advice().or_else(|| error.advice())?,
            Self::Objections { objections, .. } => of_each(objections)?,
            Self::LocalOperation { by, .. } => by.remedy().into(),
            Self::RunsOn { reaction, .. } => runs_on(reaction),
            Self::MovesWhenLost { reaction, .. } => {
                let remedy = reaction.remedy.as_ref().map(Remedy::sentence);
                remedy.unwrap_or_default().then(BY_READING.into())
            }
            Self::StatusUnread { .. } => BY_READING.into(),
            Self::Channel { error, .. } => error.remedy(PkwErrorNames::Profile).into(),
            Self::NoAnswer { telegrams, noise, .. } => of_silence(*telegrams, *noise).into(),
            Self::ForeignModule { wanted, plugged, .. } => {
                let description = Advice::from(Action::Choose(Choice::Description)).and(format!(
                    " takes the ident number of telegram {wanted} from the device description of the vendor"
                ));
                match plugged {
                    Some(plugged) => description.and(format!(
                        "; without it only telegram {plugged} works, which is plugged"
                    )),
                    None => description,
                }
            }
            Self::NoSuchTelegram { possible, .. } => {
                let numbers: Vec<String> = possible.iter().map(u16::to_string).collect();
                format!("there are: {}", numbers.join(", ")).into()
            }
            Self::ScaleChanged { .. } => format!(
                "find out what writes the steps of speed signals{}; change them only while the axis is off",
                in_models(&[Part::VelocityScaling])
            )
            .into(),
            Self::NoStopBeside { .. } => {
                "stop it at its controller, at its panel, or by its inputs for coast or stop; a stop over the network is not an emergency stop"
                    .into()
            }
            Self::StopUnanswered { .. } => {
                "it may turn on: stop it at its controller, by its inputs or with its safety circuit; a stop over the network is not an emergency stop"
                    .into()
            }
            Self::SpeedStep { .. } => format!(
                "use one of them, or make the steps finer{}",
                in_models(&[Part::VelocityScaling])
            )
            .into(),
            Self::SpeedRange {
                scaling: Some((name, _)),
                ..
            } => {
                let advice = format!(
                    "use a lower speed, or make its steps coarser: {{describe {name}}} shows the range"
                );
                advice.as_str().into()
            }
            Self::NotMoved { .. } => format!(
                "the jog speed, its ramps{}, a limit of the drive or the load holds it",
                in_models(&[Part::JogAcceleration, Part::JogDeceleration])
            )
            .into(),
            _ => self.of_reaching().or_else(|| self.of_task())?.into(),
        })
    }

    /// What to do when a device cannot be reached.
    fn of_reaching(&self) -> Option<&'static str> {
        Some(match self {
            Self::NotFound { answered, .. } if answered.is_empty() => {
                "check cable, interface and power; {scan} lists the devices that respond"
            }
            Self::NotFound { .. } => "{scan} lists the devices that respond",
            Self::Ambiguous { .. } => {
                "use the MAC address; {blink MAC} shows which is which, {name MAC} renames one"
            }
            Self::SharedAddress { .. } => {
                "give one of them another address: {address MAC}; {blink MAC} shows which is which"
            }
            Self::Dcp {
                error: DcpError::Refused { error, .. },
                ..
            } => match error {
                BlockError::InOperation => {
                    "the device refuses this while its controller is connected or its motor runs; disconnect the controller or stop the motor first"
                }
                BlockError::Resource => "the device could not store it; what it had before stays in force",
                _ => return None,
            },
            Self::NeedsRawFrames { .. } => {
                "name the network interface; raw sockets on it require root or CAP_NET_RAW"
            }
            Self::NeedsCallPort { .. } => {
                "end that program, or use another computer; until then stop the drive at its panel or by its inputs"
            }
            Self::NoIpAddress { .. } => "give it one: {address}",
            Self::OwnedByController { .. } => {
                "stop or disconnect the other controller first; {monitor} and {read} work beside it"
            }
            Self::ParametersOwned { .. } => {
                "identity, plugged modules, neighbours and diagnosis can be read beside the controller; disconnect the controller to read or write parameters"
            }
            Self::NoRoute { .. } => {
                "the device description of the vendor declares which connections the device accepts; a controller that is connected may have the last one"
            }
            Self::NotADrive { .. } => {
                "its identity and plugged modules can be read; parameters, state and motion are those of drives"
            }
            Self::Connect {
                cause: LostCause::Service(ServiceError::Refused { status, .. }),
                ..
            } if faulty_timing(*status) => {
                "the drive does not offer this update time; without {choose cycle} one that it offers is used"
            }
            Self::Connect {
                cause: LostCause::Service(ServiceError::Timeout { .. }),
                ..
            } => {
                "check cable and power, and that its IP address has not gone to another device; {scan} lists the devices that respond, {doctor} measures packet loss and latency"
            }
            Self::Record {
                error: ServiceError::Timeout { .. },
                ..
            }
            | Self::Dcp {
                error: DcpError::Timeout { .. },
                ..
            } => "check cable and power; {doctor} measures packet loss and latency",
            Self::Record {
                error: ServiceError::NotReady { .. },
                ..
            } => {
                "the drive is there, but its parameter channel does not answer: another tool may hold it, or it is busy; try again"
            }
            Self::UnknownModel { .. } => {
                "if it is one of the known drives under another number, {choose model} takes it for that"
            }
            Self::LineSilent { .. } => "check line and adapter",
            Self::OtherWire { .. } => {
                "fc:PORT/ADDRESS and uss:PORT/ADDRESS are at a serial line, all others on a network"
            }
            _ => return None,
        })
    }

    /// What to do when the drive is there and does not do what was tried.
    const fn of_task(&self) -> Option<&'static str> {
        Some(match self {
            Self::Changing { .. } => {
                "read it again; faults that come and go have a cause that comes and goes"
            }
            Self::NotAtRest { .. } => {
                "switch it off first (OFF1, or stop its controller); {status} shows why it is on"
            }
            Self::SpeedOnly { .. } | Self::NoJog { .. } => "{run} turns it at a speed",
            Self::WrongMode { needed, .. } => match needed {
                Mode::Velocity => "{write 930=1} changes it, {choose mode} does for this motion alone",
                Mode::Position => "{write 930=2} changes it, {choose mode} does for this motion alone",
            },
            Self::SpeedLost { .. } => {
                "something else stopped or limits it ({stop}, a limit of the drive, a limit switch) or the load holds it"
            }
            Self::SpeedUnit {
                wanted: SpeedUnit::Rpm,
                ..
            } => {
                "give the speed in percent ({choose percent}), or say what 100 % is: {choose reference-speed}"
            }
            Self::SpeedUnit { .. } | Self::NoFrequency { .. } => "give the speed in rpm",
            Self::SpeedRange { .. } => "use a lower speed",
            Self::SpeedNotReached { .. } => "the ramp, a limit of the drive or the load holds it",
            Self::NotEnabled { .. } => "enable it again",
            Self::HomingEnded { .. } => "{home} homes it again",
            Self::MoveEnded {
                end: MoveEnd::Paused, ..
            } => "resume the motion, or halt it",
            Self::MoveEnded { .. } => "{move} goes on to the target",
            Self::NotInTime { .. } => "{choose time} gives it more time; {status} shows what holds it",
            Self::SpeedLimit { .. } => "raise the limit with {choose speed-limit} if the machine allows it",
            _ => return None,
        })
    }
}

/// What to do about an axis that does not follow.
const fn of_trouble(trouble: &Trouble) -> &'static str {
    match trouble {
        Trouble::Fault => "{faults} shows the fault, {acknowledge} acknowledges it",
        Trouble::FaultStays => "remove the cause, then acknowledge again",
        Trouble::LocalOperation => "hand control over to the PLC at the drive or in its software",
        Trouble::StuckIn { .. } => "check enable inputs, STO and DC bus: {status}",
        Trouble::LeftOperation { .. } => "something else switched it off: check enable inputs and STO",
        Trouble::Stopped => "enable it again once the reason is gone",
        Trouble::Unattended => "the program that moves it has to attend to it more often; enable it again",
        Trouble::StillTurns => "keep clear of it; apply a brake or take the load away",
        Trouble::QuickStopUsed | Trouble::NotStopped => "check the deceleration of the drive and the load",
        Trouble::NoInputs => {
            "the module plugged may be that of another telegram than PNU 922 says: {choose description} takes the right one from the device description of the vendor; {info} shows what is plugged"
        }
        Trouble::OtherMode { .. } => "{read p930} shows the mode",
        Trouble::NotAccepted { homed: false } => "{home} sets the home position",
        Trouble::NotAccepted { homed: true } | Trouble::AcceptanceStays | Trouble::TargetNotReached => {
            "{status} shows why: faults, warnings, limits, the task itself"
        }
        Trouble::HomingNotStarted | Trouble::HomingFailed => "check how it is to home and the switches",
    }
}

/// What to do when no drive answers at a line, by what was received there.
fn of_silence(telegrams: u64, noise: u64) -> String {
    let address = Part::LineAddress;
    match (telegrams, noise) {
        (0, 0) => format!(
            "check that the drive is on, its protocol and address{}, A and B of the wire",
            in_models(&[Part::LineProtocol, address])
        ),
        (_, 0) => format!("check the address of the drive{}", in_models(&[address])),
        _ => format!(
            "check parity and baud rate{}, and the termination of the line",
            in_models(&[Part::LineBaudRate, Part::LineParity])
        ),
    }
}

/// What to do about each of them; the same advice once.
fn of_each(objections: &[Objection]) -> Option<Advice> {
    let mut all: Vec<Advice> = Vec::new();
    for advice in objections.iter().map(Objection::advice) {
        if !all.contains(&advice) {
            all.push(advice);
        }
    }
    all.into_iter().reduce(Advice::then)
}

/// Faulty IOCRBlockReq: send clock, reduction ratio.
const fn faulty_timing(status: PnioStatus) -> bool {
    status.code1 == 2 && matches!(status.code2, 10 | 11)
}

/// The setting that stops the axis, or the consent.
fn runs_on(reaction: &LossReaction) -> Advice {
    let remedy = reaction.remedy.as_ref().map(Remedy::sentence);
    remedy
        .unwrap_or_default()
        .then("{choose run-on} accepts that it may run on".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn each_objection_to_a_move_has_its_own_advice() {
        let limit = |upper| Objection::SoftwareLimit {
            target: 10.0,
            limit: 9.5,
            upper,
        };
        let error = Error::Objections {
            drive: "akd-1".into(),
            objections: vec![Objection::NotHomed, limit(true), limit(false)],
        };
        let hint = error.advice().unwrap().to_string();
        assert!(hint.starts_with("[home] sets the home position; [read"), "{hint}");
        assert_eq!(hint.matches("SWLS.LIMIT1").count(), 1, "{hint}");
    }

    #[test]
    fn a_silent_line_names_the_settings_of_the_models_that_have_them() {
        let noise = of_silence(0, 12);
        assert!(noise.contains("(VLT: 8-32, 8-33)"), "{noise}");
        let nothing = of_silence(0, 0);
        assert!(nothing.contains("(VLT: 8-30, 8-31)"), "{nothing}");
    }

    #[test]
    fn a_drive_that_is_gone_while_connecting_has_advice() {
        let error = Error::Connect {
            drive: "akd-1".into(),
            cause: LostCause::Service(ServiceError::Timeout {
                what: "connect",
                path: profinet::rpc::PathCount::default(),
            }),
        };
        let hint = error.advice().unwrap().to_string();
        assert!(
            hint.contains("cable and power") && hint.contains("[scan]") && hint.contains("[doctor]"),
            "{hint}"
        );
    }

    /// How an update time is given is up to the front end.
    #[test]
    fn an_update_time_that_is_refused_has_advice_without_an_option() {
        let refused = |code2| Error::Connect {
            drive: "akd-1".into(),
            cause: LostCause::Service(ServiceError::Refused {
                what: "connect",
                status: PnioStatus {
                    code: 0xDB,
                    decode: 0x81,
                    code1: 2,
                    code2,
                },
            }),
        };
        let hint = refused(10).advice().unwrap().to_string();
        assert!(hint.contains("update time") && !hint.contains("--"), "{hint}");
        assert_eq!(refused(1).advice(), None);
    }

    #[test]
    fn a_channel_that_is_never_ready_is_reported_once() {
        let error = Error::Record {
            drive: "akd-1".into(),
            what: "parameter access".into(),
            error: ServiceError::NotReady {
                limit: Duration::from_secs(10),
                status: PnioStatus {
                    code: 0xDE,
                    decode: 0x80,
                    code1: 0xB5,
                    code2: 0,
                },
            },
        };
        let text = error.to_string();
        assert!(
            text.starts_with("akd-1: parameter access: not ready within 10000 ms"),
            "{text}"
        );
        assert!(
            error
                .advice()
                .is_some_and(|advice| advice.to_string().contains("try again"))
        );
    }
}
