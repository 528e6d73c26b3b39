//! Connects: what was requested, what the device made of it.

use std::time::Duration;

use profile::catalogue::TelegramModule;
use profile::telegram::Telegram;
use profinet::wire::block::{
    ArProperties, ArRequest, ArType, BlockType, Blocks, ConnectResponse, ExpectedModule, ExpectedSubmodule,
    IocrRequest, IocrType,
};
use profinet::wire::{DecodeError, Reader};

use super::diff;
use super::event::{Connect, ConnectSubmodule};
use super::records::api_text;
use crate::Weight;
use crate::job::JobDrive;
use crate::number;

/// Unit of send clock factor and cycle counter.
pub const TICK_NS: u64 = 31_250;

/// A connect request as far as it matters here.
#[derive(Debug)]
pub struct Asked {
    pub ar: Option<ArRequest>,
    pub iocrs: Vec<IocrRequest>,
    pub modules: Vec<ExpectedModule>,
}

/// Reads the blocks of a connect request; unknown blocks are passed over.
pub fn request(reader: Reader<'_>) -> Result<Asked, DecodeError> {
    let mut asked = Asked {
        ar: None,
        iocrs: Vec::new(),
        modules: Vec::new(),
    };
    for block in Blocks::new(reader) {
        let block = block?;
        match block.block_type {
            BlockType::AR_REQUEST => asked.ar = Some(ArRequest::decode(block.body)?),
            BlockType::IOCR_REQUEST if asked.iocrs.len() < 16 => {
                asked.iocrs.push(IocrRequest::decode(block.body)?)
            }
            BlockType::EXPECTED_SUBMODULE if asked.modules.len() < 1024 => {
                asked.modules.extend(ExpectedModule::decode_block(block.body)?);
            }
            _ => {}
        }
    }
    Ok(asked)
}

impl Asked {
    /// Returns the request in words and numbers, one line for each part.
    pub fn words(&self, drive: &JobDrive) -> Vec<(String, Connect)> {
        let mut lines = Vec::new();
        if let Some(ar) = &self.ar {
            let kind = ar_kind(ar.ar_type, ar.properties);
            let name = String::from_utf8_lossy(&ar.station_name).into_owned();
            let text = format!(
                "connect as {kind} \"{name}\", activity time-out {} s",
                number(f64::from(ar.activity_timeout_factor) / 10.0)
            );
            let detail = Connect {
                step: "request",
                ar_type: Some(ar.ar_type.0),
                ar_uuid: Some(ar.ar_uuid.to_string()),
                session: Some(ar.session_key),
                ..Connect::default()
            };
            lines.push((text, detail));
        }
        lines.extend(self.iocrs.iter().map(iocr));
        lines.extend(self.modules.iter().map(|expected| module(drive, expected)));
        lines
    }

    /// Returns the answer in words and numbers.
    pub fn answer(&self, response: &ConnectResponse) -> Vec<(Weight, String, Connect)> {
        let ids: Vec<String> = response
            .iocrs
            .iter()
            .map(|iocr| {
                let direction = if iocr.iocr_type == IocrType::INPUT {
                    "inputs"
                } else {
                    "outputs"
                };
                format!("{direction} FrameID 0x{:04X}", iocr.frame_id)
            })
            .collect();
        let mut text = format!("connected to {}", response.ar.responder_mac);
        if !ids.is_empty() {
            text = format!("{text}, {}", ids.join(", "));
        }
        let detail = Connect {
            step: "response",
            ar_type: Some(response.ar.ar_type.0),
            ar_uuid: Some(response.ar.ar_uuid.to_string()),
            session: Some(response.ar.session_key),
            ..Connect::default()
        };
        let mut lines = vec![(Weight::Normal, text, detail)];
        if let Some(found) = &response.diff {
            lines.extend(diff::lines(found));
        }
        lines
    }
}

fn ar_kind(kind: ArType, properties: ArProperties) -> String {
    let start = if properties.advanced() {
        "advanced start-up"
    } else {
        "legacy start-up"
    };
    match kind {
        ArType::IO_CONTROLLER => format!("IO controller ({start})"),
        _ if properties.device_access() => "parameter tool (device access)".into(),
        ArType::SUPERVISOR => format!("supervisor ({start})"),
        ArType::IRT => format!("isochronous IO controller ({start})"),
        ArType::REDUNDANT => format!("redundant IO controller ({start})"),
        ArType(other) => format!("AR type 0x{other:04X}"),
    }
}

