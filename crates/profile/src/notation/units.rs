//! The units a person may write, as one table.

use core::fmt;

/// What a unit measures. Only units of one dimension convert into each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Dimension {
    /// Rotational speed.
    Speed,
    /// Rotational acceleration.
    Acceleration,
    /// Time.
    Time,
    /// Current, peak or direct.
    Current,
    /// Current, effective value.
    CurrentRms,
    /// Voltage.
    Voltage,
    /// Voltage, effective value.
    VoltageRms,
    /// Torque.
    Torque,
    /// Frequency.
    Frequency,
    /// Power.
    Power,
    /// Energy.
    Energy,
    /// Resistance.
    Resistance,
    /// Inductance.
    Inductance,
    /// Length.
    Length,
    /// Temperature.
    Temperature,
    /// Share of a reference value.
    Ratio,
    /// Moment of inertia.
    Inertia,
    /// Feedback increments.
    Counts,
    /// Increments of which 2^32 are one revolution.
    FineCounts,
    /// User length unit.
    UserLength,
    /// Turns of the shaft.
    Turns,
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Speed => "speed",
            Self::Acceleration => "acceleration",
            Self::Time => "time",
            Self::Current => "current",
            Self::CurrentRms => "effective current",
            Self::Voltage => "voltage",
            Self::VoltageRms => "effective voltage",
            Self::Torque => "torque",
            Self::Frequency => "frequency",
            Self::Power => "power",
            Self::Energy => "energy",
            Self::Resistance => "resistance",
            Self::Inductance => "inductance",
            Self::Length => "length",
            Self::Temperature => "temperature",
            Self::Ratio => "ratio",
            Self::Inertia => "moment of inertia",
            Self::Counts => "count",
            Self::FineCounts => "count of 2^32 a revolution",
            Self::UserLength => "user length",
            Self::Turns => "angle",
        })
    }
}

/// One unit: its printed symbol, other accepted spellings, and its size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// As printed.
    pub symbol: &'static str,
    /// Also accepted. Compared without regard to case only when no unit matches exactly (`ms` and `MS`).
    pub aliases: &'static [&'static str],
    /// What it measures.
    pub dimension: Dimension,
    /// Size in the first unit of its dimension.
    pub factor: f64,
}

const fn unit(
    symbol: &'static str,
    aliases: &'static [&'static str],
    dimension: Dimension,
    factor: f64,
) -> Unit {
    Unit {
        symbol,
        aliases,
        dimension,
        factor,
    }
}

const RAD: f64 = 60.0 / core::f64::consts::TAU;

/// Every unit, the first of each dimension being its base.
pub const UNITS: &[Unit] = &[
    unit(
        "rpm",
        &["1/min", "min^-1", "min-1", "rev/min", "r/min"],
        Dimension::Speed,
        1.0,
    ),
    unit("rps", &["rev/s", "1/s"], Dimension::Speed, 60.0),
    unit("rad/s", &[], Dimension::Speed, RAD),
    unit("deg/s", &["°/s"], Dimension::Speed, 1.0 / 6.0),
    unit("rpm/s", &["1/min/s"], Dimension::Acceleration, 1.0),
    unit(
        "rps/s",
        &["rps^2", "rev/s^2", "rev/s2", "1/s^2"],
        Dimension::Acceleration,
        60.0,
    ),
    unit("rad/s^2", &["rad/s2", "rad/s²"], Dimension::Acceleration, RAD),
    unit(
        "deg/s^2",
        &["deg/s2", "°/s²", "°/s^2"],
        Dimension::Acceleration,
        1.0 / 6.0,
    ),
    unit("s", &["sec"], Dimension::Time, 1.0),
    unit("ms", &[], Dimension::Time, 1e-3),
    unit("us", &["µs", "μs"], Dimension::Time, 1e-6),
    unit("ns", &[], Dimension::Time, 1e-9),
    unit("min", &[], Dimension::Time, 60.0),
    unit("h", &[], Dimension::Time, 3600.0),
    unit("d", &["days"], Dimension::Time, 86_400.0),
    unit("A", &[], Dimension::Current, 1.0),
    unit("mA", &[], Dimension::Current, 1e-3),
    unit("kA", &[], Dimension::Current, 1e3),
    unit("Arms", &["Aeff"], Dimension::CurrentRms, 1.0),
    unit("mArms", &[], Dimension::CurrentRms, 1e-3),
    unit("V", &[], Dimension::Voltage, 1.0),
    unit("mV", &[], Dimension::Voltage, 1e-3),
    unit("kV", &[], Dimension::Voltage, 1e3),
    unit("Vrms", &["Veff"], Dimension::VoltageRms, 1.0),
    unit("Nm", &[], Dimension::Torque, 1.0),
    unit("mNm", &[], Dimension::Torque, 1e-3),
    unit("kNm", &[], Dimension::Torque, 1e3),
    unit("Hz", &[], Dimension::Frequency, 1.0),
    unit("mHz", &[], Dimension::Frequency, 1e-3),
    unit("kHz", &[], Dimension::Frequency, 1e3),
    unit("MHz", &[], Dimension::Frequency, 1e6),
    unit("GHz", &[], Dimension::Frequency, 1e9),
    unit("W", &[], Dimension::Power, 1.0),
    unit("mW", &[], Dimension::Power, 1e-3),
    unit("kW", &[], Dimension::Power, 1e3),
    unit("MW", &[], Dimension::Power, 1e6),
    unit("hp", &["HP"], Dimension::Power, 745.699_871_582_270_2),
    unit("Wh", &[], Dimension::Energy, 1.0),
    unit("kWh", &[], Dimension::Energy, 1e3),
    unit("MWh", &[], Dimension::Energy, 1e6),
    unit("ohm", &["Ω", "Ohm"], Dimension::Resistance, 1.0),
    unit("mohm", &["mΩ", "mOhm"], Dimension::Resistance, 1e-3),
    unit("kohm", &["kΩ", "kOhm"], Dimension::Resistance, 1e3),
    unit("H", &[], Dimension::Inductance, 1.0),
    unit("mH", &[], Dimension::Inductance, 1e-3),
    unit("uH", &["µH", "μH"], Dimension::Inductance, 1e-6),
    unit("m", &[], Dimension::Length, 1.0),
    unit("mm", &[], Dimension::Length, 1e-3),
    unit("um", &["µm", "μm"], Dimension::Length, 1e-6),
    unit("degC", &["°C", "C"], Dimension::Temperature, 1.0),
    unit("%", &["percent"], Dimension::Ratio, 1.0),
    unit("kgcm^2", &["kgcm2", "kg*cm^2", "kgcm²"], Dimension::Inertia, 1.0),
    unit("kgm^2", &["kgm2", "kg*m^2", "kgm²"], Dimension::Inertia, 1e4),
    unit("counts", &["count", "cts", "inc"], Dimension::Counts, 1.0),
    unit("counts32", &["cts32"], Dimension::FineCounts, 1.0),
    unit("LU", &[], Dimension::UserLength, 1.0),
    unit("rev", &["turns"], Dimension::Turns, 1.0),
    unit("deg", &["°"], Dimension::Turns, 1.0 / 360.0),
    unit("rad", &[], Dimension::Turns, 1.0 / core::f64::consts::TAU),
];

