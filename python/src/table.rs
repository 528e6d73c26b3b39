//! Tables of columns: handed to other programs as Arrow, and to numpy as they are.

use std::path::Path;
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{
    DurationNanosecondType, Float64Type, Int64Type, TimestampNanosecondType, UInt16Type,
};
use arrow_array::{Array, ArrayRef, Int64Array, RecordBatch, RecordBatchIterator};
use arrow_schema::{DataType, Field};
use client::ErrorKind;
use profidrive::recording::{Form, RecordingFile, Row, Sink as _, Table as Columns};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict};

use crate::errors::{Failure, explained};

/// What numpy has for a time that is not known.
const NOT_A_TIME: i64 = i64::MIN;

/// Rows in memory.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Table {
    batch: RecordBatch,
}

impl Table {
    pub const fn new(batch: RecordBatch) -> Self {
        Self { batch }
    }

    fn field(&self, name: &str) -> Result<(&Field, &ArrayRef), Failure> {
        let schema = self.batch.schema_ref();
        let place = schema.index_of(name);
        let place = place.map_err(|_| {
            let names: Vec<_> = schema
                .fields()
                .iter()
                .map(|field| field.name().as_str())
                .collect();
            Failure::usage(format!("no column `{name}`; there are: {}", names.join(", ")))
        })?;
        Ok((schema.field(place), self.batch.column(place)))
    }
}

#[pymethods]
impl Table {
    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    /// Names of the columns with their units.
    fn columns(&self) -> Vec<(String, String)> {
        let fields = self.batch.schema_ref().fields().iter();
        let unit = |field: &Field| field.metadata().get("unit").cloned().unwrap_or_default();
        fields.map(|field| (field.name().clone(), unit(field))).collect()
    }

    /// What is known about the whole table.
    fn metadata(&self) -> Vec<(String, String)> {
        let facts = self.batch.schema_ref().metadata().iter();
        let mut facts: Vec<_> = facts.map(|(name, text)| (name.clone(), text.clone())).collect();
        facts.sort();
        facts
    }

    /// A column of numbers as it is in memory; of a dictionary its keys.
    fn column(&self, name: &str) -> PyResult<Column> {
        let (_, array) = self.field(name)?;
        let array = match array.data_type() {
            DataType::Dictionary(..) => {
                Arc::new(array.as_dictionary::<UInt16Type>().keys().clone()) as ArrayRef
            }
            _ => Arc::clone(array),
        };
        Ok(Column::new(array)?)
    }

    /// The texts of a dictionary; nothing for another column.
    fn texts(&self, name: &str) -> PyResult<Vec<String>> {
        let (_, array) = self.field(name)?;
        let values = array
            .as_dictionary_opt::<UInt16Type>()
            .and_then(|keys| keys.values().as_string_opt::<i32>().cloned());
        let texts = values.iter().flatten().flatten();
        Ok(texts.map(str::to_owned).collect())
    }

    /// The values of a column of bits.
    fn bits(&self, name: &str) -> PyResult<Vec<bool>> {
        let (_, array) = self.field(name)?;
        let bits = array.as_boolean_opt();
        Ok(bits.map_or_else(Vec::new, |bits| bits.values().iter().collect()))
    }

    /// The Arrow stream of the PyCapsule interface; nothing is copied.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // the interface leaves it to the producer whether it converts
        drop(requested_schema);
        let schema = self.batch.schema();
        let rows = RecordBatchIterator::new([Ok(self.batch.clone())], schema);
        let stream = FFI_ArrowArrayStream::new(Box::new(rows));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }
}

/// A column of numbers, seen by numpy through the array interface. It keeps the table alive.
#[pyclass(frozen, module = "profidrive._profidrive")]
pub struct Column {
    array: ArrayRef,
    /// Form of a value, as numpy writes it.
    form: &'static str,
    /// Where the values are.
    address: usize,
}

impl Column {
    fn new(array: ArrayRef) -> Result<Self, Failure> {
        let (form, address) = match array.data_type() {
            DataType::Float64 => (
                "<f8",
                array.as_primitive::<Float64Type>().values().as_ptr() as usize,
            ),
            DataType::Int64 => (
                "<i8",
                array.as_primitive::<Int64Type>().values().as_ptr() as usize,
            ),
            DataType::UInt16 => (
                "<u2",
                array.as_primitive::<UInt16Type>().values().as_ptr() as usize,
            ),
            DataType::Duration(_) => (
                "<m8[ns]",
                array.as_primitive::<DurationNanosecondType>().values().as_ptr() as usize,
            ),
            DataType::Timestamp(..) => {
                // a time that is not known is the one that numpy has for it
                let times = array.as_primitive::<TimestampNanosecondType>();
                let times = times.iter().map(|time| time.unwrap_or(NOT_A_TIME));
                let times = Int64Array::from_iter_values(times);
                let address = times.values().as_ptr() as usize;
                return Ok(Self {
                    array: Arc::new(times),
                    form: "<M8[ns]",
                    address,
                });
            }
            other => return Err(Failure::internal(&format!("a column of {other} has no view"))),
        };
        Ok(Self { array, form, address })
    }
}

#[pymethods]
impl Column {
    fn __len__(&self) -> usize {
        self.array.len()
    }

    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("typestr", self.form)?;
        interface.set_item("shape", (self.array.len(),))?;
        // the second value: the memory is read only
        interface.set_item("data", (self.address, true))?;
        Ok(interface)
    }
}

/// Writes rows to a file whose name decides its form.
pub fn write(columns: &Columns, rows: &[Row], path: &Path) -> Result<(), Failure> {
    let form = Form::of(path).ok_or_else(|| {
        let ends: Vec<_> = Form::ends().collect();
        Failure::usage(format!(
            "{}: the end of the name is none of {}",
            path.display(),
            ends.join(", ")
        ))
    })?;
    let mut file = RecordingFile::create(columns, path, form, None).map_err(|error| explained(&error))?;
    for row in rows {
        file.write(row).map_err(|error| explained(&error))?;
    }
    file.finish().map_err(|error| explained(&error))
}

/// A file that cannot be written.
pub fn unwritten(path: &Path, error: &std::io::Error) -> Failure {
    Failure::new(ErrorKind::Local, format!("{}: {error}", path.display()))
}
