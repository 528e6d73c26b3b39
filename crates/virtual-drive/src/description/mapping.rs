//! Which telegram of a model a vendor's submodule carries.

use gsdml::{DataDescription, DataItem, Gsdml, Submodule, TextId};
use profile::catalogue::{Catalogue, TelegramModule};
use profile::telegram::{Image, Telegram};

use super::LONGEST_TELEGRAM;

/// What was found out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Found {
    /// This telegram, by name or by its data.
    Telegram(u16),
    /// The telegram is unknown, with the reason.
    Unknown(String),
    /// The name contradicts the data.
    Contradiction(String),
}

/// Returns the telegram of a submodule with cyclic data. In a file of the model's own vendor the ident number with the
/// lengths counts first. Then names count (`Standard telegram 353`), then the signals that the data items name, then the
/// lengths where only one telegram has them.
pub(super) fn telegram_of(
    gsdml: &Gsdml,
    catalogue: &Catalogue,
    names: &[&Option<TextId>],
    ids: &[&str],
    submodule: &Submodule,
) -> Found {
    let vendor = catalogue.device.vendor_id;
    let known: Vec<&'static Telegram> = catalogue
        .device
        .telegrams
        .iter()
        .filter_map(|module| Telegram::find(module.telegram, vendor))
        .collect();
    let (inputs, outputs) = submodule.lengths();
    let longest = u32::from(LONGEST_TELEGRAM);
    if inputs > longest || outputs > longest {
        return Found::Unknown(format!(
            "{outputs} octets of setpoints and {inputs} of actual values; the model's longest telegram has {longest}"
        ));
    }
    if gsdml.identity.vendor_id == vendor {
        let rows = catalogue.device.telegrams.iter();
        let lengths = |row: &&TelegramModule| (u32::from(row.inputs), u32::from(row.outputs));
        let mut same =
            rows.filter(|row| row.submodule == submodule.ident && lengths(row) == (inputs, outputs));
        if let (Some(row), None) = (same.next(), same.next()) {
            return Found::Telegram(row.telegram);
        }
    }
    let texts = names.iter().map(|name| gsdml.text(name.as_ref()));
    let named = texts.chain(ids.iter().copied()).find_map(number_in);
    if let Some(number) = named {
        let Some(telegram) = known.iter().find(|telegram| telegram.number == number) else {
            return Found::Unknown(format!("the {} has no telegram {number}", catalogue.model));
        };
        if !telegram.free && !fits(telegram, inputs, outputs) {
            return Found::Contradiction(format!(
                "telegram {number} of the {} has {} octets of setpoints and {} of actual values, the file {outputs} and {inputs}",
                catalogue.model, telegram.setpoint.octets, telegram.actual.octets
            ));
        }
        return Found::Telegram(number);
    }
    let candidates: Vec<&Telegram> = known
        .into_iter()
        .filter(|telegram| !telegram.free && fits(telegram, inputs, outputs))
        .collect();
    if candidates.is_empty() {
        return Found::Unknown(format!(
            "no telegram of the {} has {outputs} octets of setpoints and {inputs} of actual values",
            catalogue.model
        ));
    }
    // the telegram most of whose signals the items name, when it is one
    let score = |telegram: &Telegram| {
        signals_named(gsdml, submodule.io.output.as_ref(), &telegram.setpoint)
            + signals_named(gsdml, submodule.io.input.as_ref(), &telegram.actual)
    };
    let most = candidates
        .iter()
        .map(|telegram| score(telegram))
        .max()
        .unwrap_or(0);
    let best: Vec<&Telegram> = candidates
        .iter()
        .copied()
        .filter(|telegram| score(telegram) == most)
        .collect();
    if let [one] = best.as_slice() {
        return Found::Telegram(one.number);
    }
    let numbers: Vec<String> = best.iter().map(|telegram| telegram.number.to_string()).collect();
    Found::Unknown(format!(
        "its lengths are those of telegrams {}, and no name says which",
        numbers.join(", ")
    ))
}

fn fits(telegram: &Telegram, inputs: u32, outputs: u32) -> bool {
    (
        u32::from(telegram.actual.octets),
        u32::from(telegram.setpoint.octets),
    ) == (inputs, outputs)
}

/// Returns the number of signals of a telegram that the items of the file name, each at its place.
fn signals_named(gsdml: &Gsdml, data: Option<&DataDescription>, image: &Image) -> usize {
    let mut at = 0_u32;
    let mut named = 0;
    for item in data.iter().flat_map(|data| &data.items) {
        let field = image.fields.iter().find(|field| u32::from(field.offset) == at);
        if field.is_some_and(|field| words(gsdml, item).iter().any(|word| word == field.signal.name)) {
            named += 1;
        }
        at += item.octets();
    }
    named
}

/// Returns the words of an item's name, in capitals.
fn words(gsdml: &Gsdml, item: &DataItem) -> Vec<String> {
    gsdml
        .text(item.text.as_ref())
        .split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .map(str::to_uppercase)
        .collect()
}

/// Returns the number behind the word telegram: `Standard telegram 353, PZD-13/5`, `Telegramm 9`, `M_TEL_400`,
/// `STD_TGM_7`.
fn number_in(name: &str) -> Option<u16> {
    const WORDS: [&str; 6] = ["TELEGRAMM", "TELEGRAM", "TELEGR", "TLG", "TGM", "TEL"];
    let capitals = name.to_uppercase();
    let (place, word) = WORDS
        .iter()
        .find_map(|word| capitals.find(word).map(|place| (place, *word)))?;
    let behind = capitals.get(place + word.len()..)?;
    let behind = behind.trim_start_matches([' ', '_', '-', '.', ':', '#']);
    let behind = behind.strip_prefix("NO.").unwrap_or(behind);
    let behind = behind.trim_start_matches(' ');
    let end = behind.find(|c: char| !c.is_ascii_digit()).unwrap_or(behind.len());
    behind.get(..end)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_in_names() {
        for (name, number) in [
            ("Standard telegram 1, PZD-2/2", Some(1)),
            ("Standardtelegramm 353", Some(353)),
            ("M_TEL_400", Some(400)),
            ("Telegram No. 9", Some(9)),
            ("TELEGRAM-7", Some(7)),
            ("STD_TGM_7", Some(7)),
            ("Telegram 0 (24 bytes)", Some(0)),
            ("Telegram without number", None),
            ("Telegram 99999", None),
            ("PZD-2/2", None),
            ("", None),
        ] {
            assert_eq!(number_in(name), number, "{name}");
        }
    }
}