/// Returns the unit written as `text`: exact spelling first, then without regard to case where that is unambiguous.
#[must_use]
pub fn unit_named(text: &str) -> Option<&'static Unit> {
    let spelled = |unit: &Unit, same: &dyn Fn(&str, &str) -> bool| {
        same(unit.symbol, text) || unit.aliases.iter().any(|alias| same(alias, text))
    };
    if let Some(unit) = UNITS.iter().find(|unit| spelled(unit, &|a, b| a == b)) {
        return Some(unit);
    }
    let mut loose = UNITS
        .iter()
        .filter(|unit| spelled(unit, &|a, b| a.eq_ignore_ascii_case(b)));
    match (loose.next(), loose.next()) {
        (Some(unit), None) => Some(unit),
        _ => None,
    }
}

/// Returns the units that measure the same as `dimension`, in table order.
pub fn units_of(dimension: Dimension) -> impl Iterator<Item = &'static Unit> {
    UNITS.iter().filter(move |unit| unit.dimension == dimension)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_unique_and_found() {
        for (at, unit) in UNITS.iter().enumerate() {
            assert_eq!(unit_named(unit.symbol), Some(unit));
            for alias in unit.aliases {
                assert_eq!(unit_named(alias), Some(unit), "{alias}");
            }
            assert!(
                UNITS[at + 1..].iter().all(|other| other.symbol != unit.symbol),
                "{}",
                unit.symbol
            );
        }
    }

    /// What the tables of the converters and a description call a unit can be written.
    #[test]
    fn units_of_the_tables_are_known() {
        use crate::catalogue::{VACON, VLT};
        let tables = [&VLT, &VACON].into_iter().flat_map(|model| model.parameters);
        let described = crate::unit::QUANTITIES.iter().flat_map(|quantity| quantity.units);
        let symbols = tables
            .map(|row| row.unit)
            .chain(described.map(|(symbol, _)| *symbol));
        for symbol in symbols.filter(|symbol| !symbol.is_empty()) {
            let known = unit_named(symbol).map(|unit| unit.symbol);
            assert!(
                known == Some(symbol) || symbol.contains('/'),
                "{symbol} {known:?}"
            );
        }
    }

    #[test]
    fn case_matters_only_where_it_must() {
        assert_eq!(unit_named("RPM").map(|u| u.symbol), Some("rpm"));
        assert_eq!(unit_named("mHz").map(|u| u.factor), Some(1e-3));
        assert_eq!(unit_named("MHz").map(|u| u.factor), Some(1e6));
        assert_eq!(unit_named("mhz"), None);
        assert_eq!(unit_named("furlong"), None);
    }

    #[test]
    fn the_first_of_each_dimension_is_its_base() {
        for unit in UNITS {
            assert_eq!(
                units_of(unit.dimension).next().map(|u| u.factor),
                Some(1.0),
                "{}",
                unit.dimension
            );
        }
    }
}
