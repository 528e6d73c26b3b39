//! What a job is read with: the model of its drive, and what is known of the values that scale others.

use profile::catalogue::{Access, Catalogue, Parameter, Part, RecordView, Scale, Tables};
use profile::model::Model;
use profile::notation::{Elements, Notation, ParameterReference, Prefix, Target};
use profile::parameter::{
    Attribute, CodeSpace, Dialect, ErrorNames, Format, Objection, ParameterAddress, ValueBlock, objections,
    pnu,
};
use profile::pkw::{MAX_BLOCK, Pkw, PkwDialect, PkwErrorNumber, ReplyCode, Server, TEXT_AT};
use profile::state::{Mode, Profile};
use profile::telegram::{Telegram, signal};
use profile::value::{Interpretation, Parameters, Reading, Selection, take_scale};
use profinet::wire::Uuid;
use uss::Protocol;

/// Maximum number of stored words of one direction.
const MOST_WORDS: usize = 16;

/// The drive that receives or answers a job. Values read and written update its scaling. Unknown values are assumed as
/// delivered and reported as assumed.
#[derive(Debug, Clone)]
pub struct JobDrive {
    model: Model,
    parameters: Parameters,
    /// Scales whose value is in the capture.
    known: Vec<Scale>,
    /// PNU 930, if captured.
    operating_mode: Option<i64>,
    /// The telegram that PNU 922 names, if captured.
    selected: Option<&'static Telegram>,
    /// Words of PNU 915 that were seen, with their subindex: what a free telegram carries instead of what is delivered.
    mapped: Vec<(u16, u16)>,
    /// Value of the parameter that selects the vendor's own control word, if captured.
    chosen: Option<i64>,
    /// The model was not given.
    assumed: bool,
}

impl Default for JobDrive {
    /// Without a model: numbers are decoded as those of an AKD.
    fn default() -> Self {
        let device = &profile::catalogue::AKD.device;
        Self {
            assumed: true,
            ..Self::of(device.vendor_id, device.device_id)
        }
    }
}

impl JobDrive {
    /// Creates a drive of this vendor and device.
    pub fn of(vendor_id: u16, device_id: u16) -> Self {
        Self::new(Model::of(vendor_id, device_id))
    }

    /// Creates a drive of this model.
    pub fn new(model: Model) -> Self {
        Self {
            parameters: Parameters::of(&model),
            model,
            known: Vec::new(),
            operating_mode: None,
            selected: None,
            mapped: Vec::new(),
            chosen: None,
            assumed: false,
        }
    }

