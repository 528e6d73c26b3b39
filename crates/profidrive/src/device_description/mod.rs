//! Device descriptions (GSDML) in files: read, checked and shown.
//!
//! ```no_run
//! use profidrive::device_description;
//!
//! let file = "GSDML-V2.1-KOLLMORGEN-AKD-20140301.xml".as_ref();
//! for problem in device_description::check(file)?.report.problems {
//!     println!("line {}: {}", problem.line, problem.message);
//! }
//! # Ok::<(), device_description::UnreadError>(())
//! ```

mod show;

use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use client::ErrorKind;
use gsdml::{Bitmap, Gsdml, MOST_OCTETS, Problem, Severity};
use network::files::{StateFile, StateFileError};
use virtual_drive::description::export::export_with;
use virtual_drive::model::Model;

use crate::report::{GsdmlCheckReport, GsdmlExportReport, GsdmlProblem};
use crate::{Outcome, Reported};

pub use show::{LanguageError, show};

/// Size of a picture in points.
const PICTURE: (u32, u32) = (70, 40);

/// Octets of a picture that are read; its size stands in the first 26.
const HEAD: u64 = 64;

/// A file that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("cannot read {}: {error}", .file.display())]
pub struct UnreadError {
    /// The file.
    pub file: PathBuf,
    /// Why.
    #[source]
    pub error: io::Error,
}

/// Why a device description cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be read.
    #[error(transparent)]
    Unread(#[from] UnreadError),
    /// What it means is not certain. [`check`] has everything that is wrong with it.
    #[error("{}:{}: {}", .file.display(), .problem.position, .problem.message)]
    Unusable {
        /// The file.
        file: PathBuf,
        /// The first problem.
        problem: Problem,
    },
}

impl ReadError {
    /// What kind of error it is.
    #[must_use]
    pub const fn kind(&self) -> ErrorKind {
        ErrorKind::Local
    }
}

/// Reads a device description that can be used.
///
/// # Errors
/// When the file cannot be read, or what it means is not certain.
pub fn read(file: &Path) -> Result<Gsdml, ReadError> {
    gsdml::parse(&octets(file)?).map_err(|problem| ReadError::Unusable {
        file: file.to_owned(),
        problem,
    })
}

/// Checks a device description and the pictures beside it. Where something is against the rules the outcome is
/// [`Outcome::Difference`].
///
/// # Errors
/// When the file cannot be read.
pub fn check(file: &Path) -> Result<Reported<GsdmlCheckReport>, UnreadError> {
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned());
    let found = gsdml::check(&octets(file)?, name.as_deref());
    let pictures = found.description.as_ref();
    let report = GsdmlCheckReport {
        file: file.display().to_string(),
        sound: found.is_sound(),
        usable: found.description.is_some(),
        pictures: pictures.map_or_else(Vec::new, |description| pictures_of(file, description)),
        problems: found.problems.iter().map(GsdmlProblem::from).collect(),
        left_out: found.left_out,
    };
    let outcome = if report.sound {
        Outcome::Complete
    } else {
        Outcome::Difference
    };
    Ok(Reported { report, outcome })
}

/// Writes the device description of a virtual drive and its pictures into a folder, under the names that the rules give them.
/// Files of these names are replaced. `fastest` is the shortest update time in steps of 31.25 us; `None` for that of the model.
///
/// # Errors
/// When a file cannot be written.
pub fn export(
    model: &'static Model,
    fastest: Option<u16>,
    folder: &Path,
) -> Result<GsdmlExportReport, StateFileError> {
    let exported = export_with(model, fastest);
    let description = exported.description.to_xml().into_bytes();
    let description = (exported.file_name.to_string(), description);
    let mut files = Vec::new();
    for (name, content) in std::iter::once(description).chain(exported.pictures) {
        let path = folder.join(name);
        StateFile::document(&path).replace(&content)?;
        files.push(path.display().to_string());
    }
    Ok(GsdmlExportReport { files })
}

impl From<&Problem> for GsdmlProblem {
    fn from(problem: &Problem) -> Self {
        Self {
            severity: problem.severity.word(),
            rule: problem.rule.word(),
            line: problem.position.line,
            column: problem.position.column,
            message: problem.message.clone(),
        }
    }
}

impl GsdmlProblem {
    /// Returns true where the rules allow it, but tools may stumble.
    #[must_use]
    pub fn is_warning(&self) -> bool {
        self.severity == Severity::Warning.word()
    }
}

/// The octets of a file, not more than a description may have.
fn octets(path: &Path) -> Result<Vec<u8>, UnreadError> {
    let mut octets = Vec::new();
    // one octet more than accepted, so that a longer file is detected
    let most = MOST_OCTETS as u64 + 1;
    File::open(path)
        .and_then(|file| file.take(most).read_to_end(&mut octets))
        .map_err(|error| UnreadError {
            file: path.to_owned(),
            error,
        })?;
    Ok(octets)
}

/// Returns the first octets of a picture, where its size stands.
fn head(path: &Path) -> Option<Vec<u8>> {
    let mut octets = Vec::new();
    let file = File::open(path).ok()?;
    file.take(HEAD).read_to_end(&mut octets).ok()?;
    Some(octets)
}

/// What is wrong with the pictures that tools would look for beside the file.
fn pictures_of(path: &Path, description: &Gsdml) -> Vec<String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut wrong = Vec::new();
    for graphic in &description.graphics {
        // a name with a folder in it is reported already, and not followed
        if graphic.file.is_empty() || graphic.file.contains(['/', '\\', ':', '\0']) {
            continue;
        }
        let found = ["bmp", "BMP"]
            .into_iter()
            .find_map(|ending| head(&folder.join(format!("{}.{ending}", graphic.file))));
        match found.as_deref().map(Bitmap::size_of) {
            None => wrong.push(format!("there is no {}.bmp beside the file", graphic.file)),
            Some(Some(PICTURE)) => {}
            Some(Some((width, height))) => wrong.push(format!(
                "{}.bmp has {width} x {height} points, not 70 x 40",
                graphic.file
            )),
            Some(None) => wrong.push(format!("{}.bmp is not a bitmap", graphic.file)),
        }
    }
    wrong
}
