//! Reading parameters: many in few requests; what writing them needs too.

mod write;

use std::net::Ipv4Addr;
use std::ops::Range;

use profile::parameter::{
    Answer, Description, ErrorNumber, ParameterAddress, ParameterError, RequestId, Response, encode_read,
    plan_reads, split_array,
};

use profinet::{Endpoint, MacAddress};

use super::{Session, locked};
use crate::line::Answered;
use crate::wide::{join, split};
use crate::{ChannelCause, ChannelRefusal, Drive, Error, Refusal};
use profile::value::{Interpretation, Reading, Selection};

pub(super) use write::{NewContent, planned};

/// Octets of the largest request any dialect allows.
const MAX_REQUEST: usize = 1024;

/// One address of a read, and which selection it belongs to.
#[derive(Debug, Clone, Copy)]
struct Item {
    selection: usize,
    /// First element within the selection.
    offset: u16,
    address: ParameterAddress,
    octets: Option<usize>,
}

impl Session {
    /// Reads every element of every selection, in order, in as few requests as the drive's limits allow. A refused
    /// parameter does not disturb the others.
    ///
    /// # Errors
    /// When the drive cannot be reached, or its answer makes no sense.
    pub async fn read(
        &mut self,
        drive: &mut Drive,
        selections: &[Selection],
    ) -> Result<Vec<Result<Reading, Refusal>>, Error> {
        if selections.iter().any(needs_scaling) {
            self.read_scaling(drive).await?;
        }
        let readings = self.read_plain(drive, &split(selections)).await?;
        Ok(join(&drive.parameters, selections, readings))
    }

    /// Reads what the drive has of this; what it refuses is left out, and what it has reported not to have is not requested again
    /// for ten minutes.
    ///
    /// # Errors
    /// When the drive cannot be reached, or its answer makes no sense.
    pub async fn read_present(
        &mut self,
        drive: &mut Drive,
        selections: &[Selection],
    ) -> Result<Vec<Reading>, Error> {
        let now = self.now();
        let left = locked(&self.absent).left(drive, selections, now);
        let answers = self.look_for(drive, &left).await?;
        locked(&self.absent).note(drive, &left, &answers, now);
        Ok(answers.into_iter().flatten().collect())
    }

    /// Reads this to see what of it the drive has: a refusal is an answer; see [`has_looked_for`](Self::has_looked_for).
    pub(super) async fn look_for(
        &mut self,
        drive: &mut Drive,
        selections: &[Selection],
    ) -> Result<Vec<Result<Reading, Refusal>>, Error> {
        let pnus: Vec<u16> = split(selections).iter().map(|selection| selection.pnu).collect();
        locked(&self.looks).note(drive.station.ip.address, pnus.into_iter());
        self.read(drive, selections).await
    }

    /// Returns whether a caller of this network has read a parameter of the drive at this address to see whether the drive has
    /// it, as [`read_present`](Self::read_present) and [`backup`](Self::backup) do. Its refusal as an unknown parameter is then an
    /// answer, and nothing that went wrong.
    #[must_use]
    pub fn has_looked_for(&self, drive: Ipv4Addr, pnu: u16) -> bool {
        locked(&self.looks).has(drive, pnu)
    }

    /// Returns the Ethernet address of this program; all zeros where it has none.
    #[must_use]
    pub fn mac(&self) -> MacAddress {
        self.client().controller_ref().mac()
    }

    /// The same without looking at the values that scale others first. What is [tolerated](Self::tolerate_unread) gives
    /// no reading.
    pub(super) async fn read_plain(
        &mut self,
        drive: &Drive,
        selections: &[Selection],
    ) -> Result<Vec<Result<Reading, Refusal>>, Error> {
        if self.unread().is_some() {
            return Ok(Vec::new());
        }
        match self.read_strictly(drive, selections).await {
            Err(error) if self.gives_up(&error) => Ok(Vec::new()),
            other => other,
        }
    }

    /// The same where each error counts.
    pub(super) async fn read_strictly(
        &mut self,
        drive: &Drive,
        selections: &[Selection],
    ) -> Result<Vec<Result<Reading, Refusal>>, Error> {
        let _meanwhile = self.in_time(drive.is_on_line());
        self.read_all(drive, selections).await
    }

