//! `profidrive name`, `profidrive ip`, `profidrive blink`, `profidrive reset`

use std::net::Ipv4Addr;

use client::{Error, ErrorKind, Wait, describe};
use profidrive::addressing::{self, AddressingError, FactoryReset, NewAddress, NewName, check_station_name};
use profinet::IpSuite;

use crate::args::{Blink, Interface, Ip, Name, Reset, ResetMode};
use crate::confirm::{Question, confirm};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;

pub fn name(args: &Name, interface: &Interface, output: &Output) -> Result<(), Failure> {
    // a bad name needs no network
    check_station_name(&args.name)?;
    let (mut session, drive) = connect::drive(&interface.target(&args.drive), Need::Discovery, output)?;
    let wanted = NewName {
        name: args.name.clone(),
        permanent: !args.temporary,
        force: args.force,
        dry_run: args.dry_run,
    };
    let report = addressing::set_name(&mut session, &drive, &wanted).wait()?;
    let kept = kept(args.temporary, "has no name at all");
    let (station, name) = (describe(&drive.station), shown(&args.name));
    output.say(&if args.dry_run {
        format!("dry run: {station} would be {name} ({kept}); nothing was changed")
    } else {
        format!("{station} is {name} now ({kept})")
    });
    output.json_report(&report);
    Ok(())
}

fn shown(name: &str) -> &str {
    if name.is_empty() { "without a name" } else { name }
}

/// Describes how long a name or address lasts. A temporary one deletes the permanent one.
fn kept(temporary: bool, then: &str) -> String {
    if temporary {
        format!("until the next power-on; after it the drive {then}")
    } else {
        "kept over power-off".into()
    }
}

pub fn ip(args: &Ip, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, drive) = connect::drive(&interface.target(&args.drive), Need::Discovery, output)?;
    let ip = IpSuite {
        address: args.address.address,
        mask: args.address.mask(),
        gateway: args.gateway.unwrap_or(Ipv4Addr::UNSPECIFIED),
    };
    let wanted = NewAddress {
        ip,
        permanent: !args.temporary,
        force: args.force,
        dry_run: args.dry_run,
    };
    let report = addressing::set_ip(&mut session, &drive, &wanted).wait()?;
    let kept = kept(args.temporary, "has no address at all");
    let suite = suite(ip, args.address.prefix);
    let label = drive.label();
    output.say(&if args.dry_run {
        format!("dry run: {label} would have {suite} ({kept}); nothing was changed")
    } else {
        format!("{label} has {suite} now ({kept})")
    });
    output.json_report(&report);
    Ok(())
}

/// `10.0.0.2/24, gateway 10.0.0.254`
fn suite(ip: IpSuite, prefix: u8) -> String {
    if ip.gateway.is_unspecified() {
        format!("{}/{prefix}", ip.address)
    } else {
        format!("{}/{prefix}, gateway {}", ip.address, ip.gateway)
    }
}

pub fn blink(args: &Blink, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, drive) = connect::drive(&interface.target(&args.drive), Need::Discovery, output)?;
    let confirmed = || output.say(&format!("{} blinks", describe(&drive.station)));
    let report = addressing::blink(&mut session, &drive, args.time, confirmed).wait()?;
    output.json_report(&report);
    Ok(())
}

pub fn reset(args: &Reset, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let (mut session, mut drive) = connect::drive(&interface.target(&args.drive), Need::Discovery, output)?;
    let what = FactoryReset::from(args.mode);
    if !args.force {
        // no confirmation for what is refused anyway
        addressing::check_reset(&mut session, &mut drive).wait()?;
    }
    if !args.yes {
        let station = describe(&drive.station);
        confirm(
            &mut session,
            &Question {
                text: &format!("Reset {} of {station} to factory values?", what.what()),
                undone: "not reset",
                unasked: "--yes resets without asking",
            },
            output,
        )?;
    }
    let report = addressing::reset(&mut session, &mut drive, what, args.force)
        .wait()
        .map_err(not_reset)?;
    output.say(&format!("{} reset: {}", drive.label(), what.what()));
    output.json_report(&report);
    Ok(())
}

