//! A read-only SNMP agent of version 1 and 2c.
//!
//! Source: RFC 1157, RFC 3416 clause 4.2. The values come from a [`Mib`]. Nothing can be set, so the community, which
//! is readable on the wire, protects nothing important.

use alloc::vec::Vec;

use crate::wire::Reader;
use crate::wire::snmp::{Binding, ErrorStatus, Message, Oid, PduKind, Value, Version};

/// Longest answer: what an Ethernet frame holds. IPv4 fragments are not sent.
pub const MAX_ANSWER: usize = 1472;

/// Variables by their object identifiers.
pub trait Mib {
    /// Value of a variable; else [`Value::NoSuchObject`] or [`Value::NoSuchInstance`].
    fn get(&self, name: &Oid) -> Value;

    /// Returns the first variable behind `name`.
    fn next(&self, name: &Oid) -> Option<(Oid, Value)>;
}

/// Answers a request. `None` for what gets no answer: another community, another version, no request, malformed.
///
/// ```
/// use profidrive_profinet::snmp::{Mib, answer};
/// use profidrive_profinet::wire::Reader;
/// use profidrive_profinet::wire::snmp::{Binding, Message, Oid, PduKind, Value, Version};
/// struct OneName;
/// impl Mib for OneName {
///     fn get(&self, name: &Oid) -> Value {
///         if name.0 == [1, 3, 0] { Value::Octets(b"akd-1".to_vec()) } else { Value::NoSuchObject }
///     }
///     fn next(&self, name: &Oid) -> Option<(Oid, Value)> {
///         let only = Oid::from([1, 3, 0]);
///         (*name < only).then(|| (only.clone(), self.get(&only)))
///     }
/// }
/// let ask = Message {
///     version: Version::V2c, community: b"public".to_vec(), kind: PduKind::GET_NEXT, request: 1, first: 0, second: 0,
///     bindings: vec![Binding { name: Oid::from([1, 3]), value: Value::Null }],
/// };
/// let mut octets = Vec::new();
/// ask.encode(&mut octets);
/// let answer = Message::decode(Reader::new(&answer(&OneName, b"public", &octets).unwrap())).unwrap();
/// assert_eq!(answer.bindings[0].value, Value::Octets(b"akd-1".to_vec()));
/// ```
#[must_use]
pub fn answer(mib: &impl Mib, community: &[u8], request: &[u8]) -> Option<Vec<u8>> {
    let asked = Message::decode(Reader::new(request)).ok()?;
    if asked.community != community {
        return None;
    }
    let mut reply = Message {
        kind: PduKind::RESPONSE,
        first: 0,
        second: 0,
        bindings: Vec::new(),
        ..asked
    };
    let (first, second) = (asked.first, asked.second);
    let outcome = match (asked.kind, asked.version) {
        (PduKind::GET, version) => one_by_one(&asked.bindings, |name| got(mib, version, name)),
        (PduKind::GET_NEXT, version) => one_by_one(&asked.bindings, |name| following(mib, version, name)),
        (PduKind::GET_BULK, Version::V2c) => Ok(bulk(mib, &reply, &asked.bindings, first, second)),
        (PduKind::SET, Version::V1) => Err((ErrorStatus::NO_SUCH_NAME, 1)),
        (PduKind::SET, _) => Err((ErrorStatus::NO_ACCESS, 1)),
        _ => return None,
    };
    match outcome {
        Ok(bindings) => reply.bindings = bindings,
        Err((status, index)) => {
            // an empty list has no first variable to complain about
            reply.second = i32::try_from(asked.bindings.len().min(index)).unwrap_or(0);
            reply.first = status.0;
            reply.bindings.clone_from(&asked.bindings);
        }
    }
    let mut out = Vec::new();
    reply.encode(&mut out);
    if out.len() > MAX_ANSWER {
        reply.first = ErrorStatus::TOO_BIG.0;
        reply.second = 0;
        reply.bindings = match reply.version {
            Version::V1 => asked.bindings,
            _ => Vec::new(),
        };
        out.clear();
        reply.encode(&mut out);
    }
    (out.len() <= MAX_ANSWER).then_some(out)
}

type Outcome = Result<Vec<Binding>, (ErrorStatus, usize)>;

fn one_by_one(asked: &[Binding], answer: impl Fn(&Oid) -> Option<Binding>) -> Outcome {
    let mut bindings = Vec::with_capacity(asked.len());
    for (at, binding) in asked.iter().enumerate() {
        bindings.push(answer(&binding.name).ok_or((ErrorStatus::NO_SUCH_NAME, at + 1))?);
    }
    Ok(bindings)
}

/// Version 1 has no word for what is not there, and none for counters of 64 bits.
const fn exists_in_v1(value: &Value) -> bool {
    !matches!(
        value,
        Value::NoSuchObject | Value::NoSuchInstance | Value::EndOfMib | Value::Counter64(_)
    )
}

