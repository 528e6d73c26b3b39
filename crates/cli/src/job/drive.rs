//! What a job is read with: the model of its drive, and what is known of the values that scale others.

use drive_client::Model;
use drive_client::parameter::{Interpretation, Parameters, Reading, Selection, take_scale};
use profidrive::catalogue::{Catalogue, Parameter, Scale};
use profidrive::notation::{Elements, ParameterReference, Target};
use profidrive::parameter::{CodeSpace, ErrorNames, ParameterAddress, ValueBlock};
use profidrive::state::Mode;
use profinet::wire::Uuid;

/// Operating mode: decides over the names of some bits of STW1 and ZSW1.
const OPERATING_MODE: u16 = 930;

/// The drive that a job asks, or that answers it. It learns from what is read from it and written to it; what nobody
/// told is assumed to be as delivered, and said to be assumed.
#[derive(Debug, Clone)]
pub struct JobDrive {
    model: Model,
    parameters: Parameters,
    /// Scales whose value was seen.
    known: Vec<Scale>,
    /// The mode, once it was seen.
    mode: Option<Mode>,
}

impl Default for JobDrive {
    /// Nobody said what it is: its numbers are read as those of an AKD.
    fn default() -> Self {
        let device = &profidrive::catalogue::AKD.device;
        Self::of(device.vendor_id, device.device_id)
    }
}

impl JobDrive {
    /// A drive of this vendor and device.
    pub fn of(vendor_id: u16, device_id: u16) -> Self {
        let model = Model::of(vendor_id, device_id);
        Self {
            model,
            parameters: Parameters::of(&model),
            known: Vec::new(),
            mode: None,
        }
    }

    /// The drive that the object of a remote procedure call names; `None` where it names no vendor.
    pub fn of_object(object: &Uuid) -> Option<Self> {
        let (_, device_id, vendor_id) = object.object_parts()?;
        (vendor_id != 0).then(|| Self::of(vendor_id, device_id))
    }

    /// True when both are of one model.
    pub fn is_like(&self, other: &Self) -> bool {
        self.model.name == other.model.name
    }

    /// Its tables, where there are any.
    pub const fn tables(&self) -> Option<&'static Catalogue> {
        self.model.catalogue
    }

    /// The numbers of its formats.
    pub const fn code_space(&self) -> CodeSpace {
        self.model.dialect.code_space
    }

    /// The meanings of its own error numbers.
    pub const fn error_names(&self) -> ErrorNames {
        self.model.dialect.error_names
    }

    /// The mode it is in, as far as it was seen.
    pub fn mode(&self) -> Mode {
        self.mode.unwrap_or_default()
    }

    fn parameter(&self, pnu: u16) -> Option<&'static Parameter> {
        self.tables().and_then(|tables| tables.by_pnu(pnu))
    }

    /// The selection an address means.
    pub fn select(&self, address: ParameterAddress) -> Selection {
        let parameter = self.parameters.at(address.pnu, address.subindex);
        let known = parameter.is_some_and(|parameter| parameter.elements > 1);
        let elements = (known || address.subindex > 0 || address.elements > 1).then(|| Elements {
            first: address.subindex,
            count: u16::from(address.elements.max(1)),
        });
        let reference = ParameterReference {
            target: Target::Number(address.pnu),
            elements,
            prefix: None,
        };
        let number = Selection::number(address.pnu, self.parameters.notation());
        let plain = Selection {
            first: address.subindex,
            count: u16::from(address.elements.max(1)),
            indexed: elements.is_some(),
            parameter,
            ..number
        };
        self.parameters.select(&reference).unwrap_or(plain)
    }

    /// Name and number of what an address means; the high half of a 64-bit value is called so.
    pub fn label(&self, address: ParameterAddress) -> String {
        let label = self.select(address).label();
        match self.tables().and_then(|tables| tables.by_high(address.pnu)) {
            Some(whole) => format!("high half of {} ({label})", whole.name),
            None => label,
        }
    }

    /// The values of a block.
    pub fn readings(&self, address: Option<ParameterAddress>, block: &ValueBlock<'_>) -> Vec<Reading> {
        let selection = address.map_or(Selection::number(0, self.parameters.notation()), |address| {
            self.select(address)
        });
        let interpretation = Interpretation::of(block.format, self.code_space());
        let reading = |at, octets: &[u8]| {
            let reading = self
                .parameters
                .reading(&selection, at, block.format.0, interpretation, octets);
            self.parameters.in_mode(reading, self.mode())
        };
        if matches!(interpretation, Interpretation::Text | Interpretation::Octets) {
            return vec![reading(0, block.data)];
        }
        (0..block.count)
            .filter_map(|at| Some(reading(at.into(), block.octets(at.into())?)))
            .collect()
    }

    /// What the value of this parameter was made with that nobody told: `PN.VELSCALING 1638`.
    pub fn assumption(&self, pnu: u16) -> Option<String> {
        let scale = self.parameter(pnu)?.scale;
        if self.known.contains(&scale) {
            return None;
        }
        let scaling = &self.parameters.scaling;
        Some(match scale {
            Scale::Raw | Scale::Milli | Scale::MdiVelocity | Scale::Decimal(_) | Scale::Percent => {
                return None;
            }
            Scale::Position => format!("PN.POSSCALE {}", scaling.position),
            Scale::Velocity => match scaling.reference {
                Some(reference) => format!("a reference of {reference} rpm"),
                None => format!("PN.VELSCALING {}", scaling.velocity),
            },
            Scale::Acceleration => format!("PN.ACCSCALING {}", scaling.acceleration),
            Scale::Current => format!("DRV.IPEAK {} A", scaling.peak_current),
            Scale::Singleturn => format!("PNU 1002 {}", scaling.singleturn_bits),
        })
    }

    /// Takes over what a value that was read or written tells about the others.
    pub fn learn(&mut self, address: ParameterAddress, block: &ValueBlock<'_>) {
        for reading in self.readings(Some(address), block) {
            if reading.pnu == OPERATING_MODE {
                self.mode = match reading.raw() {
                    Some(1) => Some(Mode::Velocity),
                    Some(2) => Some(Mode::Position),
                    _ => None,
                };
            }
            let number = reading.number().filter(|number| *number > 0.0);
            let scale = number.and_then(|number| {
                self.tables()?;
                take_scale(&mut self.parameters.scaling, reading.pnu, number)
            });
            if let Some(scale) = scale.filter(|scale| !self.known.contains(scale)) {
                self.known.push(scale);
            }
        }
    }
}