/// Returns the failure of a reset. A refusal that names its reason has its own advice.
fn not_reset(error: AddressingError) -> Failure {
    let refused = matches!(error, AddressingError::Client(Error::Dcp { .. }));
    let failure = Failure::from(error);
    if refused && failure.kind == ErrorKind::Refused && failure.hint.is_empty() {
        failure.hint(OFFERED)
    } else {
        failure
    }
}

/// No station reports by DCP which resets it offers.
const OFFERED: &str = "the drive does not offer this reset; `--mode communication` is offered by every drive, which of \
    application, engineering, all and device are is in its device description (ResetToFactoryModes)";

impl From<ResetMode> for FactoryReset {
    fn from(mode: ResetMode) -> Self {
        match mode {
            ResetMode::Application => Self::Application,
            ResetMode::Communication => Self::Communication,
            ResetMode::Engineering => Self::Engineering,
            ResetMode::All => Self::All,
            ResetMode::Device => Self::Device,
        }
    }
}

#[cfg(test)]
mod tests {
    use client::AtWork;
    use profinet::controller::DcpError;
    use profinet::wire::dcp::{BlockError, DcpOption};

    use super::*;

    #[test]
    fn refuses_a_drive_at_work_and_names_the_cause() {
        let failure = |works| {
            Failure::from(AddressingError::Client(Error::AtWork {
                drive: "akd-1".into(),
                undone: "reset",
                works,
            }))
        };
        for (works, message, hint) in [
            (
                AtWork::Controller("plc".into()),
                "akd-1 is not reset: controller \"plc\" is running it",
                "[choose force]",
            ),
            (
                AtWork::Turns(-600.04),
                "akd-1 is not reset: its axis turns at -600.0 rpm",
                "[disable] stops it",
            ),
            (
                AtWork::Enabled,
                "akd-1 is not reset: its power stage is on",
                "[choose force]",
            ),
        ] {
            let failure = failure(works);
            assert_eq!(
                (failure.kind, failure.message.as_str()),
                (ErrorKind::Safety, message)
            );
            assert!(failure.hint.to_string().contains(hint));
        }
    }

    #[test]
    fn a_reset_refused_in_operation_is_not_one_that_is_not_offered() {
        let refused = |error| {
            let option = DcpOption::FACTORY_RESET;
            not_reset(AddressingError::Client(Error::Dcp {
                drive: "akd-1".into(),
                what: "reset",
                error: DcpError::Refused { option, error },
            }))
        };
        let running = refused(BlockError::InOperation);
        assert_eq!(running.kind, ErrorKind::Refused);
        let hint = running.hint.to_string();
        assert!(hint.contains("stop the motor first"), "{hint}");
        assert_eq!(
            refused(BlockError::SuboptionUnsupported).hint.to_string(),
            OFFERED
        );
    }

    #[test]
    fn the_gateway_is_confirmed() {
        let mut ip = IpSuite {
            address: Ipv4Addr::new(10, 0, 0, 2),
            mask: Ipv4Addr::new(255, 255, 255, 0),
            gateway: Ipv4Addr::UNSPECIFIED,
        };
        assert_eq!(suite(ip, 24), "10.0.0.2/24");
        ip.gateway = Ipv4Addr::new(10, 0, 0, 254);
        assert_eq!(suite(ip, 24), "10.0.0.2/24, gateway 10.0.0.254");
    }

    #[test]
    fn what_is_temporary_leaves_nothing() {
        assert_eq!(
            kept(true, "has no name at all"),
            "until the next power-on; after it the drive has no name at all"
        );
        assert_eq!(kept(false, "has no name at all"), "kept over power-off");
    }
}
