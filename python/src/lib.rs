//! The binding of the Python package `profidrive`: it translates calls and values and has no rule of its own.
//!
//! Only the Python files beside it use it. Documents travel as JSON in the form of docs/schema, samples as Arrow columns,
//! times as seconds or as people write them (`400ms`). Errors become the classes of `profidrive.errors`.

mod attention;
mod axis;
mod campaign;
mod capture;
mod description;
mod errors;
mod joined;
mod log;
mod network;
mod plant;
mod process;
mod recording;
mod served;
mod table;
mod time;
mod trace;
mod verb;
mod words;
mod world;

use pyo3::prelude::*;

/// Version, and how the binding was built.
#[pyfunction]
fn build_info() -> (
    &'static str,
    Option<&'static str>,
    &'static str,
    Vec<&'static str>,
) {
    let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
    (
        env!("CARGO_PKG_VERSION"),
        option_env!("PROFIDRIVE_COMMIT"),
        profile,
        profidrive::FEATURES.to_vec(),
    )
}

/// The kinds of errors by their stable names.
#[pyfunction]
fn error_kinds() -> Vec<&'static str> {
    client::ErrorKind::ALL.iter().map(|(_, id)| *id).collect()
}

/// The states of the general state machine: number and name.
#[pyfunction]
fn states() -> Vec<(u8, &'static str)> {
    let states = profile::state::State::ALL.into_iter();
    states.map(|state| (state.number(), state.name())).collect()
}

#[pymodule]
fn _profidrive(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(build_info, module)?)?;
    module.add_function(wrap_pyfunction!(error_kinds, module)?)?;
    module.add_function(wrap_pyfunction!(states, module)?)?;
    module.add_class::<plant::Plant>()?;
    module.add_class::<world::World>()?;
    module.add_function(wrap_pyfunction!(network::open, module)?)?;
    module.add_function(wrap_pyfunction!(joined::leave_all, module)?)?;
    module.add_function(wrap_pyfunction!(axis::hold_together, module)?)?;
    module.add_function(wrap_pyfunction!(axis::release_together, module)?)?;
    module.add_function(wrap_pyfunction!(description::gsdml_check, module)?)?;
    module.add_function(wrap_pyfunction!(description::gsdml_show, module)?)?;
    module.add_function(wrap_pyfunction!(description::gsdml_export, module)?)?;
    module.add_class::<axis::Axis>()?;
    module.add_class::<campaign::Campaign>()?;
    module.add_class::<campaign::Runs>()?;
    module.add_class::<capture::Capture>()?;
    module.add_class::<network::Network>()?;
    module.add_class::<recording::Recording>()?;
    module.add_class::<served::Served>()?;
    module.add_class::<verb::Verb>()?;
    module.add_class::<trace::Trace>()?;
    module.add_class::<table::Table>()?;
    module.add_class::<table::Column>()
}
