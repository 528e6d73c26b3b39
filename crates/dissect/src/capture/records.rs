//! Records by number.

use profile::catalogue::{Parameter, RecordView, Scale, Scaling};
use profile::parameter::ParameterAddress;
use profinet::wire::PnioStatus;

use super::diff;
use crate::job::JobDrive;
use crate::{hex_bytes, value};

/// A record that is a parameter: its number is that of the parameter, its content the raw value.
#[derive(Debug)]
pub struct ParameterRecord {
    /// Name and number of the parameter, and which view it is.
    pub name: String,
    address: ParameterAddress,
    view: &'static RecordView,
}

/// Returns the parameter that a record of a drive is, where the drive has such records.
pub fn parameter(drive: &JobDrive, slot: u16, subslot: u16, index: u16) -> Option<ParameterRecord> {
    // these are records of the profile or of PROFINET
    if index >= 0x8000 || index == 0x002F {
        return None;
    }
    let view = drive.record_view(slot, subslot)?;
    let address = drive.of_record(index)?;
    let name = format!("{}, {}-bit record", drive.label(address), 8 * view.octets);
    Some(ParameterRecord { name, address, view })
}

impl ParameterRecord {
    /// Returns the value, or the octets where they are too many for one.
    pub fn content(&self, drive: &JobDrive, data: &[u8]) -> String {
        if data.is_empty() || data.len() > 4 {
            return content(data);
        }
        let finer = drive
            .parameter(self.address)
            .and_then(|parameter| self.finer(parameter, data));
        let text = finer.unwrap_or_else(|| value::full(&drive.number(self.address, data)));
        format!("{text}   [{}]", hex_bytes(data))
    }

    /// Returns the difference of the 32-bit view from the parameter's own type: finer steps, or a wider range.
    fn finer(&self, parameter: &Parameter, data: &[u8]) -> Option<String> {
        let octets: [u8; 4] = data.try_into().ok().filter(|_| self.view.octets == 4)?;
        let native = if parameter.signed {
            i64::from(i32::from_be_bytes(octets))
        } else {
            i64::from(u32::from_be_bytes(octets))
        };
        let factor = self.view.factor(parameter);
        let (raw, rest) = (native / factor, native % factor);
        let plain = factor == 1 && rest == 0 && parameter.range().contains(&raw);
        if plain || !matches!(parameter.scale, Scale::Raw | Scale::Decimal(_)) {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "32 bits")]
        let value = parameter.engineering(native, &Scaling::default()) / factor as f64;
        // no more digits than the steps have
        let rounded = (value * 1e4).round() / 1e4;
        Some(format!("{rounded} {}", parameter.unit).trim_end().to_owned())
    }
}

/// Returns the name of a record index.
pub fn name(index: u16) -> String {
    let known = match index {
        0x002F => "parameter access (record 47)",
        0xB02E => "parameter access local",
        0xB02F => "parameter access global",
        0xAFF0 => "I&M0",
        0xAFF1 => "I&M1 (function and location)",
        0xAFF2 => "I&M2 (installation date)",
        0xAFF3 => "I&M3 (descriptor)",
        0xAFF4 => "I&M4 (signature)",
        0x8000 | 0xC000 | 0xE000 => "expected identification",
        0x8001 | 0xC001 | 0xE001 | 0xF000 => "real identification",
        0xE002 => "module differences",
        0x800A | 0xC00A | 0xE00A | 0xF00A => "diagnosis of channels",
        0x800B | 0xC00B | 0xE00B | 0xF00B => "diagnosis",
        0x800C | 0xC00C | 0xE00C | 0xF00C | 0xF80C => "diagnosis, maintenance and status",
        0x8010 | 0xC010 | 0xE010 | 0xF010 | 0x8012 | 0xC012 | 0xE012 | 0xF012 => "maintenance required",
        0x8011 | 0xC011 | 0xE011 | 0xF011 | 0x8013 | 0xC013 | 0xE013 | 0xF013 => "maintenance demanded",
        0x801E => "substitute value",
        0x8028 => "input data",
        0x8029 => "output data",
        0x802A => "PDPortDataReal",
        0x802B => "PDPortDataCheck",
        0x802F => "PDPortDataAdjust",
        0x8071 => "PDInterfaceAdjust",
        0x8072 => "PDPortStatistic",
        0x8080 => "PDInterfaceDataReal",
        0xE040 => "multiple write",
        0xE050 => "ARFSUDataAdjust",
        0xF020 | 0xF820 => "AR data",
        0xF821 => "API data",
        0xF830 => "log data",
        0xF831 => "PDevData",
        0xF840 => "I&M0 filter data",
        0xF841 => "PDRealData",
        0xF842 => "PDExpectedData",
        0xFBFF => "trigger of the connection monitoring",
        _ => return format!("record 0x{index:04X}"),
    };
    format!("{known} (0x{index:04X})")
}

