//! `profidrive step`

use std::path::Path;
use std::time::Duration;

use client::Wait;
use profidrive::lasting;
use profidrive::motion::{self, Response, StepPoint, Stepped};
use profidrive::recording::{EarlierStep, overlay};
use profidrive::report::StepReport;

use super::axis;
use super::record::{check_plot, draw};
use super::recorded::Recorder;
use crate::args::{Step, Target};
use crate::failure::Failure;
use crate::output::Output;
use crate::render::table::Table;

pub fn run(args: &Step, target: &Target, output: &Output) -> Result<(), Failure> {
    let mut args = args.clone();
    let (from, to) = &mut args.velocity;
    axis::in_motor_units(target, [from, to].into_iter().chain(&mut args.limit), output)?;
    let mut wanted = wanted(&args)?;
    // what cannot be written or compared with is found before anything moves
    let mut recorder = Recorder::of(args.output.as_deref())?;
    args.plot.as_deref().map(check_plot).transpose()?;
    let before = args.before.as_deref().map(EarlierStep::read).transpose()?;
    if let Some(before) = before.as_ref().filter(|_| wanted.run.frequency.is_none()) {
        before.check_same(&wanted)?;
    }
    let (stepped, recorded) = recorder.moving(target, output, |(session, drive), observer| {
        wanted = wanted.in_rpm(session, drive, observer).wait()?;
        match before
            .as_ref()
            .map_or(Ok(()), |before| before.check_same(&wanted))
        {
            Ok(()) => motion::step(session, drive, &wanted, observer).wait().map(Ok),
            Err(error) => Ok(Err(error)),
        }
    })?;
    let stepped = stepped?;
    let unit = wanted.run.unit.symbol();
    let points = stepped.points();
    let earlier = before.as_ref().map(EarlierStep::points);
    let drawn = args
        .plot
        .as_deref()
        .map(|plot| (plot, plot_of(plot, &points, earlier, unit, &stepped)));
    let compared = before.as_ref().and_then(|before| before.response(wanted.band));
    let file = recorder.file().filter(|_| recorded.is_ok());
    let files = [file, written(drawn.as_ref())];
    let report = StepReport::new(&stepped, &wanted, compared, files);
    output.json_report(&report);
    if !output.json() {
        show(&report, unit, stepped.resolution, output);
    }
    // the figures are there whatever became of the files
    recorded.and(drawn.map_or(Ok(()), |(_, result)| result))
}

/// The name of a file that was written.
fn written<E>(file: Option<&(&Path, Result<(), E>)>) -> Option<String> {
    let (file, _) = file.filter(|(_, result)| result.is_ok())?;
    Some(file.display().to_string())
}

fn plot_of(
    file: &Path,
    points: &[StepPoint],
    before: Option<&[StepPoint]>,
    unit: &str,
    stepped: &Stepped,
) -> Result<(), Failure> {
    let mut steps = Vec::new();
    if let Some(before) = before {
        steps.push(("before:", before));
    }
    steps.push((stepped.drive.as_str(), points));
    draw(
        file,
        &format!("step of {}", stepped.drive),
        &overlay(&steps, unit),
        &[],
    )
}

/// The requested step, in one unit.
fn wanted(args: &Step) -> Result<motion::Step, Failure> {
    let (from, to) = &args.velocity;
    let step = motion::Step::of(from, to, args.limit.as_ref())?;
    let wanted = motion::Step {
        run: motion::Run {
            time: Some(args.time),
            control: axis::in_mode(&args.control)?,
            ..step.run
        },
        band: axis::in_unit(&args.band, "%", "--band")? / 100.0,
        ..step
    };
    wanted.check()?;
    Ok(wanted)
}

fn show(report: &StepReport, unit: &str, resolution: Duration, output: &Output) {
    let Some(response) = &report.response else {
        output.warn("no figures: the telegram carries no speed, or no sample of the step arrived");
        return;
    };
    let mut head = vec!["", "step"];
    if report.before.is_some() {
        head.push("before");
    }
    let mut table = Table::new(&head);
    for name in FIGURES {
        let columns = [Some(response), report.before.as_ref()].into_iter().flatten();
        let values = columns.map(|one| figure(name, one, unit));
        let title = match name {
            "settled" => format!("settled within {} %", response.band),
            name => name.to_owned(),
        };
        table.row(std::iter::once(title).chain(values));
    }
    output.table(&table);
    let missed = match report.missed {
        0 => String::new(),
        1 => "; 1 cycle was missed".to_owned(),
        count => format!("; {count} cycles were missed"),
    };
    output.say(&format!("times are exact to ± {}{missed}", lasting(resolution)));
}

const FIGURES: [&str; 5] = [
    "rise time, 10 % to 90 %",
    "overshoot",
    "settled",
    "greatest following error",
    "steady error",
];

/// Returns one of the [`FIGURES`] in words.
fn figure(name: &str, of: &Response, unit: &str) -> String {
    let seconds = |time: Option<f64>| {
        let time = time.and_then(|time| Duration::try_from_secs_f64(time).ok());
        time.map_or_else(|| "not reached".to_owned(), lasting)
    };
    match name {
        "overshoot" => format!("{:.1} %", of.overshoot),
        "settled" => seconds(of.settling_time),
        "greatest following error" => format!("{:.1} {unit}", of.following_error),
        "steady error" => format!("{:.2} {unit}", of.steady_error),
        _ => seconds(of.rise_time),
    }
}
