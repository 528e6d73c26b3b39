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
    let models = model::ALL.into_iter().filter_map(|model| {
        let tables = model.catalogue?;
        let parameters = parts.iter().flat_map(|&part| tables.parts_of(part));
        let names: Vec<String> = parameters.map(|parameter| label(tables, parameter)).collect();
        (!names.is_empty()).then(|| format!("{}: {}", tables.model, names.join(", ")))
    });
    let models: Vec<String> = models.collect();
    if models.is_empty() {
        return String::new();
    }
    format!(" ({})", models.join("; "))
}

/// Names of the profile are sentences: there the number is shorter.
fn label(tables: &Catalogue, parameter: &Parameter) -> String {
    match tables.notation {
        Notation::Name if parameter.name.contains(' ') => parameter.pnu.to_string(),
        _ => tables.label(parameter),
    }
}
