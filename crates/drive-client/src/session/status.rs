//! Everything that tells why a drive does not run, read in as few jobs as possible. Reads only.

use profidrive::state::{Stw1, Zsw1};
use profidrive::telegram::signal;

use super::Session;
use crate::axis::Wiring;
use crate::parameter::Reading;
use crate::status::DriveStatus;
use crate::{Drive, Error, Wire};

const TELEGRAM: u16 = 922;
const SETPOINT_SIGNALS: u16 = 915;
const ACTUAL_SIGNALS: u16 = 916;
const MODE: u16 = 930;
/// PNUs of an AKD.
const COMMAND_SOURCE: u16 = 2113;
const DISABLE_SOURCES: u16 = 2120;
const MOTION_STATUS: u16 = 2134;
const NEGATIVE_SWITCH: u16 = 2211;
const POSITIVE_SWITCH: u16 = 2212;
const STO: u16 = 2381;
const SOFTWARE_LIMITS: u16 = 2387;
const SPEED: u16 = 2428;
const MOTION_DISABLE_SOURCES: u16 = 2891;

/// What every drive is asked.
const PROFILE: [u16; 8] = [
    signal::STW1,
    signal::ZSW1,
    signal::NSOLL_A,
    signal::NIST_A,
    TELEGRAM,
    SETPOINT_SIGNALS,
    ACTUAL_SIGNALS,
    MODE,
];
/// What a drive with tables is asked besides.
const MAKER: [u16; 11] = [
    signal::XIST_A,
    COMMAND_SOURCE,
    DISABLE_SOURCES,
    MOTION_STATUS,
    NEGATIVE_SWITCH,
    POSITIVE_SWITCH,
    signal::kollmorgen::XIST_ERROR,
    STO,
    SOFTWARE_LIMITS,
    SPEED,
    MOTION_DISABLE_SOURCES,
];

impl<M: Wire> Session<M> {
    /// Reads how a drive is; [`diagnose`](crate::status::diagnose) says what it comes down to. What the drive refuses
    /// to tell is left out.
    ///
    /// # Errors
    /// When the drive cannot be reached.
    pub fn status(&mut self, drive: &mut Drive) -> Result<DriveStatus, Error> {
        let controller = self.owner(drive)?;
        let known = drive.model.catalogue.is_some();
        let mut numbers = PROFILE.to_vec();
        if known {
            numbers.extend(MAKER);
        }
        let readings = self.read_numbers(drive, &numbers)?;
        let find = |pnu| readings.iter().find(|reading| reading.pnu == pnu);
        let raw = |pnu| find(pnu).and_then(Reading::raw);
        let word = |pnu| raw(pnu).and_then(|raw| u16::try_from(raw & 0xFFFF).ok());
        let flag = |pnu| raw(pnu).map(|raw| raw != 0);
        let own = |pnu| known.then(|| find(pnu)).flatten();
        let (faults, warnings) = match self.fault_report(drive) {
            Ok(report) => (
                report.present().cloned().collect(),
                report.warnings.unwrap_or_default(),
            ),
            Err(Error::Refused { .. } | Error::Changing { .. }) => (Vec::new(), Vec::new()),
            Err(error) => return Err(error),
        };
        let wiring = wiring(drive, &readings);
        let carries = |signal| wiring.as_ref().map(|wiring| wiring.commands(signal));
        let source = own(COMMAND_SOURCE);
        Ok(DriveStatus {
            drive: drive.label(),
            controller,
            stw1: word(signal::STW1).map(Stw1),
            zsw1: word(signal::ZSW1).map(Zsw1),
            telegram: word(TELEGRAM),
            carries_speed: carries(signal::NSOLL_A),
            carries_tasks: carries(signal::SATZANW),
            mode: word(MODE),
            command_source: source.and_then(|_| word(COMMAND_SOURCE)),
            command_source_text: source.and_then(|reading| reading.choice),
            disable_sources: own(DISABLE_SOURCES).and_then(|_| word(DISABLE_SOURCES)),
            motion_disable_sources: own(MOTION_DISABLE_SOURCES).and_then(|_| word(MOTION_DISABLE_SOURCES)),
            motion: own(MOTION_STATUS)
                .and_then(Reading::raw)
                .and_then(|raw| u32::try_from(raw & 0xFFFF_FFFF).ok()),
            torque_allowed: own(STO).and_then(|_| flag(STO)),
            negative_switch: own(NEGATIVE_SWITCH).and_then(|_| flag(NEGATIVE_SWITCH)),
            positive_switch: own(POSITIVE_SWITCH).and_then(|_| flag(POSITIVE_SWITCH)),
            software_limits: own(SOFTWARE_LIMITS).and_then(|_| word(SOFTWARE_LIMITS)),
            faults,
            warnings,
            speed_set: find(signal::NSOLL_A)
                .filter(|_| carries(signal::NSOLL_A) == Some(true))
                .and_then(Reading::number),
            speed_actual: own(SPEED)
                .or_else(|| own(signal::NIST_A))
                .and_then(Reading::number),
            position: own(signal::XIST_A)
                .and_then(Reading::raw)
                .map(|raw| f64::from(raw as i32) / drive.counts_per_turn()),
            following_error: own(signal::kollmorgen::XIST_ERROR).and_then(Reading::number),
        })
    }
}

/// The telegram in use, by the signals that the drive tells.
fn wiring(drive: &Drive, readings: &[Reading]) -> Option<Wiring> {
    let words = |pnu| {
        readings
            .iter()
            .filter(move |reading| reading.pnu == pnu)
            .filter_map(|reading| reading.raw())
            .filter_map(|raw| u16::try_from(raw & 0xFFFF).ok())
    };
    let number = words(TELEGRAM).next()?;
    Wiring::new(
        number,
        words(SETPOINT_SIGNALS),
        words(ACTUAL_SIGNALS),
        drive.station.vendor_id,
    )
    .ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use profidrive::catalogue::AKD;

    #[test]
    fn the_numbers_are_those_of_the_tables() {
        for (pnu, name) in [
            (COMMAND_SOURCE, "DRV.CMDSOURCE"),
            (DISABLE_SOURCES, "DRV.DISSOURCES"),
            (MOTION_STATUS, "DRV.MOTIONSTAT"),
            (NEGATIVE_SWITCH, "HWLS.NEGSTATE"),
            (POSITIVE_SWITCH, "HWLS.POSSTATE"),
            (STO, "STO.STATE"),
            (SOFTWARE_LIMITS, "SWLS.STATE"),
            (SPEED, "VL.FB"),
            (MOTION_DISABLE_SOURCES, "DRV.MOTIONDISSOURCES"),
        ] {
            assert_eq!(AKD.by_name(name).map(|found| found.pnu), Some(pnu), "{name}");
        }
    }
}
