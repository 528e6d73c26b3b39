//! `profidrive gsdml check FILE`

use std::fs::File;
use std::io::Read;
use std::path::Path;

use client::ErrorKind;
use gsdml::{Bitmap, Gsdml, Problem, Severity};
use profidrive::report::{GsdmlCheckReport, GsdmlProblem};

use crate::args::GsdmlCheck;
use crate::failure::Failure;
use crate::output::{Colour, Output};
use crate::render::table::clean;

/// Size of a picture in points.
const PICTURE: (u32, u32) = (70, 40);

/// Octets of a picture that are read; its size stands in the first 26.
const HEAD: u64 = 64;

pub fn run(args: &GsdmlCheck, output: &Output) -> Result<(), Failure> {
    let path = &args.file;
    let report = gsdml::check(&super::octets(path)?, Some(&super::file_name(path)));
    let pictures = report
        .description
        .as_ref()
        .map_or_else(Vec::new, |description| pictures(path, description));
    let worst = |severity| {
        report
            .problems
            .iter()
            .filter(|problem| problem.severity == severity)
            .count()
    };
    let (unusable, errors) = (worst(Severity::Unusable), worst(Severity::Error));
    let warnings = worst(Severity::Warning) + pictures.len();
    output.json_report(&GsdmlCheckReport {
        file: path.display().to_string(),
        sound: report.is_sound(),
        usable: report.description.is_some(),
        problems: report.problems.iter().map(listed).collect(),
        left_out: report.left_out,
        pictures: pictures.clone(),
    });
    if !output.json() {
        for problem in &report.problems {
            let (colour, severity) = (colour(problem.severity), problem.severity.word());
            output.line(&format!(
                "{}:{}: {} {} [{}]",
                path.display(),
                problem.position,
                output.paint(colour, &format!("{severity}:")),
                clean(&problem.message),
                problem.rule.word(),
            ));
        }
        for words in &pictures {
            let warning = output.paint(Colour::Warning, "warning:");
            output.line(&format!(
                "{}: {warning} {} [picture]",
                path.display(),
                clean(words)
            ));
        }
        if report.left_out > 0 {
            output.line(&format!("and {} more", report.left_out));
        }
    }
    if report.is_sound() {
        let also = match warnings {
            0 => String::new(),
            1 => ", 1 warning".to_owned(),
            more => format!(", {more} warnings"),
        };
        output.say(&format!("{}: nothing against the rules{also}", path.display()));
        return Ok(());
    }
    let errors = errors + unusable + report.left_out;
    let what = if unusable > 0 {
        "the file cannot be used"
    } else {
        "the file can be used here, other tools may refuse it"
    };
    let count = if errors == 1 {
        "1 error".to_owned()
    } else {
        format!("{errors} errors")
    };
    Err(Failure::new(
        ErrorKind::Difference,
        format!("{}: {count}; {what}", path.display()),
    ))
}

const fn colour(severity: Severity) -> Colour {
    match severity {
        Severity::Warning => Colour::Warning,
        Severity::Error | Severity::Unusable => Colour::Fault,
    }
}

fn listed(problem: &Problem) -> GsdmlProblem {
    GsdmlProblem {
        severity: problem.severity.word(),
        rule: problem.rule.word(),
        line: problem.position.line,
        column: problem.position.column,
        message: problem.message.clone(),
    }
}

/// Returns the first octets of a picture, where its size stands.
fn head(path: &Path) -> Option<Vec<u8>> {
    let mut octets = Vec::new();
    let file = File::open(path).ok()?;
    file.take(HEAD).read_to_end(&mut octets).ok()?;
    Some(octets)
}

/// Pictures that tools would look for beside the file.
fn pictures(path: &Path, description: &Gsdml) -> Vec<String> {
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
