//! Selects the telegram of an axis by its purpose, the telegrams of the drive, and the values it reports.

use profile::catalogue::{Device, TelegramModule};
use profile::state::Mode;
use profile::telegram::{Telegram, signal};

use super::wiring::{Wiring, WiringError};

/// The purpose of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Purpose {
    /// Nothing: the data of the drive are received, and the control word that is sent commands nothing (STW1 without bit
    /// 10). The power stage must be off.
    Observe,
    /// Control word and status word alone: acknowledge, switch on, stop.
    Control,
    /// A speed setpoint.
    #[default]
    Speed,
    /// The jog setpoints of the drive.
    Jog,
    /// Real-time jogging at a speed given from here (STW1 bits 12 and 13).
    RealTimeJog,
    /// Homing.
    Home,
    /// Traversing tasks of the drive's table (program mode).
    Task,
    /// Traversing tasks with values from here (MDI).
    Move,
}

impl Purpose {
    /// Returns the mode of the drive that it needs; `None` when both will do.
    #[must_use]
    pub const fn mode(self) -> Option<Mode> {
        match self {
            Self::Observe | Self::Control | Self::Jog => None,
            Self::Speed => Some(Mode::Velocity),
            Self::Home | Self::Task | Self::Move | Self::RealTimeJog => Some(Mode::Position),
        }
    }

    /// Returns the setpoint signals that it needs besides STW1.
    #[must_use]
    pub const fn signals(self) -> &'static [u16] {
        match self {
            Self::Observe | Self::Control | Self::Jog | Self::Home => &[],
            Self::Speed => &[signal::NSOLL_A],
            Self::Task => &[signal::SATZANW],
            Self::RealTimeJog => &[signal::MDI_VELOCITY, signal::MDI_ACC, signal::MDI_DEC],
            Self::Move => &[
                signal::SATZANW,
                signal::MDI_TARPOS,
                signal::MDI_VELOCITY,
                signal::MDI_ACC,
                signal::MDI_DEC,
                signal::MDI_MOD,
            ],
        }
    }

    /// Telegrams in the order they are tried where the drive's own does not do.
    const fn telegrams(self, mode: Mode) -> &'static [u16] {
        match (self, mode) {
            (Self::Speed, _) | (Self::Observe | Self::Control | Self::Jog | Self::Home, Mode::Velocity) => {
                &[1, 350, 351, 354]
            }
            (Self::Task, _) => &[7, 9, 352, 353],
            // for these the position is worth seeing
            (_, Mode::Position) => &[9, 352, 353, 7, 1],
            (Self::Move | Self::RealTimeJog, Mode::Velocity) => &[9, 352, 353, 7, 1],
        }
    }
}

/// What a drive reports about its telegram.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ReportedTelegram {
    /// PNU 922.
    pub number: Option<u16>,
    /// PNU 915: signal of each word of setpoints, without the empty words at the end.
    pub setpoint: Vec<u16>,
    /// PNU 916: the same of actual values.
    pub actual: Vec<u16>,
}

/// A module to plug and the signals in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// What slot 1 is to carry.
    pub module: TelegramModule,
    /// Where the signals are.
    pub wiring: Wiring,
}

/// No telegram of the drive does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("none of its telegrams carries what this needs{}", because(*reported))]
pub struct NoTelegram {
    /// What is wrong with the one the drive reports, if it was tried.
    pub reported: Option<WiringError>,
}

fn because(reported: Option<WiringError>) -> String {
    reported.map_or_else(String::new, |error| format!(" ({error})"))
}