/// Returns the place of a record: `slot 1/1`.
pub fn place(api: u32, slot: u16, subslot: u16) -> String {
    format!("slot {slot}/{}{}", diff::subslot(subslot), api_text(api))
}

/// ` API 0x3A00`; nothing for the default API.
pub fn api_text(api: u32) -> String {
    if api == 0 {
        String::new()
    } else {
        format!(" API 0x{api:04X}")
    }
}

/// Returns the start of its data.
pub fn content(data: &[u8]) -> String {
    const SHOWN: usize = 16;
    match data.split_at_checked(SHOWN) {
        Some((start, rest)) if !rest.is_empty() => format!("{} octets {} ..", data.len(), hex_bytes(start)),
        _ => format!("{} octets {}", data.len(), hex_bytes(data))
            .trim_end()
            .to_owned(),
    }
}

/// Returns a status as one number, ErrorCode first.
pub fn number(status: PnioStatus) -> u32 {
    u32::from_be_bytes([status.code, status.decode, status.code1, status.code2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_of_a_vacon_are_parameters() {
        let drive = JobDrive::of(0x01BA, 0x0100);
        let record = parameter(&drive, 1, 1, 103).unwrap();
        assert_eq!(record.name, "Acceleration time 1 (ID 103), 16-bit record");
        let text = record.content(&drive, &[0, 50]);
        assert!(text.ends_with(" s   [00 32]"), "{text}");
        assert!(
            parameter(&drive, 1, 2, 103)
                .unwrap()
                .name
                .ends_with("32-bit record")
        );
        for (subslot, index, data, words) in [
            (1, 102, &[0x13, 0x88][..], "50 Hz   [13 88]"),
            (2, 102, &[0x00, 0x07, 0xA1, 0x20], "50 Hz   [00 07 A1 20]"),
            (2, 102, &[0x00, 0x09, 0x27, 0xC0], "60 Hz   [00 09 27 C0]"),
            (2, 102, &[0x00, 0x09, 0x27, 0xC1], "60.0001 Hz   [00 09 27 C1]"),
            (2, 102, &[0xFF; 4], "429496.7295 Hz   [FF FF FF FF]"),
            (2, 103, &[0x00, 0x01, 0x00, 0x00], "6553.6 s   [00 01 00 00]"),
            (2, 103, &[0x00, 0x00, 0x00, 0x32], "5 s   [00 00 00 32]"),
            (2, 2, &[0xFF, 0xFF, 0xFA, 0x24], "-1500 rpm   [FF FF FA 24]"),
        ] {
            let text = parameter(&drive, 1, subslot, index)
                .unwrap()
                .content(&drive, data);
            assert_eq!(text, words, "{subslot} {index}");
        }
        assert!(parameter(&drive, 0, 1, 103).is_none() && parameter(&drive, 1, 1, 0xAFF0).is_none());
        assert!(parameter(&JobDrive::default(), 1, 1, 103).is_none());
    }

    #[test]
    fn records_have_names_where_there_are_any() {
        assert_eq!(name(0xFBFF), "trigger of the connection monitoring (0xFBFF)");
        assert_eq!(name(0x1234), "record 0x1234");
        assert_eq!(name(0xE050), "ARFSUDataAdjust (0xE050)");
        assert_eq!(name(0xF820), "AR data (0xF820)");
    }
}
