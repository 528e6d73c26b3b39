//! Files of recordings: read back, at every moment, and on a full disk.
#![cfg(feature = "recording")]

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt16Type};
use arrow_array::{Array, RecordBatch};
use arrow_ipc::reader::{FileReader, StreamReader};
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use profidrive::Explained;
use profidrive::recording::{Column, Form, Kind, RecordingFile, Rotation, Row, Sink, Table, Value};

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("profidrive-recording-{}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn table() -> Table {
    let column = |name: &str, kind, unit: &str| Column {
        name: name.into(),
        kind,
        unit: unit.into(),
        parameter: "p1".into(),
        scaling: String::new(),
    };
    Table {
        drives: vec!["akd-1".into(), "b,\"2\"".into()],
        facts: Vec::new(),
        columns: vec![
            column("ZSW1", Kind::Word, ""),
            column("speed", Kind::Number, "rpm"),
        ],
    }
}

fn row(at: u64) -> Row {
    let gap = at % 7 == 3;
    Row {
        time: Duration::from_millis(at * 10),
        wall: Some(SystemTime::UNIX_EPOCH + Duration::from_millis(at)),
        drive: usize::from(at % 2 == 1),
        gap,
        values: if gap {
            vec![None, None]
        } else {
            vec![Some(Value::Word(0x0237)), Some(Value::Number(at as f64 / 4.0))]
        },
    }
}

fn write(file: &mut RecordingFile, rows: std::ops::Range<u64>) {
    for at in rows {
        file.write(&row(at)).expect("room");
    }
}

fn batches(file: &Path, form: Form) -> Vec<RecordBatch> {
    let open = || File::open(file).expect("there");
    match form {
        Form::Parquet => ParquetRecordBatchReader::try_new(open(), 1024)
            .expect("readable")
            .map(|batch| batch.expect("whole"))
            .collect(),
        Form::Arrow => FileReader::try_new(open(), None)
            .expect("readable")
            .map(|batch| batch.expect("whole"))
            .collect(),
        _ => StreamReader::try_new(open(), None)
            .expect("readable")
            .map(|batch| batch.expect("whole"))
            .collect(),
    }
}

fn rows(batches: &[RecordBatch]) -> usize {
    batches.iter().map(RecordBatch::num_rows).sum()
}

#[test]
fn each_form_comes_back_as_it_was() {
    let folder = folder("forms");
    for form in [Form::Arrow, Form::ArrowStream, Form::Parquet] {
        let path = folder.join(format!("{form:?}.x"));
        let mut file = RecordingFile::create(&table(), &path, form, None).unwrap();
        write(&mut file, 0..500);
        file.finish().unwrap();
        assert_eq!(file.files(), std::slice::from_ref(&path));
        let batches = batches(&path, form);
        assert_eq!(rows(&batches), 500, "{form:?}");
        let first = &batches[0];
        let schema = match form {
            Form::Parquet => {
                let file = File::open(&path).unwrap();
                ParquetRecordBatchReaderBuilder::try_new(file)
                    .unwrap()
                    .schema()
                    .clone()
            }
            _ => first.schema(),
        };
        assert_eq!(schema.metadata()["schema"], "profidrive/1");
        assert_eq!(schema.field_with_name("speed").unwrap().metadata()["unit"], "rpm");
        let drive = first
            .column_by_name("drive")
            .unwrap()
            .as_dictionary::<UInt16Type>();
        assert_eq!(drive.values().as_string::<i32>().value(1), "b,\"2\"");
        let gap = first.column_by_name("gap").unwrap().as_boolean();
        let speed = first
            .column_by_name("speed")
            .unwrap()
            .as_primitive::<Float64Type>();
        assert!(gap.value(3) && speed.is_null(3) && !gap.value(4));
        assert_eq!(speed.value(4), 1.0);
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 3, "nothing else is left");
    fs::remove_dir_all(folder).unwrap();
}

