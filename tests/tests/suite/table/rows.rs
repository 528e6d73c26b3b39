//! The table, read from `data/akd/` a second time.

use std::collections::HashMap;
use std::ops::RangeInclusive;

const PARAMETERS: &str = include_str!("../../../../data/akd/parameters.csv");
const MEANINGS: &str = include_str!("../../../../data/akd/meanings.csv");
const DEVICE: &str = include_str!("../../../../data/akd/device.toml");

/// One row of the table.
#[derive(Debug, Clone)]
pub struct Row {
    pub pnu: u16,
    pub name: String,
    pub size: String,
    pub elements: u16,
    pub signed: bool,
    /// The next number is the high half of a 64-bit value.
    pub wide: bool,
    pub access: String,
    pub scale: String,
    pub minimum: Option<f64>,
    pub maximum: Option<f64>,
    pub default: Option<f64>,
}

impl Row {
    pub fn octets(&self) -> usize {
        match self.size.as_str() {
            "byte" => 1,
            "word" | "command" => 2,
            "dword" => 4,
            other => panic!("{other}"),
        }
    }

    pub fn format(&self) -> u8 {
        [0x41, 0x42, 0, 0x43][self.octets() - 1]
    }

    /// Type number of IEC 61158.
    pub fn data_type(&self) -> u8 {
        match (self.octets(), self.signed) {
            (1, true) => 2,
            (2, true) => 3,
            (4, true) => 4,
            (1, false) => 5,
            (2, false) => 6,
            _ => 7,
        }
    }

    pub fn is_array(&self) -> bool {
        self.elements > 1
    }

    /// Numbers that fit the size.
    pub fn range(&self) -> RangeInclusive<i64> {
        let bits = 8 * self.octets();
        if self.signed {
            -(1 << (bits - 1))..=(1 << (bits - 1)) - 1
        } else {
            0..=(1 << bits) - 1
        }
    }

    /// Steps of the number on the wire in one engineering unit, for a drive as delivered (manual 5.12 and 6).
    pub fn steps(&self) -> f64 {
        match self.scale.as_str() {
            // thousandths, divided by PN.POSSCALE, which is 1000 as delivered
            "position" => 1.0,
            "raw" => 1.0,
            "milli" => 1000.0,
            "velocity" => 4_294_967_296.0 / (1638.0 * 60.0 * 16_000.0),
            "acceleration" => 1.0 / 763.0,
            "current" => 16_384.0 / 9.0,
            "singleturn" => 65_536.0,
            "nominal-velocity" => 32_768.0 / 12_000.0,
            "mdi-velocity" => 4_294_967_296.0 / 12_000.0,
            other => panic!("{other}"),
        }
    }

    pub fn raw(&self, value: f64) -> i64 {
        let range = if self.wide {
            i64::MIN..=i64::MAX
        } else {
            self.range()
        };
        ((value * self.steps()).round() as i64).clamp(*range.start(), *range.end())
    }
}

/// The table, and the values of the drive's size.
pub struct Table {
    pub rows: Vec<Row>,
    /// Values that have a name, by parameter; `DINx.MODE` stands for `DIN1.MODE` and so on.
    choices: HashMap<String, Vec<i64>>,
    sized: HashMap<String, f64>,
}

