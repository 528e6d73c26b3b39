//! Reads from a drive without tables which requests it accepts and what its parameters are.

use profile::notation::Notation;
use profile::parameter::{
    Answer, Attribute, CodeSpace, Description, Dialect, ErrorNumber, Identifier, ParameterAddress, RequestId,
    Response, encode_read, plan_reads, pnu,
};
use profinet::controller::ServiceError;

use super::Session;
use super::backup::LISTS;
use crate::learn::{self, KindOfDrive, Row};
use crate::{Drive, Error};
use profile::model::Model;
use profile::value::{Parameters, Reading, Selection};

/// Control and status word.
const WORDS: [u16; 2] = [967, 968];
/// Elements that identify a kind of drive: vendor, type, version, date.
const OF_KIND: u16 = 5;
/// The one that is the type of the drive unit.
const TYPE: u16 = 1;
/// Records of the parameter channel.
const RECORDS: [u16; 2] = [0xB02E, 0xB02F];
/// Parameters described between two looks at the progress.
const PART: usize = 32;
/// Texts of one selection that are requested at once, and at most.
const TEXTS: u16 = 13;
const MOST_TEXTS: u16 = 65;
/// Largest request.
const MAX_REQUEST: usize = 1024;
/// Danfoss for a wrong axis.
const OTHER_AXIS: ErrorNumber = ErrorNumber::DANFOSS_WRONG_AXIS;

impl Session {
    /// Learns the parameters of a drive without a built-in catalogue. First its dialect and its vendor are determined:
    /// for a known vendor PNU 964 has the drive unit, independent of the device id. For an unknown vendor its
    /// parameters are read with names, units, limits and texts, once per kind of drive and run of the program. A drive
    /// without descriptions stays as it was: numbers and raw values work. Does nothing for a known model. `progress`
    /// receives the number of described parameters and their total.
    ///
    /// # Errors
    /// When the drive cannot be reached, the caller requests a stop, or [too many kinds](Error::TooManyKinds) are known.
    pub async fn recognise(
        &mut self,
        drive: &mut Drive,
        progress: &mut (dyn FnMut(usize, usize) + Send),
    ) -> Result<(), Error> {
        if drive.model.catalogue.is_some() || drive.is_on_line() {
            return Ok(());
        }
        let Some(kind) = self.kind(drive).await? else {
            return Ok(());
        };
        let unit_type = kind.unit_type.and_then(|raw| u16::try_from(raw).ok());
        if let Some(model) = unit_type.and_then(|one| Model::of_unit(kind.vendor_id, one)) {
            drive.model = model;
            drive.parameters = Parameters::of(&model);
            return Ok(());
        }
        if let Some((tables, dialect)) = learn::known(&kind) {
            adopt(drive, tables, dialect);
            return Ok(());
        }
        let mut numbers = self.numbers(drive).await?;
        // a list may leave itself out
        numbers.extend(LISTS);
        numbers.sort_unstable();
        numbers.dedup();
        numbers.truncate(learn::MOST_PARAMETERS);
        let mut described: Vec<(u16, Description)> = Vec::new();
        for (at, part) in numbers.chunks(PART).enumerate() {
            progress(at * PART, numbers.len());
            let answers = self.descriptions(drive, part).await?;
            let pairs = part.iter().zip(answers);
            described.extend(pairs.filter_map(|(pnu, answer)| answer.map(|answer| (*pnu, answer))));
        }
        if described.is_empty() {
            return Ok(());
        }
        let own = drive.model.dialect;
        let generic = *own == Dialect::STANDARD || learn::DIALECTS.contains(own);
        let space = if generic {
            learn::space_of(&described)
        } else {
            own.code_space
        };
        let dialect = if generic { learn::in_space(own, space) } else { own };
        let mut rows = Vec::new();
        for (pnu, description) in described {
            let texts = if description.identifier.has(Identifier::TEXT) {
                self.texts(drive, pnu).await?
            } else {
                Vec::new()
            };
            rows.push(Row {
                pnu,
                description,
                texts,
            });
        }
        progress(numbers.len(), numbers.len());
        let tables = learn::keep(&kind, dialect, &drive.station, rows)
            .ok_or_else(|| Error::TooManyKinds { drive: drive.label() })?;
        adopt(drive, tables, dialect);
        Ok(())
    }

    /// Finds out which requests a drive without tables accepts: its axis and the record of its parameter
    /// channel. Nothing happens for a known model.
    ///
    /// # Errors
    /// When the drive cannot be reached, or the caller requests a stop.
    pub async fn find_channel(&mut self, drive: &mut Drive) -> Result<(), Error> {
        if drive.model.catalogue.is_some() || drive.is_on_line() {
            return Ok(());
        }
        self.kind(drive).await?;
        // words of bits have a format of their own: it shows which of the two numberings the drive has
        let words = self.read_numbers(drive, &WORDS).await?;
        if words
            .iter()
            .any(|reading| learn::DECIMAL.contains(&reading.format))
        {
            drive.model.dialect = learn::in_space(drive.model.dialect, CodeSpace::V3);
        }
        Ok(())
    }

