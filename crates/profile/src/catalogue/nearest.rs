//! Names near to a misspelled one.

use alloc::vec;
use alloc::vec::Vec;

use super::Parameter;

/// Longest text that is compared; longer ones have no neighbours.
const LONGEST: usize = 64;

/// Up to `count` parameters with the nearest names, best first.
pub(super) fn nearest(parameters: &'static [Parameter], name: &str, count: usize) -> Vec<&'static Parameter> {
    if name.len() > LONGEST || name.is_empty() {
        return Vec::new();
    }
    // One wrong letter in three is still a misspelling, more is another word.
    let bound = (name.len() / 3).max(2);
    let mut found: Vec<(usize, &Parameter)> = parameters
        .iter()
        .map(|parameter| (score(parameter.name, name), parameter))
        .filter(|(score, _)| *score <= 2 * bound)
        .collect();
    found.sort_by_key(|(score, parameter)| (*score, parameter.pnu));
    found.dedup_by_key(|(_, parameter)| parameter.name);
    found
        .into_iter()
        .take(count)
        .map(|(_, parameter)| parameter)
        .collect()
}

/// Twice the edit distance; a name that merely goes on where the text ends, or lacks the group before the dot, is
/// nearer than its length suggests.
fn score(name: &str, text: &str) -> usize {
    let whole = 2 * distance(name.as_bytes(), text.as_bytes());
    let begins = name
        .get(..text.len())
        .is_some_and(|start| start.eq_ignore_ascii_case(text));
    let tail = name.split_once('.').map_or(usize::MAX, |(_, tail)| {
        2 * distance(tail.as_bytes(), text.as_bytes()) + 1
    });
    if begins {
        whole.min((name.len() - text.len()) / 8 + 1)
    } else {
        whole.min(tail)
    }
}

/// Returns the distance between two names: the least number of characters inserted, deleted, replaced or swapped with
/// their neighbour, without regard to ASCII case.
#[must_use]
pub fn name_distance(a: &str, b: &str) -> usize {
    distance(a.as_bytes(), b.as_bytes())
}

fn distance(a: &[u8], b: &[u8]) -> usize {
    let width = b.len() + 1;
    let mut rows = [vec![0; width], (0..width).collect::<Vec<usize>>(), vec![0; width]];
    for (i, x) in a.iter().enumerate() {
        let [before, above, row] = &mut rows;
        for (column, cell) in row.iter_mut().enumerate() {
            let Some(j) = column.checked_sub(1) else {
                *cell = i + 1;
                continue;
            };
            let same =
                |p: Option<&u8>, q: Option<&u8>| p.zip(q).is_some_and(|(p, q)| p.eq_ignore_ascii_case(q));
            let at = |line: &[usize], column: usize| line.get(column).copied().unwrap_or(usize::MAX / 2);
            let mut best = at(above, column) + 1;
            best = best.min(at(above, j) + usize::from(!same(Some(x), b.get(j))));
            if i > 0 && j > 0 && same(Some(x), b.get(j - 1)) && same(a.get(i - 1), b.get(j)) {
                best = best.min(at(before, j - 1) + 1);
            }
            *cell = best;
        }
        // Insertions depend on the cell to the left and are done in a second pass over the same row.
        let mut left = usize::MAX / 2;
        for cell in row.iter_mut() {
            *cell = (*cell).min(left + 1);
            left = *cell;
        }
        rows.rotate_left(1);
    }
    rows[1].last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::super::AKD;
    use super::*;

    #[test]
    fn distances() {
        assert_eq!(distance(b"", b""), 0);
        assert_eq!(distance(b"abc", b""), 3);
        assert_eq!(distance(b"", b"abc"), 3);
        assert_eq!(distance(b"DRV.ACC", b"drv.acc"), 0);
        assert_eq!(distance(b"DRV.ACC", b"DRV.CAC"), 1);
        assert_eq!(distance(b"kitten", b"sitting"), 3);
    }

    #[test]
    fn misspellings_find_their_parameter() {
        let first = |name: &str| AKD.nearest(name, 3).first().map(|found| found.name);
        assert_eq!(first("DRV.ACCC"), Some("DRV.ACC"));
        assert_eq!(first("drv.opmod"), Some("DRV.OPMODE"));
        assert_eq!(first("NVSAVE"), Some("DRV.NVSAVE"));
        assert_eq!(first("VL.FB"), Some("VL.FB_32"));
        assert_eq!(first("IL.FRICTION"), Some("IL.FRCTION"));
        assert_eq!(first("completely different"), None);
        assert_eq!(first(""), None);
        assert!(
            AKD.nearest("TEMP.POWR", 5)
                .iter()
                .filter(|found| found.name == "TEMP.POWER")
                .count()
                == 1
        );
    }
}
