//! Device descriptions (GSDML).

use std::path::PathBuf;

use ::plant::host::interval;
use client::ErrorKind;
use profidrive::device_description::{self, show};
use pyo3::prelude::*;
use serde_json::json;

use crate::errors::{Failure, explained};
use crate::time::Span;
use crate::trace::document;

/// Everything that is against the rules in a device description; a report as JSON.
#[pyfunction]
pub fn gsdml_check(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let checked = py.detach(|| device_description::check(&path));
    let checked = checked.map_err(|error| Failure::new(ErrorKind::Local, error.to_string()))?;
    Ok(document(&checked.report)?)
}

/// What a device description says; a report as JSON.
#[pyfunction]
pub fn gsdml_show(py: Python<'_>, path: PathBuf, language: Option<&str>) -> PyResult<String> {
    let read = py.detach(|| device_description::read(&path));
    let read = read.map_err(|error| Failure::new(error.kind(), error.to_string()))?;
    let shown = show(&read, language);
    Ok(document(
        &shown.map_err(|error| Failure::usage(error.to_string()))?,
    )?)
}

/// Writes the device description of a virtual drive; a report as JSON.
#[pyfunction]
pub fn gsdml_export(py: Python<'_>, model: &str, folder: PathBuf, fastest: Option<Span>) -> PyResult<String> {
    let model = virtual_drive::model::by_name(model)
        .ok_or_else(|| explained(&::plant::ModelsError::Unknown(model.to_owned())))?;
    let fastest = fastest.map(|fastest| fastest.read()).transpose()?.map(interval);
    let fastest = fastest.transpose().map_err(|error| explained(&error))?;
    let written = py.detach(|| device_description::export(model, fastest, &folder));
    let written = written.map_err(|error| {
        let failure = Failure::new(ErrorKind::Local, error.to_string());
        failure.with(json!({ "errno": error.source.raw_os_error(), "filename": error.path }))
    })?;
    Ok(document(&written)?)
}
