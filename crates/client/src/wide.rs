//! 64-bit values, which have two numbers: their own is the low half, the next one the high half.
//!
//! That the manual of the AKD leaves a number free behind such a parameter is known, what is behind it is our reading. A
//! drive that does not have the second number is read and written with the low half alone.

use profile::catalogue::Parameter;
use profile::parameter::ParameterAddress;

use crate::Refusal;
use profile::value::{Content, Interpretation, Parameters, Reading, Selection};

/// Returns the number of the high half, when the selection is a 64-bit value.
fn high(selection: &Selection) -> Option<u16> {
    selection.parameter.and_then(Parameter::high)
}

/// Returns the selections with the high half behind each 64-bit value.
pub(crate) fn split(selections: &[Selection]) -> Vec<Selection> {
    let mut all = Vec::with_capacity(selections.len());
    for selection in selections {
        all.push(*selection);
        all.extend(high(selection).map(|pnu| Selection::number(pnu, selection.notation)));
    }
    all
}

/// One reading for each value again.
pub(crate) fn join(
    parameters: &Parameters,
    selections: &[Selection],
    readings: Vec<Result<Reading, Refusal>>,
) -> Vec<Result<Reading, Refusal>> {
    let mut joined = Vec::with_capacity(readings.len());
    let mut readings = readings.into_iter().peekable();
    let pnu = |answer: &Result<Reading, Refusal>| match answer {
        Ok(reading) => reading.pnu,
        Err(refusal) => refusal.shown.pnu,
    };
    for selection in selections {
        if high(selection).is_none() {
            // as many as came: a refused array is one answer
            while let Some(answer) = readings.next_if(|answer| pnu(answer) == selection.pnu) {
                joined.push(answer);
            }
            continue;
        }
        let (Some(low), upper) = (readings.next(), readings.next()) else {
            break;
        };
        joined.push(match (low, upper) {
            (Ok(low), Some(Ok(upper))) => Ok(whole(parameters, selection, low, &upper)),
            (low, _) => low,
        });
    }
    joined
}

fn whole(parameters: &Parameters, selection: &Selection, low: Reading, upper: &Reading) -> Reading {
    let number = |reading: &Reading| matches!(reading.content, Content::Number { .. });
    if low.octets.len() != 4 || upper.octets.len() != 4 || !number(&low) || !number(upper) {
        return low;
    }
    let octets = [upper.octets.as_slice(), &low.octets].concat();
    parameters.reading(selection, 0, low.format, Interpretation::Plain, &octets)
}