fn iocr(iocr: &IocrRequest) -> (String, Connect) {
    let (direction, plural) = match iocr.iocr_type {
        IocrType::INPUT => ("input", "inputs"),
        IocrType::OUTPUT => ("output", "outputs"),
        _ => ("multicast", "multicast"),
    };
    let cycle = cycle(iocr);
    let watchdog = cycle * u32::from(iocr.watchdog_factor);
    let millis = |time: Duration| number(time.as_secs_f64() * 1e3);
    let text = format!(
        "{plural}: {} octets every {} ms ({} x {} x 31.25 us), watchdog {} x {} ms = {} ms, RT class {}",
        iocr.data_length,
        millis(cycle),
        iocr.reduction_ratio,
        iocr.send_clock_factor,
        iocr.watchdog_factor,
        millis(cycle),
        millis(watchdog),
        iocr.rt_class()
    );
    let detail = Connect {
        step: "iocr",
        direction: Some(direction),
        frame_id: Some(iocr.frame_id),
        octets: Some(iocr.data_length),
        cycle: Some(cycle.as_secs_f64()),
        watchdog: Some(watchdog.as_secs_f64()),
        ..Connect::default()
    };
    (text, detail)
}

/// Returns the time between two frames.
pub fn cycle(iocr: &IocrRequest) -> Duration {
    let ticks = u64::from(iocr.send_clock_factor) * u64::from(iocr.reduction_ratio);
    Duration::from_nanos(ticks * TICK_NS)
}

/// Returns the telegram that a module of slot 1 and above carries: by its ident, by that of a submodule, or by its
/// lengths.
pub fn telegram(drive: &JobDrive, module: &ExpectedModule) -> Option<&'static Telegram> {
    let rows = drive.tables()?.device.telegrams;
    let lengths = |row: &&TelegramModule| {
        let data = |submodule: &ExpectedSubmodule| (submodule.output_length(), submodule.input_length());
        module
            .submodules
            .iter()
            .any(|submodule| data(submodule) == (row.outputs, row.inputs))
    };
    let ident = |row: &&TelegramModule| {
        module
            .submodules
            .iter()
            .any(|submodule| submodule.ident == row.submodule)
    };
    let by_module = rows.iter().find(|row| row.module == module.ident);
    let row = by_module
        .or_else(|| rows.iter().filter(lengths).find(ident))
        .or_else(|| rows.iter().find(lengths));
    drive.telegram(row.filter(|_| module.slot > 0)?.telegram)
}

fn module(drive: &JobDrive, module: &ExpectedModule) -> (String, Connect) {
    let telegram = telegram(drive, module);
    let carries = telegram.map_or_else(String::new, |telegram| {
        format!(", {} telegram {}", drive.name(), telegram.number)
    });
    let submodules: Vec<String> = module
        .submodules
        .iter()
        .map(|submodule| {
            let (input, output) = (submodule.input_length(), submodule.output_length());
            let lengths = if input == 0 && output == 0 {
                String::new()
            } else {
                format!(" ({input} in, {output} out)")
            };
            let subslot = diff::subslot(submodule.subslot);
            format!("subslot {subslot} 0x{:X}{lengths}", submodule.ident)
        })
        .collect();
    let text = format!(
        "expects slot {}{} module 0x{:08X}{carries}: {}",
        module.slot,
        api_text(module.api),
        module.ident,
        submodules.join(", ")
    );
    let detail = Connect {
        step: "module",
        api: Some(module.api),
        slot: Some(module.slot),
        ident: Some(module.ident),
        telegram: telegram.map(|telegram| telegram.number),
        submodules: module
            .submodules
            .iter()
            .map(|submodule| ConnectSubmodule {
                subslot: submodule.subslot,
                ident: submodule.ident,
                input: Some(submodule.input_length()),
                output: Some(submodule.output_length()),
                state: None,
            })
            .collect(),
        ..Connect::default()
    };
    (text, detail)
}

#[cfg(test)]
mod tests {
    use super::*;
    use profinet::MacAddress;

    #[test]
    fn times_as_the_field_writes_them() {
        let request = IocrRequest {
            iocr_type: IocrType::INPUT,
            reference: 1,
            lt: 0x8892,
            properties: 2,
            data_length: 40,
            frame_id: 0x8000,
            send_clock_factor: 32,
            reduction_ratio: 16,
            phase: 1,
            sequence: 0,
            frame_send_offset: u32::MAX,
            watchdog_factor: 3,
            data_hold_factor: 3,
            tag_header: 0xC000,
            multicast: MacAddress::default(),
            apis: Vec::new(),
        };
        assert_eq!(
            iocr(&request).0,
            "inputs: 40 octets every 16 ms (16 x 32 x 31.25 us), watchdog 3 x 16 ms = 48 ms, RT class 2"
        );
    }
}
