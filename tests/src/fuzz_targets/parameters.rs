//! Parameters: what people type, and requests, answers and descriptions of the parameter channel.

use profile::notation::setting::{Entry, Form};
use profile::notation::{ParameterReference, Quantity};
use profile::parameter::{
    Answer, Attributes, Description, Dialect, ErrorNumber, Format, Keep, ParameterAccess, ParameterAddress,
    Request, RequestId, Response, ResponseError, serve,
};

/// Parameters and values as people type them: what is printed is read back as the same.
pub fn notation(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    if let Ok(reference) = text.parse::<ParameterReference>() {
        let printed = reference.to_string();
        assert_eq!(
            printed.parse::<ParameterReference>().as_ref(),
            Ok(&reference),
            "{text:?} as {printed:?}"
        );
    }
    if let Ok(quantity) = text.parse::<Quantity>() {
        let _ = quantity.in_unit("rpm");
        let _ = quantity.number.as_f64();
    }
}

/// A file of settings: what is read comes back when it is written again.
pub fn setting(data: &[u8]) {
    for sealed in [false, true] {
        let form = Form {
            kind: "note",
            oldest: 1,
            version: 2,
            sealed,
            comment_column: 20,
            comment_gap: 2,
        };
        let settings = match form.read(data) {
            Ok(settings) => settings,
            Err(problem) => {
                let lines = String::from_utf8_lossy(data).lines().count().max(1);
                assert!((1..=lines).contains(&problem.line), "{problem} of {lines} lines");
                continue;
            }
        };
        let mut text = form.begin(settings.version);
        for line in &settings.lines {
            match &line.entry {
                Entry::Head { key, value } => text.head(key, value, &line.comment),
                Entry::Setting { name, value } => text.setting(name, value, &line.comment),
                Entry::Words(words) => text.words(words),
            }
        }
        let text = text.finish();
        let again = form
            .read(text.as_bytes())
            .unwrap_or_else(|problem| panic!("{problem}: {text:?}"));
        assert_eq!(again.version, settings.version);
        assert!(
            again
                .lines
                .iter()
                .map(|line| &line.entry)
                .eq(settings.lines.iter().map(|line| &line.entry))
        );
    }
}

const DIALECTS: [Dialect; 4] = [Dialect::STANDARD, Dialect::AKD, Dialect::VLT, Dialect::VACON];

/// A request block as a drive gets it: the answer is one that a client accepts for that request.
pub fn parameter_request(data: &[u8]) {
    let mut out = [0; 1024];
    for dialect in &DIALECTS {
        let Ok(length) = serve(data, dialect, &mut SomeDrive, &mut out) else {
            continue;
        };
        assert!(length <= dialect.max_block);
        assert_eq!(out[0], data[0], "the reference is mirrored");
        let Ok(request) = Request::parse(data, dialect.code_space) else {
            continue;
        };
        // a client always addresses the axis of its drive's dialect, and what that drive can
        if request.axis() != dialect.axis || !dialect.knows(request.id()) {
            continue;
        }
        let addresses: Vec<ParameterAddress> = request.addresses().collect();
        let parsed = Response::parse(
            &out[..length],
            request.id(),
            request.reference(),
            &addresses,
            dialect,
        );
        match (request.id(), parsed) {
            (RequestId::Other(_), _) | (_, Err(ResponseError::Refused(_))) => {}
            (id, Ok(response)) => {
                assert_eq!(response.answers().count(), addresses.len());
                let failed = response
                    .answers()
                    .any(|answer| matches!(answer, Answer::Error(_)));
                assert_eq!(failed, response.is_negative(), "{id:?}");
            }
            (id, Err(error)) => {
                panic!(
                    "{}: we do not accept our own answer to {id:?}: {error}: {data:02x?}",
                    dialect.name
                )
            }
        }
    }
}

/// A response block as a client gets it: length of the request in one octet, the request, the response.
pub fn parameter_response(data: &[u8]) {
    let Some((length, rest)) = data.split_first() else {
        return;
    };
    let Some((request, response)) = rest.split_at_checked(usize::from(*length)) else {
        return;
    };
    for dialect in &DIALECTS {
        let Ok(request) = Request::parse(request, dialect.code_space) else {
            continue;
        };
        for value in request.values() {
            if value.is_err() {
                break;
            }
        }
        let addresses: Vec<ParameterAddress> = request.addresses().collect();
        let Ok(response) = Response::parse(response, request.id(), request.reference(), &addresses, dialect)
        else {
            continue;
        };
        assert_eq!(response.answers().count(), addresses.len());
        for answer in response.answers() {
            if let Answer::Values(block) = answer {
                for index in 0..300 {
                    let _ = (
                        block.raw(index),
                        block.signed(index),
                        block.value(index, dialect.code_space),
                    );
                }
            }
        }
    }
}

/// Parameter descriptions.
pub fn description(data: &[u8]) {
    let Some(description) = Description::decode(data) else {
        return;
    };
    let again = description.encode();
    let twice = Description::decode(&again).unwrap();
    assert_eq!(twice.encode(), again);
    let _: String = description.name().collect();
}

/// Some of everything, by PNU modulo 9: 0 simple word, 1 array of 8 double words, 2 octet string of 20, 3 read-only byte, 4
/// double word that is never accepted, 5 not there, 6 array of 3 strings, 7 signed octet, 8 words that one number collects.
struct SomeDrive;

impl ParameterAccess for SomeDrive {
    fn attributes(&self, pnu: u16, subindex: u16) -> Option<Attributes> {
        Some(match pnu % 9 {
            0 => Attributes::simple(Format::UNSIGNED16, 2, true),
            1 => Attributes {
                elements: 8,
                ..Attributes::simple(Format::UNSIGNED32, 4, true)
            },
            2 => Attributes {
                format: Format::OCTET_STRING,
                ..Attributes::string(20, true)
            },
            3 => Attributes::simple(Format::UNSIGNED8, 1, false),
            4 => Attributes::simple(Format::INTEGER32, 4, true),
            6 => Attributes::strings(3, 15, true),
            7 => Attributes::simple(Format::INTEGER8, 1, true),
            8 if !subindex.is_multiple_of(8) => Attributes {
                first: subindex - subindex % 8 + 1,
                elements: 7,
                ..Attributes::simple(Format::N2, 2, true)
            },
            _ => return None,
        })
    }

    fn exists(&self, pnu: u16) -> bool {
        pnu % 9 != 5
    }

    fn read(&mut self, pnu: u16, subindex: u16) -> Result<u64, ErrorNumber> {
        let facts = self.attributes(pnu, subindex).unwrap();
        assert!(
            subindex - facts.first < facts.elements.max(1),
            "PNU {pnu}.{subindex}"
        );
        Ok(u64::from(pnu) ^ u64::from(subindex))
    }

    fn write(&mut self, pnu: u16, subindex: u16, raw: u64, _: Keep) -> Result<(), ErrorNumber> {
        let facts = self.attributes(pnu, subindex).unwrap();
        assert!(
            facts.writable && subindex - facts.first < facts.elements.max(1),
            "PNU {pnu}.{subindex}"
        );
        assert!(raw >> (8 * facts.octets) == 0);
        if pnu % 9 == 4 { Err(ErrorNumber(2)) } else { Ok(()) }
    }

    fn description(&self, pnu: u16) -> Option<Description> {
        (pnu % 12 < 6).then(|| Description::decode(&[0x41; 46]).unwrap())
    }

    fn text(&self, pnu: u16, index: u16) -> Option<[u8; 16]> {
        (pnu % 12 < 6 && index < 4).then_some([0x41; 16])
    }
}