    async fn read_all(
        &mut self,
        drive: &Drive,
        selections: &[Selection],
    ) -> Result<Vec<Result<Reading, Refusal>>, Error> {
        let items: Vec<Item> = selections
            .iter()
            .enumerate()
            .flat_map(|(at, selection)| items(at, selection, drive))
            .collect();
        let planned: Vec<_> = items.iter().map(|item| (item.address, item.octets)).collect();
        let mut results = Vec::new();
        for group in plan_reads(&planned, drive.model.dialect) {
            self.read_group(drive, selections, &items, group, &mut results)
                .await?;
        }
        Ok(results)
    }

    async fn read_group(
        &mut self,
        drive: &Drive,
        selections: &[Selection],
        items: &[Item],
        group: Range<usize>,
        results: &mut Vec<Result<Reading, Refusal>>,
    ) -> Result<(), Error> {
        let part = items.get(group).unwrap_or_default();
        let addresses: Vec<ParameterAddress> = part.iter().map(|item| item.address).collect();
        let dialect = drive.model.dialect;
        let (reference, answered) = self.request(drive, &addresses).await?;
        let response = Response::parse(&answered.octets, RequestId::Read, reference, &addresses, dialect)
            .map_err(|error| malformed(drive, &error))?;
        for ((at, item), answer) in part.iter().enumerate().zip(response.answers()) {
            let Some(selection) = selections.get(item.selection) else {
                continue;
            };
            match answer {
                Answer::Values(block) => {
                    let interpretation = Interpretation::of(block.format, dialect.code_space);
                    if matches!(interpretation, Interpretation::Text | Interpretation::Octets) {
                        results.push(Ok(drive.parameters.reading(
                            selection,
                            item.offset,
                            block.format.0,
                            interpretation,
                            block.data,
                        )));
                        continue;
                    }
                    for element in 0..block.count {
                        let octets = block.octets(element.into()).unwrap_or_default();
                        let offset = item.offset + u16::from(element);
                        let format = block.format.0;
                        results.push(Ok(drive.parameters.reading(
                            selection,
                            offset,
                            format,
                            interpretation,
                            octets,
                        )));
                    }
                }
                // unknown sizes exceeded the length of the answer: this one again, alone
                Answer::Error(error) if error.number == ErrorNumber(0x15) && part.len() > 1 => {
                    let single = [*item];
                    Box::pin(self.read_group(drive, selections, &single, 0..1, results)).await?;
                }
                Answer::Error(error) => {
                    let channel = self.channel_refusal(answered.cause(at));
                    let refusal = refusal(drive, selection, item.offset, false, error, channel);
                    results.push(Err(refusal));
                }
                Answer::Written => {
                    let reason = "a read was answered like a write".to_owned();
                    return Err(Error::Malformed {
                        drive: drive.label(),
                        reason,
                    });
                }
            }
        }
        Ok(())
    }

    /// One request for these addresses: the reference it had, and what came back.
    async fn request(
        &mut self,
        drive: &Drive,
        addresses: &[ParameterAddress],
    ) -> Result<(u8, Answered), Error> {
        let mut buffer = [0; MAX_REQUEST];
        let reference = self.next_reference();
        let length = encode_read(reference, drive.model.dialect, addresses, &mut buffer)
            .map_err(|error| malformed(drive, &error))?;
        let answered = self.job(drive, buffer.get(..length).unwrap_or_default()).await?;
        Ok((reference, answered))
    }

    /// What happened in the parameter channel of the line.
    fn channel_refusal(&self, cause: Option<ChannelCause>) -> Option<ChannelRefusal> {
        let protocol = self.client().line_config()?.protocol;
        Some(ChannelRefusal {
            protocol,
            cause: cause?,
        })
    }