/// What a kill leaves: the file as it is at any moment, without its end.
#[test]
fn what_grows_is_readable_at_any_moment() {
    let folder = folder("kill");
    for (form, grows) in [
        (Form::Csv, "a.csv"),
        (Form::ArrowStream, "a.arrows"),
        (Form::Arrow, "a.arrow.part"),
        (Form::Parquet, "a.parquet.part"),
    ] {
        let path = folder.join(grows.trim_end_matches(".part"));
        let mut file = RecordingFile::create(&table(), &path, form, None).unwrap();
        for second in 1..5 {
            write(&mut file, (second - 1) * 100..second * 100 + 1);
            let path = folder.join(grows);
            // what is younger than a second may wait
            let least = (second as usize - 1) * 100;
            let count = match form {
                Form::Csv => {
                    let text = fs::read_to_string(&path).unwrap();
                    assert!(text.is_empty() || text.ends_with('\n'));
                    csv::Reader::from_path(&path)
                        .unwrap()
                        .records()
                        .map(Result::unwrap)
                        .count()
                }
                _ => rows(&batches(&path, Form::ArrowStream)),
            };
            assert!(count >= least, "{form:?}: {count} of {least}");
        }
        drop(file);
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn files_are_rotated_by_time_and_size_and_none_is_replaced() {
    let folder = folder("rotated");
    let path = folder.join("r.parquet");
    let rotation = Some(Rotation::Time(Duration::from_secs(1)));
    let mut file = RecordingFile::create(&table(), &path, Form::Parquet, rotation).unwrap();
    write(&mut file, 0..250);
    // complete files are there before the end
    assert_eq!(rows(&batches(&folder.join("r-0002.parquet"), Form::Parquet)), 100);
    file.finish().unwrap();
    let counts: Vec<usize> = file
        .files()
        .iter()
        .map(|file| rows(&batches(file, Form::Parquet)))
        .collect();
    assert_eq!(counts, [100, 100, 50]);
    let again = RecordingFile::create(&table(), &path, Form::Parquet, rotation).unwrap_err();
    assert!(again.to_string().contains("r-0001.parquet"), "{again}");

    let path = folder.join("s.csv");
    let mut file = RecordingFile::create(&table(), &path, Form::Csv, Some(Rotation::Octets(10_000))).unwrap();
    write(&mut file, 0..1000);
    file.finish().unwrap();
    assert!(file.files().len() >= 3, "{:?}", file.files());
    let lines = |file: &PathBuf| fs::read_to_string(file).unwrap().lines().count() - 1;
    assert_eq!(file.files().iter().map(lines).sum::<usize>(), 1000);
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn rows_are_written_before_many_wait() {
    let folder = folder("waiting");
    let path = folder.join("a.csv");
    let mut file = RecordingFile::create(&table(), &path, Form::Csv, None).unwrap();
    let at_once = Row {
        time: Duration::ZERO,
        ..row(0)
    };
    for _ in 0..8193 {
        file.write(&at_once).unwrap();
    }
    let written = fs::read_to_string(&path).unwrap().lines().count();
    assert!(written >= 8192, "{written}");
    drop(file);
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_exists_is_found_beforehand_and_explained() {
    let folder = folder("check");
    let explained = |path: &Path, form, rotation| {
        let error = RecordingFile::check(path, form, rotation).unwrap_err();
        (error.message(), error.advice().to_string())
    };
    let path = folder.join("a.parquet");
    RecordingFile::check(&path, Form::Parquet, None).unwrap();
    fs::write(folder.join("a.parquet.part"), "").unwrap();
    let (message, advice) = explained(&path, Form::Parquet, None);
    assert!(message.ends_with("a.parquet.part` exists already"), "{message}");
    assert!(
        advice.contains("did not end") && advice.contains(".arrows"),
        "{advice}"
    );
    fs::write(folder.join("b-0001.csv"), "").unwrap();
    let rotation = Some(Rotation::Octets(10_000));
    let (message, advice) = explained(&folder.join("b.csv"), Form::Csv, rotation);
    assert!(message.ends_with("b-0001.csv` exists already"), "{message}");
    assert_eq!(advice, "choose another name: recordings are not replaced");
    RecordingFile::check(&folder.join("b.csv"), Form::Csv, None).unwrap();
    assert!(RecordingFile::check(&folder.join("no/such/folder.csv"), Form::Csv, None).is_err());
    fs::remove_dir_all(&folder).unwrap();
}
