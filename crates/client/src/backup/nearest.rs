//! A value as the parameter can have it.

use profile::catalogue::{Parameter, Scale, Scaling};

/// Returns the number on the wire for a value in its unit; an error when it is a fraction where there are none, or does
/// not fit.
pub(super) fn nearest(value: f64, parameter: &Parameter, scaling: &Scaling) -> Result<i64, String> {
    if parameter.scale == Scale::Raw && value.fract() != 0.0 {
        return Err(format!("takes whole numbers, not {value}"));
    }
    let raw = parameter.raw(value, scaling);
    let step = scaling.linear(parameter.scale).engineering(1).abs();
    // what does not fit was cut
    if (parameter.engineering(raw, scaling) - value).abs() > step * 0.75 {
        return Err(format!(
            "{value} {} does not fit its {} octets",
            parameter.unit_in(scaling),
            parameter.octets()
        ));
    }
    Ok(raw)
}