    /// Reads one value that must be there.
    ///
    /// # Errors
    /// When the drive cannot be reached or refuses.
    pub async fn read_one(&mut self, drive: &mut Drive, selection: &Selection) -> Result<Reading, Error> {
        let first = self
            .read(drive, std::slice::from_ref(selection))
            .await?
            .into_iter()
            .next();
        match first {
            Some(Ok(reading)) => Ok(reading),
            Some(Err(refusal)) => Err(Error::Refused {
                drive: drive.label(),
                refusal,
            }),
            None => Err(Error::Malformed {
                drive: drive.label(),
                reason: "no value came back".to_owned(),
            }),
        }
    }

    /// Descriptions of parameters (attribute 0x20), `None` where the drive has none.
    pub(super) async fn descriptions(
        &mut self,
        drive: &Drive,
        pnus: &[u16],
    ) -> Result<Vec<Option<Description>>, Error> {
        let planned: Vec<_> = pnus
            .iter()
            .map(|&pnu| (ParameterAddress::description(pnu), None))
            .collect();
        let dialect = drive.model.dialect;
        let mut descriptions = Vec::new();
        for group in plan_reads(&planned, dialect) {
            let part = planned.get(group).unwrap_or_default();
            let addresses: Vec<ParameterAddress> = part.iter().map(|(address, _)| *address).collect();
            let (reference, answered) = self.request(drive, &addresses).await?;
            let response = Response::parse(&answered.octets, RequestId::Read, reference, &addresses, dialect)
                .map_err(|error| malformed(drive, &error))?;
            descriptions.extend(response.answers().map(|answer| match answer {
                Answer::Values(block) => Description::decode(block.data),
                Answer::Error(_) | Answer::Written => None,
            }));
        }
        Ok(descriptions)
    }

    /// References run from 1 to 255: 0 is reserved.
    pub(super) fn next_reference(&mut self) -> u8 {
        let mut records = self.engine.records();
        records.reference = after(records.reference);
        records.reference
    }
}

pub(super) fn needs_scaling(selection: &Selection) -> bool {
    selection
        .parameter
        .is_some_and(|parameter| parameter.user_unit || !parameter.scale.is_fixed())
}

/// The addresses of one selection.
fn items(at: usize, selection: &Selection, drive: &Drive) -> Vec<Item> {
    let dialect = drive.model.dialect;
    let octets = selection.parameter.map(|parameter| match parameter.wide {
        // a number for each half
        true => parameter.size.octets(),
        false => parameter.octets(),
    });
    let string = selection.parameter.is_some_and(|parameter| parameter.length > 0);
    let parts = if string {
        // each of them alone: what a number of elements means for strings differs from drive to drive
        let elements = selection.first..selection.first.saturating_add(selection.count);
        elements
            .map(|element| ParameterAddress::value(selection.pnu, element))
            .collect()
    } else {
        let octets = octets.unwrap_or(4);
        split_array(selection.pnu, selection.first, selection.count, octets, dialect)
    };
    parts
        .into_iter()
        .map(|address| Item {
            selection: at,
            offset: address.subindex - selection.first,
            address,
            octets,
        })
        .collect()
}

fn refusal(
    drive: &Drive,
    selection: &Selection,
    offset: u16,
    write: bool,
    error: ParameterError,
    channel: Option<ChannelRefusal>,
) -> Refusal {
    let refusal = Refusal {
        shown: selection.shown(offset),
        name: selection.parameter.map(|parameter| parameter.name),
        write,
        number: error.number,
        names: drive.model.dialect.error_names,
        information: error.info,
        advice: None,
        channel,
    };
    // the number is the same in records and in the parameter channel
    let not_now = write && refusal.received() == Some(ErrorNumber::NOT_NOW.0);
    let tables = drive.model.catalogue.filter(|_| not_now);
    Refusal {
        advice: tables.and_then(|tables| tables.not_now(selection.pnu)),
        ..refusal
    }
}

fn malformed(drive: &Drive, error: &dyn std::fmt::Display) -> Error {
    Error::Malformed {
        drive: drive.label(),
        reason: error.to_string(),
    }
}

/// The next request reference.
fn after(reference: u8) -> u8 {
    reference.checked_add(1).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::after;

    #[test]
    fn references_run_from_1_to_255_and_never_are_0() {
        let mut reference = 0;
        for expected in (1..=u8::MAX).chain(1..=3) {
            reference = after(reference);
            assert_eq!(reference, expected);
        }
    }
}
