//! What a parameter is called in the models that have it: texts name its role (`Part`), the tables of the model its name.

use profile::catalogue::{Catalogue, Parameter, Part};
use profile::model;
use profile::notation::Notation;

/// Returns the parameter with this part as the model of this name writes it. `None` where the model has no tables or no such
/// parameter.
pub(crate) fn in_model(name: &str, part: Part) -> Option<String> {
    let tables = model::ALL.into_iter().filter_map(|model| model.catalogue);
    let tables = tables.into_iter().find(|tables| tables.model == name)?;
    Some(label(tables, tables.part(part)?))
}

/// Returns the parameters with these parts, of each model that has them: ` (AKD: PN.VELSCALING, 1009)`.
pub(crate) fn in_models(parts: &[Part]) -> String {
    let models = labels(parts).map(|(model, names)| format!("{model}: {}", names.join(", ")));
    let models: Vec<String> = models.collect();
    if models.is_empty() {
        return String::new();
    }
    format!(" ({})", models.join("; "))
}

/// Returns the action that reads the parameters with these parts; where more than one model has them, one for each:
/// `{read VL.LIMITP VL.LIMITN} (AKD) or {read 4-13} (VLT)`.
pub(crate) fn read_in_models(parts: &[Part]) -> String {
    action_in_models(parts, |names| format!("{{read {}}}", names.join(" ")))
}

/// Returns the action that writes the parameter with this part, as [`read_in_models`].
pub(crate) fn write_in_models(part: Part, value: i64) -> String {
    action_in_models(&[part], |names| format!("{{write {}={value}}}", names.join(" ")))
}

fn action_in_models(parts: &[Part], action: impl Fn(&[String]) -> String) -> String {
    let models = labels(parts).map(|(model, names)| {
        // blanks separate the parameters
        let names: Vec<String> = names.iter().map(|name| name.replace(' ', "")).collect();
        (model, action(&names))
    });
    match models.collect::<Vec<_>>().as_slice() {
        [(_, action)] => action.clone(),
        many => {
            let each = many.iter().map(|(model, action)| format!("{action} ({model})"));
            each.collect::<Vec<_>>().join(" or ")
        }
    }
}

/// The models that have parameters with these parts, and how they write them.
fn labels(parts: &[Part]) -> impl Iterator<Item = (&'static str, Vec<String>)> {
    model::ALL.into_iter().filter_map(|model| {
        let tables = model.catalogue?;
        let parameters = parts.iter().flat_map(|&part| tables.parts_of(part));
        let names: Vec<String> = parameters.map(|parameter| label(tables, parameter)).collect();
        (!names.is_empty()).then_some((tables.model, names))
    })
}

/// Names of the profile are sentences: there the number is shorter.
fn label(tables: &Catalogue, parameter: &Parameter) -> String {
    match tables.notation {
        Notation::Name if parameter.name.contains(' ') => parameter.pnu.to_string(),
        _ => tables.label(parameter),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_named_by_the_models_that_have_it() {
        let switches = [Part::PositiveSwitch, Part::NegativeSwitch];
        assert_eq!(read_in_models(&switches), "{read HWLS.POSSTATE HWLS.NEGSTATE}");
        let limit = read_in_models(&[Part::CurrentLimit]);
        assert_eq!(limit, "{read 4-18} (VLT) or {read ID107} (VACON)");
    }
}