/// Returns the telegram for a purpose: the one that the drive reports if it carries everything, else the first of the
/// usual ones that the drive has. Homing needs STW1 and ZSW1 alone, but a telegram of positioning (SATZANW) shows where
/// the axis goes. A telegram of positioning does not jog a drive in velocity mode: its STW1 has other bits then.
///
/// ```
/// use profidrive_client::axis::{Purpose, ReportedTelegram, choose_telegram};
/// use profile::catalogue::AKD;
/// use profile::state::Mode;
/// let reported = ReportedTelegram { number: Some(353), ..ReportedTelegram::default() };
/// let number = |purpose, mode| choose_telegram(&AKD.device, &reported, purpose, mode).unwrap().module.telegram;
/// assert_eq!(number(Purpose::Move, Mode::Position), 353);
/// assert_eq!(number(Purpose::Speed, Mode::Velocity), 1);
/// ```
///
/// # Errors
/// When the drive has no telegram that would do.
pub fn choose_telegram(
    device: &Device,
    reported: &ReportedTelegram,
    purpose: Purpose,
    mode: Mode,
) -> Result<Choice, NoTelegram> {
    let fits = |wiring: &Wiring| purpose.signals().iter().all(|&signal| wiring.commands(signal));
    let suits = |wiring: &Wiring| {
        let positions = wiring.commands(signal::SATZANW);
        let speeds = wiring.commands(signal::NSOLL_A);
        let fits_mode = match (purpose, mode) {
            (Purpose::Home, _) => positions,
            (Purpose::Jog, Mode::Velocity) => speeds || !positions,
            _ => true,
        };
        fits(wiring) && fits_mode
    };
    let mut trouble = None;
    let own = reported
        .number
        .and_then(|number| own_wiring(device, reported, number));
    match own {
        Some((module, Ok(wiring))) if suits(&wiring) => return Ok(Choice { module, wiring }),
        Some((_, Err(error))) => trouble = Some(error),
        _ => {}
    }
    purpose
        .telegrams(mode)
        .iter()
        .filter_map(|&number| fixed(device, number))
        .find(|choice| fits(&choice.wiring))
        .ok_or(NoTelegram { reported: trouble })
}

/// Returns the telegram that a person names, if it carries what the purpose needs.
///
/// # Errors
/// When the drive does not have it, or it carries too little.
pub fn named_telegram(
    device: &Device,
    reported: &ReportedTelegram,
    purpose: Purpose,
    number: u16,
) -> Result<Choice, NoTelegram> {
    let own = reported.number == Some(number);
    let found = match own_wiring(device, reported, number).filter(|_| own) {
        Some((module, wiring)) => wiring.map(|wiring| Choice { module, wiring }).ok(),
        None => fixed(device, number),
    };
    found
        .filter(|choice| {
            purpose
                .signals()
                .iter()
                .all(|&signal| choice.wiring.commands(signal))
        })
        .ok_or(NoTelegram { reported: None })
}

/// Returns the process data of a serial line, see [`Telegram::of_line`]; whose bits its words have
/// [`Wiring::with_words`] says.
///
/// # Errors
/// When the purpose needs more than that.
pub fn process_words(device: &Device, purpose: Purpose) -> Result<Wiring, NoTelegram> {
    let telegram = Telegram::of_line(device.vendor_id);
    let wiring = telegram.and_then(|telegram| Wiring::of(telegram, device.vendor_id).ok());
    wiring
        .filter(|wiring| purpose.signals().iter().all(|&signal| wiring.commands(signal)))
        .ok_or(NoTelegram { reported: None })
}

/// Returns the telegram that the drive reports, where its signals are known.
fn own_wiring(
    device: &Device,
    reported: &ReportedTelegram,
    number: u16,
) -> Option<(TelegramModule, Result<Wiring, WiringError>)> {
    let module = *device.telegram(number)?;
    let telegram = Telegram::find(number, device.vendor_id)?;
    let mapped = telegram.free && !reported.setpoint.is_empty() && !reported.actual.is_empty();
    let wiring = if mapped {
        let (setpoint, actual) = (&reported.setpoint, &reported.actual);
        Wiring::new(
            number,
            setpoint.iter().copied(),
            actual.iter().copied(),
            device.vendor_id,
        )
    } else {
        Wiring::of(telegram, device.vendor_id)
    };
    let wiring = wiring.and_then(|wiring| wiring.in_module(module.outputs, module.inputs));
    Some((module, wiring))
}