impl Table {
    pub fn load() -> Self {
        let mut lines = PARAMETERS.lines();
        let head = cells(lines.next().unwrap());
        let rows = lines.map(|line| {
            let cells = cells(line);
            let cell = |name: &str| cells[head.iter().position(|known| known == name).unwrap()].clone();
            let number = |name: &str| cell(name).parse().ok();
            Row {
                pnu: cell("pnu").parse().unwrap(),
                name: cell("name"),
                size: cell("size"),
                elements: cell("elements").parse().unwrap(),
                signed: cell("signed") == "yes",
                wide: cell("wide") == "yes",
                access: cell("access"),
                scale: cell("scale"),
                minimum: number("minimum"),
                maximum: number("maximum"),
                default: number("default"),
            }
        });
        let sized = DEVICE
            .split("[values]")
            .nth(1)
            .unwrap()
            .lines()
            .filter_map(|line| {
                let (name, rest) = line.strip_prefix('"')?.split_once("\" = ")?;
                let value = rest.split('#').next()?.trim();
                Some((name.to_owned(), value.parse().unwrap()))
            });
        let mut choices: HashMap<String, Vec<i64>> = HashMap::new();
        for line in MEANINGS.lines().skip(1) {
            if let [name, kind, value, ..] = &cells(line)[..]
                && kind == "choice"
            {
                choices
                    .entry(name.clone())
                    .or_default()
                    .push(value.parse().unwrap());
            }
        }
        Self {
            choices,
            rows: rows.collect(),
            sized: sized.collect(),
        }
    }

    pub fn row(&self, pnu: u16) -> &Row {
        self.rows.iter().find(|row| row.pnu == pnu).unwrap()
    }

    /// Returns true when the table names values of this parameter and this one is none of them.
    pub fn is_nameless(&self, row: &Row, raw: i64) -> bool {
        let general = row.name.split_once('.').map(|(group, rest)| {
            let letters = group.trim_end_matches(|c: char| c.is_ascii_digit());
            format!("{letters}x.{rest}")
        });
        let named = self
            .choices
            .get(&row.name)
            .or_else(|| self.choices.get(&general?));
        named.is_some_and(|values| !values.contains(&raw))
    }

    /// Returns the value of a fresh drive, where the table states it.
    pub fn as_delivered(&self, row: &Row) -> Option<i64> {
        let value = self.sized.get(&row.name).copied().or(row.default)?;
        Some(row.raw(value))
    }

    /// Lowest and highest number that is accepted, of a 64-bit value by its first number alone.
    pub fn limits(&self, row: &Row) -> RangeInclusive<i64> {
        let (range, limits) = (row.range(), self.whole_limits(row));
        (*limits.start()).clamp(*range.start(), *range.end())
            ..=(*limits.end()).clamp(*range.start(), *range.end())
    }

    /// Lowest and highest number that is accepted. A row that is another name of a parameter has the limits of that one.
    pub fn whole_limits(&self, row: &Row) -> RangeInclusive<i64> {
        let other = ALIASES
            .iter()
            .find(|(pnu, _)| *pnu == row.pnu)
            .map_or(row, |(_, other)| self.row(*other));
        let range = match (row.wide, row.signed) {
            (true, true) => i64::MIN..=i64::MAX,
            (true, false) => 0..=i64::MAX,
            _ => row.range(),
        };
        let here = |value: f64| value * row.steps();
        let low = other
            .minimum
            .map_or(*range.start(), |value| here(value).round_limit(f64::ceil));
        let high = other
            .maximum
            .map_or(*range.end(), |value| here(value).round_limit(f64::floor));
        low.clamp(*range.start(), *range.end())..=high.clamp(*range.start(), *range.end())
    }
}

/// Same value under another number, by the descriptions of the table: HOME.MODE, the scalings, and the signals that map
/// to a parameter.
const ALIASES: [(u16, u16); 6] = [
    (103, 2203),
    (108, 2108),
    (109, 2115),
    (1001, 2203),
    (1008, 3065),
    (1009, 3064),
];

trait RoundLimit {
    fn round_limit(self, inwards: fn(f64) -> f64) -> i64;
}

impl RoundLimit for f64 {
    /// Returns the step next to a limit that is a step but for rounding errors; else the next step inside.
    fn round_limit(self, inwards: fn(f64) -> f64) -> i64 {
        let near = self.round();
        let value = if (self - near).abs() < 1e-6 {
            near
        } else {
            inwards(self)
        };
        value as i64
    }
}

/// Cells of a line of CSV with quotes.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    for character in line.chars() {
        match character {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            other => cells.last_mut().unwrap().push(other),
        }
    }
    cells
}