/// Returns the destination of the octets of a new value: the parameter, or both numbers, the high half first, when a
/// 64-bit value does not fit the low half.
pub(crate) fn halves(selection: &Selection, octets: Vec<u8>) -> Vec<(ParameterAddress, Vec<u8>)> {
    let own = ParameterAddress::value(selection.pnu, selection.first);
    let signed = selection.parameter.is_some_and(|parameter| parameter.signed);
    let (Some(pnu), Some((upper, low))) = (high(selection), octets.split_at_checked(4)) else {
        return vec![(own, octets)];
    };
    let sign = signed && low.first().is_some_and(|first| first & 0x80 != 0);
    let implied = [if sign { 0xFF } else { 0 }; 4];
    if upper == implied {
        return vec![(own, low.to_vec())];
    }
    vec![
        (ParameterAddress::value(pnu, 0), upper.to_vec()),
        (own, low.to_vec()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use profile::catalogue::{AKD, Scaling};
    use profile::parameter::ErrorNumber;

    const DRIVE: Parameters = Parameters {
        catalogue: Some(&AKD),
        scaling: Scaling::DELIVERED,
    };

    fn select(text: &str) -> Selection {
        DRIVE.select(&text.parse().unwrap()).unwrap()
    }

    fn read(selection: &Selection, octets: &[u8]) -> Result<Reading, Refusal> {
        Ok(DRIVE.reading(selection, 0, 0x43, Interpretation::Plain, octets))
    }

    fn refused(selection: &Selection) -> Result<Reading, Refusal> {
        Err(Refusal {
            shown: selection.shown(0),
            name: None,
            write: false,
            number: ErrorNumber::UNKNOWN_PARAMETER,
            names: profile::parameter::ErrorNames::Profile,
            information: None,
            advice: None,
            channel: None,
        })
    }

    #[test]
    fn both_halves_are_requested_and_joined() {
        let selections = [select("930"), select("SWLS.LIMIT1"), select("964[0..1]")];
        let all = split(&selections);
        let numbers: Vec<u16> = all.iter().map(|selection| selection.pnu).collect();
        assert_eq!(numbers, [930, 2385, 2386, 964]);
        let readings = vec![
            read(&all[0], &[0, 2]),
            read(&all[1], &[0, 0, 0, 7]),
            read(&all[2], &[0xFF, 0xFF, 0xFF, 0xFE]),
            read(&all[3], &[1, 5]),
            read(&all[3], &[0, 1]),
        ];
        let joined = join(&DRIVE, &selections, readings);
        let raw: Vec<i64> = joined
            .iter()
            .map(|reading| reading.as_ref().unwrap().raw().unwrap())
            .collect();
        assert_eq!(raw, [2, -(2 << 32) + 7, 0x0105, 1]);
        assert_eq!(joined[1].as_ref().unwrap().name, Some("SWLS.LIMIT1"));
    }

    #[test]
    fn a_drive_without_the_second_number_gives_the_low_half() {
        let selection = select("SWLS.LIMIT1");
        let low = read(&selection, &[0xFF, 0xFF, 0xFF, 0xFE]);
        let joined = join(&DRIVE, &[selection], vec![low, refused(&selection)]);
        assert_eq!(joined[0].as_ref().unwrap().raw(), Some(-2));
        let joined = join(
            &DRIVE,
            &[selection],
            vec![refused(&selection), refused(&selection)],
        );
        assert!(joined.len() == 1 && joined[0].is_err());
    }

    #[test]
    fn a_new_value_takes_two_numbers_only_when_it_must() {
        let pieces = |text: &str, value: i64| -> Vec<(u16, Vec<u8>)> {
            halves(&select(text), value.to_be_bytes().to_vec())
                .into_iter()
                .map(|(address, octets)| (address.pnu, octets))
                .collect()
        };
        assert_eq!(pieces("SWLS.LIMIT1", -2), [(2385, vec![255, 255, 255, 254])]);
        assert_eq!(pieces("CS.DEC", 0xFFFF_FFFE), [(2053, vec![255, 255, 255, 254])]);
        assert_eq!(
            pieces("SWLS.LIMIT1", 0xFFFF_FFFE),
            [(2386, vec![0, 0, 0, 0]), (2385, vec![255, 255, 255, 254])]
        );
        assert_eq!(
            pieces("CS.DEC", 1 << 33),
            [(2054, vec![0, 0, 0, 2]), (2053, vec![0, 0, 0, 0])]
        );
        let plain = halves(&select("930"), vec![0, 2]);
        assert_eq!((plain.len(), plain[0].0.pnu), (1, 930));
    }

    /// A refused array is one answer for all its elements: what follows must not slip.
    #[test]
    fn a_refused_array_moves_nothing() {
        let (array, wide) = (select("947"), select("DRV.ACC"));
        let upper = Selection {
            pnu: 2109,
            parameter: None,
            ..wide
        };
        let answers = vec![
            refused(&array),
            read(&wide, &[0, 0, 0, 5]),
            read(&upper, &[0, 0, 0, 1]),
        ];
        let joined = join(&DRIVE, &[array, wide], answers);
        assert_eq!(joined.len(), 2);
        assert_eq!(joined[1].as_ref().unwrap().raw(), Some(0x1_0000_0005));
    }
}
