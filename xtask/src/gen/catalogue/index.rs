//! Where a number or a name is in the table of parameters.

use std::fmt::Write as _;

use super::parameters::Number;
use crate::Outcome;

/// Returns the position of each PNU in the table plus one (0: none, and none for elements of a collecting PNU), and the
/// positions in the order of the names.
///
/// Of two parameters with one name, the one of the vendor's own range (`own_from` and above) comes first.
pub fn render(numbers: &[Number], own_from: u16) -> Outcome<String> {
    let highest = numbers.last().map_or(0, |last| usize::from(last.pnu));
    let mut index = vec![0_usize; highest + 1];
    for (position, number) in numbers
        .iter()
        .enumerate()
        .filter(|(_, number)| number.base.is_none())
    {
        index[usize::from(number.pnu)] = position + 1;
    }
    let mut names: Vec<usize> = (0..numbers.len()).collect();
    names.sort_by_key(|position| {
        let Number { pnu, base, name } = &numbers[*position];
        (name.to_ascii_uppercase(), *pnu < own_from, *pnu, *base)
    });
    let mut text = String::new();
    for (label, values) in [("INDEX", index), ("NAMES", names)] {
        writeln!(text, "\n#[rustfmt::skip]\npub static {label}: &[u16] = &[")?;
        for line in values.chunks(24) {
            let line: Vec<String> = line.iter().map(usize::to_string).collect();
            writeln!(text, "    {},", line.join(", "))?;
        }
        text.push_str("];\n");
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_index_prefers_the_drives_own_range_for_a_double_name() {
        let number = |pnu, base, name: &str| Number {
            pnu,
            base,
            name: name.into(),
        };
        let text = render(
            &[
                number(1, None, "B"),
                number(3, None, "a"),
                number(2000, None, "B"),
            ],
            2000,
        )
        .unwrap();
        assert!(text.contains("0, 1, 0, 2"), "{text}");
        assert!(text.contains("NAMES: &[u16] = &[\n    1, 2, 0,\n"), "{text}");
        let text = render(
            &[
                number(1, None, "B"),
                number(3, Some(1), "a"),
                number(3, Some(7), "B"),
            ],
            0,
        )
        .unwrap();
        assert!(text.contains("INDEX: &[u16] = &[\n    0, 1, 0, 0,\n"), "{text}");
        assert!(text.contains("NAMES: &[u16] = &[\n    1, 0, 2,\n"), "{text}");
    }
}