fn got(mib: &impl Mib, version: Version, name: &Oid) -> Option<Binding> {
    let value = mib.get(name);
    (version != Version::V1 || exists_in_v1(&value)).then(|| Binding {
        name: name.clone(),
        value,
    })
}

fn following(mib: &impl Mib, version: Version, name: &Oid) -> Option<Binding> {
    let mut at = name.clone();
    loop {
        match mib.next(&at) {
            Some((found, value)) if version != Version::V1 || exists_in_v1(&value) => {
                return Some(Binding { name: found, value });
            }
            // order is strict, so this ends
            Some((found, _)) if found > at => at = found,
            _ if version == Version::V1 => return None,
            _ => {
                return Some(Binding {
                    name: name.clone(),
                    value: Value::EndOfMib,
                });
            }
        }
    }
}

/// As many variables as requested and as fit into one answer.
fn bulk(
    mib: &impl Mib,
    reply: &Message,
    asked: &[Binding],
    non_repeaters: i32,
    repetitions: i32,
) -> Vec<Binding> {
    let mut out = Vec::new();
    reply.encode(&mut out);
    let mut room = MAX_ANSWER.saturating_sub(out.len());
    let mut bindings = Vec::new();
    let mut take = |name: &Oid| -> Option<Binding> {
        let binding = following(mib, Version::V2c, name)?;
        out.clear();
        binding.encode(&mut out);
        room = room.checked_sub(out.len())?;
        Some(binding)
    };
    let once = usize::try_from(non_repeaters).unwrap_or(0).min(asked.len());
    let (single, repeated) = asked.split_at(once);
    for binding in single {
        match take(&binding.name) {
            Some(found) => bindings.push(found),
            None => return bindings,
        }
    }
    let mut names: Vec<Oid> = repeated.iter().map(|binding| binding.name.clone()).collect();
    for _ in 0..repetitions.max(0) {
        let mut ended = true;
        for name in &mut names {
            let Some(found) = take(name) else {
                return bindings;
            };
            ended &= found.value == Value::EndOfMib;
            name.clone_from(&found.name);
            bindings.push(found);
        }
        if ended {
            break;
        }
    }
    bindings
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use proptest::prelude::*;

    /// 1.3.1.0 to 1.3.n.0 are numbers, every seventh one of 64 bits; the tenth is a long text.
    struct Numbers(u32);

    impl Numbers {
        fn value(&self, n: u32) -> Value {
            match n {
                0 => Value::NoSuchObject,
                n if n > self.0 => Value::NoSuchObject,
                10 => Value::Octets(vec![b'x'; 400]),
                n if n % 7 == 0 => Value::Counter64(n.into()),
                n => Value::Integer(n as i32),
            }
        }
    }

    impl Mib for Numbers {
        fn get(&self, name: &Oid) -> Value {
            match name.0[..] {
                [1, 3, n, 0] => self.value(n),
                [1, 3, n, ..] if (1..=self.0).contains(&n) => Value::NoSuchInstance,
                _ => Value::NoSuchObject,
            }
        }

        fn next(&self, name: &Oid) -> Option<(Oid, Value)> {
            (1..=self.0)
                .map(|n| Oid::from([1, 3, n, 0]))
                .find(|found| found > name)
                .map(|found| (found.clone(), self.get(&found)))
        }
    }

    fn ask(
        version: Version,
        kind: PduKind,
        (first, second): (i32, i32),
        names: &[&[u32]],
    ) -> Option<Message> {
        let bindings = names
            .iter()
            .map(|name| Binding {
                name: Oid(name.to_vec()),
                value: Value::Null,
            })
            .collect();
        let asked = Message {
            version,
            community: b"public".to_vec(),
            kind,
            request: 77,
            first,
            second,
            bindings,
        };
        let mut octets = vec![];
        asked.encode(&mut octets);
        let octets = answer(&Numbers(40), b"public", &octets)?;
        assert!(octets.len() <= MAX_ANSWER);
        let reply = Message::decode(Reader::new(&octets)).unwrap();
        assert_eq!((reply.kind, reply.request), (PduKind::RESPONSE, 77));
        Some(reply)
    }

    fn values(reply: &Message) -> Vec<Value> {
        reply
            .bindings
            .iter()
            .map(|binding| binding.value.clone())
            .collect()
    }

    #[test]
    fn get_in_both_versions() {
        let names: [&[u32]; 3] = [&[1, 3, 1, 0], &[1, 3, 7, 0], &[1, 3, 2, 1]];
        let reply = ask(Version::V2c, PduKind::GET, (0, 0), &names).unwrap();
        assert_eq!(
            values(&reply),
            [Value::Integer(1), Value::Counter64(7), Value::NoSuchInstance]
        );
        assert_eq!((reply.first, reply.second), (0, 0));
        let reply = ask(Version::V1, PduKind::GET, (0, 0), &names).unwrap();
        assert_eq!((reply.first, reply.second), (2, 2));
        assert_eq!(values(&reply), [Value::Null, Value::Null, Value::Null]);
    }

    #[test]
    fn next_passes_over_what_version_1_does_not_know() {
        let name: [&[u32]; 1] = [&[1, 3, 6, 0]];
        let reply = ask(Version::V2c, PduKind::GET_NEXT, (0, 0), &name).unwrap();
        assert_eq!(values(&reply), [Value::Counter64(7)]);
        let reply = ask(Version::V1, PduKind::GET_NEXT, (0, 0), &name).unwrap();
        assert_eq!(values(&reply), [Value::Integer(8)]);
        let end: [&[u32]; 1] = [&[1, 3, 40, 0]];
        let reply = ask(Version::V2c, PduKind::GET_NEXT, (0, 0), &end).unwrap();
        assert_eq!(values(&reply), [Value::EndOfMib]);
        let reply = ask(Version::V1, PduKind::GET_NEXT, (0, 0), &end).unwrap();
        assert_eq!((reply.first, reply.second), (2, 1));
    }

    #[test]
    fn bulk_gives_what_fits() {
        let names: [&[u32]; 2] = [&[1, 3, 1, 0], &[1, 3, 1, 0]];
        let reply = ask(Version::V2c, PduKind::GET_BULK, (1, 3), &names).unwrap();
        let two = Value::Integer(2);
        assert_eq!(
            values(&reply),
            [two.clone(), two, Value::Integer(3), Value::Integer(4)]
        );
        let reply = ask(Version::V2c, PduKind::GET_BULK, (0, i32::MAX), &[&[1, 3]]).unwrap();
        assert!(
            (30..60).contains(&reply.bindings.len()),
            "{}",
            reply.bindings.len()
        );
        let reply = ask(Version::V2c, PduKind::GET_BULK, (0, 10), &[&[1, 3, 39, 0]]).unwrap();
        assert_eq!(values(&reply), [Value::Integer(40), Value::EndOfMib]);
        let reply = ask(Version::V2c, PduKind::GET_BULK, (-5, -5), &names).unwrap();
        assert!(reply.bindings.is_empty());
        assert_eq!(ask(Version::V1, PduKind::GET_BULK, (0, 10), &names), None);
    }

    #[test]
    fn a_response_too_big_is_an_error() {
        let long: Vec<&[u32]> = vec![&[1, 3, 10, 0]; 4];
        let reply = ask(Version::V2c, PduKind::GET, (0, 0), &long).unwrap();
        assert_eq!((reply.first, reply.bindings.len()), (1, 0));
        let reply = ask(Version::V1, PduKind::GET, (0, 0), &long).unwrap();
        assert_eq!((reply.first, reply.bindings.len()), (1, 4));
    }

    #[test]
    fn nothing_can_be_set_and_strangers_get_no_answer() {
        let name: [&[u32]; 1] = [&[1, 3, 1, 0]];
        let reply = ask(Version::V2c, PduKind::SET, (0, 0), &name).unwrap();
        assert_eq!((reply.first, reply.second), (6, 1));
        let reply = ask(Version::V1, PduKind::SET, (0, 0), &name).unwrap();
        assert_eq!((reply.first, reply.second), (2, 1));
        assert_eq!(ask(Version::V2c, PduKind::RESPONSE, (0, 0), &name), None);
        let reply = ask(Version::V2c, PduKind::SET, (0, 0), &[]).unwrap();
        assert_eq!((reply.first, reply.second), (6, 0));
        let mut octets = vec![];
        Message {
            community: b"private".to_vec(),
            ..ask(Version::V2c, PduKind::GET, (0, 0), &name).unwrap()
        }
        .encode(&mut octets);
        assert_eq!(answer(&Numbers(3), b"public", &octets), None);
    }

    proptest! {
        #[test]
        fn a_walk_sees_everything_once(repetitions in 1i32..60, count in 1u32..60) {
            let mut at = Oid::from([1, 3]);
            let mut seen = 0;
            for _ in 0..100 {
                let asked = Message {
                    version: Version::V2c, community: vec![], kind: PduKind::GET_BULK, request: 1, first: 0,
                    second: repetitions, bindings: vec![Binding { name: at.clone(), value: Value::Null }],
                };
                let mut octets = vec![];
                asked.encode(&mut octets);
                let octets = answer(&Numbers(count), b"", &octets).unwrap();
                let reply = Message::decode(Reader::new(&octets)).unwrap();
                for binding in reply.bindings {
                    if binding.value == Value::EndOfMib {
                        prop_assert_eq!(seen, count);
                        return Ok(());
                    }
                    seen += 1;
                    prop_assert_eq!(&binding.name, &Oid::from([1, 3, seen, 0]));
                    at = binding.name;
                }
            }
            prop_assert!(false, "no end");
        }
    }
}
