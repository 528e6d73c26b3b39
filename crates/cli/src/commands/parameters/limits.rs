//! Limits of a parameter in words, and whose they are: of the drive, of the tables, or only of the data type.

use profidrive::parameters::Limits;

use crate::render::number;

/// Returns the limits with their unit, and whose they are.
pub fn words(limits: &Limits, unit: &str) -> String {
    let shown = |value: f64| format!("{} {unit}", number(value)).trim_end().to_owned();
    let span = |(low, high): (f64, f64)| format!("{} to {}", shown(low), shown(high));
    let (lowest, highest) = limits.tables;
    if let Some(own) = limits.reported.map(span) {
        return match lowest.zip(highest).map(span) {
            Some(tables) if tables != own => format!("{own}, reported by the drive (tables: {tables})"),
            _ => format!("{own}, reported by the drive"),
        };
    }
    let of_type = limits.of_type.map_or_else(
        || "the type has none".to_owned(),
        |type_limits| format!("limits of the type: {}", span(type_limits)),
    );
    match limits.tables {
        (Some(low), Some(high)) => span((low, high)),
        (Some(low), None) => format!("at least {}; {of_type}", shown(low)),
        (None, Some(high)) => format!("at most {}; {of_type}", shown(high)),
        (None, None) => format!("none known; {of_type}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_the_type_are_not_shown_as_limits() {
        let words = |tables, reported| {
            let of_type = Some((0.0, 42_949_673.0));
            let limits = Limits {
                tables,
                reported,
                of_type,
            };
            words(&limits, "s")
        };
        let size = "limits of the type: 0 s to 42949673 s";
        assert_eq!(words((Some(0.01), Some(3600.0)), None), "0.01 s to 3600 s");
        assert_eq!(words((None, None), None), format!("none known; {size}"));
        assert_eq!(
            words((Some(0.01), None), None),
            format!("at least 0.01 s; {size}")
        );
        assert_eq!(words((None, Some(60.0)), None), format!("at most 60 s; {size}"));
        assert_eq!(
            words((Some(0.01), Some(3600.0)), Some((0.1, 60.0))),
            "0.1 s to 60 s, reported by the drive (tables: 0.01 s to 3600 s)"
        );
    }
}