fn fixed(device: &Device, number: u16) -> Option<Choice> {
    let module = *device.telegram(number)?;
    let telegram = Telegram::find(number, device.vendor_id)?;
    let wiring = Wiring::of(telegram, device.vendor_id).ok()?;
    let wiring = wiring.in_module(module.outputs, module.inputs).ok()?;
    Some(Choice { module, wiring })
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::AKD;

    fn reported(number: u16) -> ReportedTelegram {
        ReportedTelegram {
            number: Some(number),
            ..ReportedTelegram::default()
        }
    }

    #[test]
    fn the_reported_telegram_is_kept_where_it_does() {
        use Mode::{Position, Velocity};
        use Purpose::{Control, Home, Jog, Move, RealTimeJog, Speed, Task};
        for (number, purpose, mode, chosen) in [
            (1, Speed, Velocity, 1),
            (350, Speed, Velocity, 350),
            (351, Speed, Velocity, 351),
            (354, Speed, Velocity, 354),
            (9, Speed, Velocity, 1),
            (9, Move, Position, 9),
            (352, Move, Position, 352),
            (353, Move, Position, 353),
            (400, Move, Position, 400),
            (1, Move, Position, 9),
            (7, RealTimeJog, Position, 9),
            (352, RealTimeJog, Position, 352),
            (7, Move, Position, 9),
            (7, Task, Position, 7),
            (9, Task, Position, 9),
            (353, Task, Position, 353),
            (1, Task, Position, 7),
            (351, Home, Position, 9),
            (1, Home, Position, 9),
            (7, Home, Position, 7),
            (353, Home, Position, 353),
            (7, Jog, Position, 7),
            (7, Jog, Velocity, 1),
            (9, Jog, Velocity, 1),
            (353, Jog, Velocity, 1),
            (350, Jog, Velocity, 350),
            (7, Control, Velocity, 7),
            (999, Jog, Position, 9),
            (999, Control, Velocity, 1),
        ] {
            let choice = choose_telegram(&AKD.device, &reported(number), purpose, mode).unwrap();
            assert_eq!(choice.module.telegram, chosen, "{number} {purpose:?}");
            assert_eq!(choice.wiring.telegram(), chosen);
        }
        let nothing = ReportedTelegram::default();
        let choice = choose_telegram(&AKD.device, &nothing, Move, Position).unwrap();
        assert_eq!(choice.module.telegram, 9);
    }

    #[test]
    fn a_free_telegram_counts_by_its_mapping() {
        let mut reported = reported(0);
        reported.setpoint = vec![1, 5];
        reported.actual = vec![2, 6, 28, 28];
        let of = |reported: &ReportedTelegram, purpose, mode| {
            choose_telegram(&AKD.device, reported, purpose, mode).map(|choice| choice.module.telegram)
        };
        assert_eq!(of(&reported, Purpose::Speed, Mode::Velocity), Ok(0));
        assert_eq!(of(&reported, Purpose::Move, Mode::Position), Ok(9));
        // an inconsistent mapping is not changed
        reported.setpoint = vec![5, 1];
        assert_eq!(of(&reported, Purpose::Speed, Mode::Velocity), Ok(1));
    }

    #[test]
    fn a_drive_without_a_suitable_telegram_is_reported() {
        let mut device = AKD.device;
        device.telegrams = &AKD.device.telegrams[..1];
        assert_eq!(device.telegrams[0].telegram, 1);
        let error = choose_telegram(&device, &reported(1), Purpose::Move, Mode::Position).unwrap_err();
        assert_eq!(error.to_string(), "none of its telegrams carries what this needs");
    }
}
