//! Device descriptions (GSDML).

use std::path::PathBuf;

use client::ErrorKind;
use profidrive::device_description::{self, show};
use pyo3::prelude::*;

use crate::errors::Failure;
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