    /// Returns the rules for its requests; those of the profile when the model is not given.
    pub const fn dialect(&self) -> &'static Dialect {
        if self.assumed {
            &Dialect::STANDARD
        } else {
            self.model.dialect
        }
    }

    /// Returns the parts of a request that its dialect and its tables forbid.
    pub fn objections(&self, request: &[u8]) -> Vec<Objection> {
        let tables = self.tables().filter(|_| !self.assumed);
        match tables.map(Tables) {
            Some(mut tables) => objections(request, self.dialect(), Some(&mut tables)),
            None => objections(request, self.dialect(), None),
        }
    }

    /// The error number with which its tables refuse a request of the parameter channel; `text` is what stands in the place
    /// of PWE in a text block. A parameter that is not in the tables is not refused: a drive can have more.
    pub fn pkw_refusal(
        &self,
        dialect: &PkwDialect,
        request: Pkw,
        text: Option<&[u8]>,
    ) -> Option<PkwErrorNumber> {
        let mut tables = Tables(self.tables().filter(|_| !self.assumed)?);
        let octets = request.to_octets();
        let block = match text {
            Some(text) => [octets.get(..TEXT_AT)?, text].concat(),
            None => octets.to_vec(),
        };
        let mut out = [0; MAX_BLOCK];
        let mut server = Server::new(*dialect);
        server.handle_block(&block, &mut tables, &mut out).ok()?;
        let reply = Pkw::from_octets(*out.first_chunk()?);
        let number = PkwErrorNumber(reply.pwe_low());
        let refused = reply.reply_code() == ReplyCode::REFUSED && number != PkwErrorNumber::UNKNOWN_PARAMETER;
        refused.then_some(number)
    }

    /// Returns the drive that the object of a remote procedure call names; `None` where it names no vendor.
    pub fn of_object(object: &Uuid) -> Option<Self> {
        let (_, device_id, vendor_id) = object.object_parts()?;
        (vendor_id != 0).then(|| Self::of(vendor_id, device_id))
    }

    /// Returns true when both are of one model.
    pub fn is_like(&self, other: &Self) -> bool {
        self.model.name == other.model.name
    }

    /// Returns the name of its model.
    pub const fn name(&self) -> &'static str {
        self.model.name
    }

    /// Returns its tables, where there are any.
    pub const fn tables(&self) -> Option<&'static Catalogue> {
        self.model.catalogue
    }

    /// Returns the numbers of its formats.
    pub const fn code_space(&self) -> CodeSpace {
        self.model.dialect.code_space
    }

    /// Returns the meanings of its own error numbers.
    pub const fn error_names(&self) -> ErrorNames {
        self.model.dialect.error_names
    }

    /// Returns the operating mode, if captured.
    pub fn mode(&self) -> Mode {
        self.mode_in(None)
    }

    /// Returns the mode of a word in this telegram: that of PNU 930, else what the telegram is for.
    pub fn mode_in(&self, telegram: Option<&Telegram>) -> Mode {
        let telegram = telegram.or(self.selected);
        match (self.operating_mode, telegram) {
            (None, Some(free)) if free.free && !self.mapped.is_empty() => {
                if self.maps(free, signal::SATZANW) {
                    Mode::Position
                } else {
                    Mode::Velocity
                }
            }
            (mode, telegram) => Mode::of(mode, telegram),
        }
    }

    /// True when nothing shows the mode of the words in this telegram: its mapping is free, none is as delivered, and none
    /// was seen.
    pub fn is_mode_open(&self, telegram: &Telegram) -> bool {
        let unmapped = telegram.free && telegram.setpoint.octets == 0 && self.mapped.is_empty();
        unmapped && self.operating_mode.is_none()
    }

    /// Returns true when a free telegram carries this setpoint: by the words that were seen, and where none was, as
    /// delivered.
    fn maps(&self, free: &Telegram, number: u16) -> bool {
        let seen = |index: u16| self.mapped.iter().find(|(word, _)| *word == index);
        let left = (0..).zip(free.setpoint.words());
        let mut left = left.filter(|(index, _)| seen(*index).is_none());
        self.mapped.iter().any(|(_, mapped)| *mapped == number) || left.any(|(_, mapped)| mapped == number)
    }

    /// Returns its parameter channel in the words of a PPO.
    pub const fn ppo(&self) -> &'static PkwDialect {
        match self.model.dialect.error_names {
            ErrorNames::Danfoss => &PkwDialect::DANFOSS_PPO,
            _ => &PkwDialect::STANDARD,
        }
    }

    /// Returns its parameter channel at a serial line: that of its vendor, or that of the protocol.
    pub fn line(&self, protocol: Protocol) -> PkwDialect {
        PkwDialect::of_line(self.vendor(), protocol == Protocol::Fc)
    }

    fn vendor(&self) -> Option<u16> {
        self.tables().map(|tables| tables.device.vendor_id)
    }

    /// Returns the telegram of this number.
    pub fn telegram(&self, number: u16) -> Option<&'static Telegram> {
        Telegram::find(number, self.vendor().unwrap_or(0))
    }

    /// Returns whose control and status word a telegram carries.
    pub fn words(&self, telegram: Option<&Telegram>) -> Profile {
        self.model.words.of(telegram, self.chosen)
    }

    /// Returns the assumption that the names of the bits are based on: `8-10 FC profile`.
    pub fn assumed_words(&self, telegram: Option<&Telegram>) -> Option<String> {
        if self.chosen.is_some() || !telegram?.own_words {
            return None;
        }
        let words = &self.model.words;
        let (value, _) = words.chosen.iter().find(|(_, profile)| *profile == words.own)?;
        let chooser = self.tables()?.part(Part::ControlProfile)?;
        let number = Selection::number(chooser.pnu, self.parameters.notation()).label();
        Some(format!("{number} {}", chooser.choice(*value)?))
    }

    /// Returns the view that records of a subslot are, where they are parameters.
    pub fn record_view(&self, slot: u16, subslot: u16) -> Option<&'static RecordView> {
        let views = self.tables()?.device.layout.records;
        views.iter().find(|view| slot == 1 && view.subslot == subslot)
    }

    /// Returns the parameter that a record of such a view is.
    pub fn of_record(&self, index: u16) -> Option<ParameterAddress> {
        match self.tables()?.notation {
            Notation::Id { pnu } => Some(ParameterAddress::value(pnu, index)),
            _ => None,
        }
    }

    /// Returns the parameter of the tables that an address means.
    pub fn parameter(&self, address: ParameterAddress) -> Option<&'static Parameter> {
        self.tables()?.at(address.pnu, address.subindex)
    }

    /// Returns the selection an address means.
    pub fn select(&self, address: ParameterAddress) -> Selection {
        let parameter = self.parameter(address);
        let known = parameter.is_some_and(|parameter| parameter.elements > 1 || parameter.base.is_some());
        let elements = (known || address.subindex > 0 || address.elements > 1).then(|| Elements {
            first: address.subindex,
            count: u16::from(address.elements.max(1)),
        });
        let reference = ParameterReference {
            target: Target::Number(address.pnu),
            elements,
            // a number on the wire is a PNU, never an application id
            prefix: Some(Prefix::Number),
        };
        self.parameters.select(&reference).unwrap_or_else(|_| Selection {
            first: address.subindex,
            count: u16::from(address.elements.max(1)),
            indexed: elements.is_some(),
            parameter,
            ..Selection::number(address.pnu, self.parameters.notation())
        })
    }

    /// Returns the name and number of what an address means; the high half of a 64-bit value is called so.
    pub fn label(&self, address: ParameterAddress) -> String {
        let label = self.select(address).label();
        match self.tables().and_then(|tables| tables.by_high(address.pnu)) {
            Some(whole) => format!("high half of {} ({label})", whole.name),
            None => label,
        }
    }

    /// Returns the name and number of a parameter as a whole.
    pub fn whole_label(&self, pnu: u16) -> String {
        let parameter = self.parameter(ParameterAddress::value(pnu, 0));
        let number = Selection::number(pnu, self.parameters.notation());
        Selection { parameter, ..number }.label()
    }

    /// Returns the values of a block. The elements of a description and texts have neither the unit nor the subindex of
    /// a value.
    pub fn readings(&self, address: Option<ParameterAddress>, block: &ValueBlock<'_>) -> Vec<Reading> {
        let value = address.filter(|address| address.attribute == Attribute::Value);
        let selection = value.map_or_else(
            || {
                let pnu = address.map_or(0, |address| address.pnu);
                Selection::number(pnu, self.parameters.notation())
            },
            |address| self.select(address),
        );
        let interpretation = Interpretation::of(block.format, self.code_space());
        let untyped = Parameters {
            catalogue: None,
            ..self.parameters
        };
        let reading = |at, octets: &[u8]| match (value, address) {
            (None, Some(address)) => {
                let parameter = self.select(address).parameter;
                Reading {
                    name: parameter.map(|parameter| parameter.name),
                    // the number is written as that of the parameter
                    writable: parameter.map(|parameter| parameter.access != Access::ReadOnly),
                    ..untyped.reading(&selection, 0, block.format.0, interpretation, octets)
                }
            }
            _ => {
                let reading = self
                    .parameters
                    .reading(&selection, at, block.format.0, interpretation, octets);
                self.parameters.in_words(reading, None, self.mode())
            }
        };
        if matches!(interpretation, Interpretation::Text | Interpretation::Octets) {
            return vec![reading(0, block.data)];
        }
        (0..block.count)
            .filter_map(|at| Some(reading(at.into(), block.octets(at.into())?)))
            .collect()
    }

    /// Returns a number that came without a format: in a parameter channel, in cyclic data or as a record. The
    /// parameter's own type says what it is.
    pub fn number(&self, address: ParameterAddress, octets: &[u8]) -> Reading {
        let parameter = self.parameter(address);
        let typed = parameter.map(|parameter| Interpretation::of(parameter.format, CodeSpace::V4));
        let interpretation = typed
            .filter(|typed| !matches!(typed, Interpretation::Text | Interpretation::Octets))
            .unwrap_or(Interpretation::Plain);
        let used = parameter.map_or(octets.len(), |parameter| parameter.size.octets());
        let octets = octets
            .len()
            .checked_sub(used)
            .and_then(|unused| octets.get(unused..))
            .unwrap_or(octets);
        let format = match octets.len() {
            1 => Format::BYTE,
            2 => Format::WORD,
            _ => Format::DOUBLE_WORD,
        };
        let selection = self.select(address);
        let reading = self
            .parameters
            .reading(&selection, 0, format.0, interpretation, octets);
        self.parameters.in_words(reading, None, self.mode())
    }

    /// Returns the speed in rpm of a number of NSOLL_A or NIST_A, and the assumption it is based on, if any. `full` is
    /// the number of 100 % where the telegram has a scale of its own.
    pub fn speed(&self, raw: i64, full: Option<u16>) -> (f64, Option<String>) {
        let scaling = &self.parameters.scaling;
        let rpm = match (full, scaling.reference) {
            #[expect(clippy::cast_precision_loss, reason = "words")]
            (Some(full), Some(reference)) => raw as f64 * reference / f64::from(full),
            _ => scaling.speed().engineering(raw),
        };
        (rpm, self.assumed_scale(Scale::Velocity))
    }

    /// Returns a number of NSOLL_A or NIST_A in percent, where 100 % has a number.
    pub fn percent(&self, raw: i64, full: Option<u16>) -> Option<f64> {
        let n2 = self.parameters.scaling.reference.map(|_| 0x4000);
        #[expect(clippy::cast_precision_loss, reason = "words")]
        full.or(n2).map(|full| raw as f64 * 100.0 / f64::from(full))
    }

    /// Returns the assumption that the value of this parameter is based on: `PN.VELSCALING 1638`.
    pub fn assumption(&self, address: ParameterAddress) -> Option<String> {
        if address.attribute != Attribute::Value {
            return None;
        }
        self.assumed_scale(self.parameter(address)?.scale)
    }

    fn assumed_scale(&self, scale: Scale) -> Option<String> {
        if self.known.contains(&scale) || scale.is_fixed() {
            return None;
        }
        let scaling = &self.parameters.scaling;
        Some(match scale {
            Scale::Raw
            | Scale::Milli
            | Scale::MdiVelocity
            | Scale::NominalVelocity
            | Scale::Decimal(_)
            | Scale::Percent => {
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

    /// Updates the scaling of other values from a value that was read or written.
    pub fn learn(&mut self, address: ParameterAddress, block: &ValueBlock<'_>) {
        for reading in self.readings(Some(address), block) {
            self.learn_from(&reading);
        }
    }

    /// Updates the scaling of other values from a reading.
    pub fn learn_from(&mut self, reading: &Reading) {
        if reading.pnu == pnu::OPERATING_MODE {
            self.operating_mode = reading.raw();
        }
        let word = || reading.raw().and_then(|raw| u16::try_from(raw).ok());
        if reading.pnu == pnu::TELEGRAM {
            self.selected = word().and_then(|number| self.telegram(number));
        }
        if let (pnu::SETPOINT_SIGNALS, Some(number)) = (reading.pnu, word()) {
            let index = reading.index.unwrap_or(0);
            self.mapped.retain(|(word, _)| *word != index);
            if self.mapped.len() < MOST_WORDS {
                self.mapped.push((index, number));
            }
        }
        let mut chooser = self
            .tables()
            .into_iter()
            .flat_map(|tables| tables.parts_of(Part::ControlProfile));
        if chooser.any(|parameter| parameter.pnu == reading.pnu) {
            let raw = reading.raw();
            self.chosen = raw.filter(|&value| self.model.words.by(value).is_some());
        }
        let number = reading.number().filter(|number| *number > 0.0);
        let scale = number.and_then(|number| {
            let at = (reading.pnu, reading.index);
            take_scale(self.tables()?, &mut self.parameters.scaling, at, number)
        });
        if let Some(scale) = scale.filter(|scale| !self.known.contains(scale)) {
            self.known.push(scale);
        }
    }
}