    /// Finds out which requests a drive accepts, and its kind; `None` when it answers nothing.
    async fn kind(&mut self, drive: &mut Drive) -> Result<Option<KindOfDrive>, Error> {
        let own = drive.model;
        let mut ways = vec![(own.dialect, own.channel.index)];
        if *own.dialect == Dialect::STANDARD {
            ways.clear();
            for index in RECORDS {
                ways.extend(learn::DIALECTS.iter().take(2).map(|dialect| (dialect, index)));
            }
        }
        for (dialect, index) in ways {
            drive.model.dialect = dialect;
            drive.model.channel.index = index;
            // one by one: a drive with fewer reports those that it has
            let elements = (0..OF_KIND).map(|element| Selection {
                first: element,
                indexed: true,
                ..Selection::number(pnu::IDENTIFICATION, Notation::Name)
            });
            let elements: Vec<Selection> = elements.collect();
            let answers = match self.read_strictly(drive, &elements).await {
                Ok(answers) => answers,
                // nothing came at all: asked in another way it would not answer either
                Err(error) if is_silence(&error) && self.gives_up(&error) => break,
                Err(Error::Record { .. } | Error::Malformed { .. }) => continue,
                Err(error) => return Err(error),
            };
            let other = |number: ErrorNumber| number == ErrorNumber::NO_AXIS || number == OTHER_AXIS;
            if answers
                .iter()
                .any(|answer| answer.as_ref().is_err_and(|refusal| other(refusal.number)))
            {
                continue;
            }
            let readings: Vec<Reading> = answers.into_iter().flatten().collect();
            let unit_type = readings.iter().find(|reading| reading.index == Some(TYPE));
            return Ok(Some(KindOfDrive {
                vendor_id: drive.station.vendor_id,
                device_id: drive.station.device_id,
                unit_type: unit_type.and_then(Reading::raw),
                unit: readings.into_iter().flat_map(|reading| reading.octets).collect(),
            }));
        }
        drive.model = own;
        Ok(None)
    }

    /// The texts of an enumeration (attribute 0x30) from value 0 on, until there are no more.
    pub(super) async fn texts(&mut self, drive: &Drive, pnu: u16) -> Result<Vec<(i32, String)>, Error> {
        let mut texts = Vec::new();
        for first in (0..MOST_TEXTS).step_by(TEXTS.into()) {
            let values: Vec<u16> = (first..first + TEXTS).collect();
            let found = self.texts_of(drive, pnu, &values).await?;
            if found.is_empty() {
                break;
            }
            texts.extend(found);
        }
        Ok(texts)
    }

    /// Each value requested by itself: one that has no text does not disturb the others.
    async fn texts_of(
        &mut self,
        drive: &Drive,
        pnu: u16,
        values: &[u16],
    ) -> Result<Vec<(i32, String)>, Error> {
        let dialect = drive.model.dialect;
        let address = |&subindex: &u16| ParameterAddress {
            attribute: Attribute::Text,
            ..ParameterAddress::value(pnu, subindex)
        };
        let all: Vec<_> = values.iter().map(|value| (address(value), None)).collect();
        let malformed = |error: &dyn std::fmt::Display| Error::Malformed {
            drive: drive.label(),
            reason: error.to_string(),
        };
        let mut texts = Vec::new();
        for group in plan_reads(&all, dialect) {
            let part = all.get(group).unwrap_or_default();
            let addresses: Vec<ParameterAddress> = part.iter().map(|(address, _)| *address).collect();
            let mut buffer = [0; MAX_REQUEST];
            let reference = self.next_reference();
            let length = encode_read(reference, dialect, &addresses, &mut buffer)
                .map_err(|error| malformed(&error))?;
            let answered = self.job(drive, buffer.get(..length).unwrap_or_default()).await?;
            let response = Response::parse(&answered.octets, RequestId::Read, reference, &addresses, dialect)
                .map_err(|error| malformed(&error))?;
            for (address, answer) in addresses.iter().zip(response.answers()) {
                let Answer::Values(block) = answer else { continue };
                let text = String::from_utf8_lossy(block.data);
                let text: String = text
                    .trim_matches(['\0', ' '])
                    .chars()
                    .map(|c| if c.is_control() { '.' } else { c })
                    .collect();
                if !text.is_empty() {
                    texts.push((i32::from(address.subindex), text));
                }
            }
        }
        Ok(texts)
    }
}

/// The drive has no answer, instead of one that cannot be understood.
const fn is_silence(error: &Error) -> bool {
    matches!(
        error,
        Error::Timeout { .. }
            | Error::Record {
                error: ServiceError::NotReady { .. },
                ..
            }
    )
}

/// Gives a drive the tables of its kind.
fn adopt(drive: &mut Drive, tables: &'static profile::catalogue::Catalogue, dialect: &'static Dialect) {
    drive.model = Model {
        name: tables.model,
        catalogue: Some(tables),
        dialect,
        learned: true,
        ..drive.model
    };
    drive.parameters = Parameters::of(&drive.model);
}
