//! Recordings.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use profidrive::recording::{Rotation, Trigger};
use profile::notation::Quantity;

use super::{Cyclic, InMode, duration};

#[derive(Debug, Args)]
pub struct Record {
    /// Parameters; with `--every cycle` signals of the telegram (ZSW1, NIST_A), or all
    #[arg(value_name = "SIGNAL", required = true)]
    pub signals: Vec<String>,
    /// Time between two readings, 10 ms or longer, or `cycle`: every cyclic signal with each cycle, by a connection that commands
    /// nothing. It is opened only to drives without a controller whose power stage is off
    #[arg(long, value_name = "TIME|cycle", default_value = "100ms", value_parser = every)]
    pub every: Every,
    /// How long to record, from the start or the trigger; until Ctrl-C when left out
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub time: Option<Duration>,
    /// Record from this event on: fault, warning, gap, or a comparison such as 'NIST_A>60rpm' that becomes true
    #[arg(long, value_name = "EVENT")]
    pub trigger: Option<Trigger>,
    /// Also record so much of the time before the trigger
    #[arg(long, value_name = "TIME", value_parser = duration, requires = "trigger")]
    pub pre: Option<Duration>,
    /// File to write: .csv, .arrows (Arrow stream), .arrow (Arrow file), .parquet; `-` prints CSV. No file is replaced
    #[arg(short, long, value_name = "FILE", required_unless_present = "live")]
    pub output: Option<PathBuf>,
    /// Draw the signals on the terminal while they are recorded; q ends, + and - change the window. Works without -o too
    #[arg(long)]
    pub live: bool,
    /// Begin the next file after this time (1h) or size (100MB): NAME-0001.csv, NAME-0002.csv, ..
    #[arg(long, value_name = "TIME|SIZE", value_parser = rotation, requires = "output")]
    pub rotate: Option<Rotation>,
    /// Also draw the signals: .svg, or .html (interactive)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

#[derive(Debug, Clone, Args)]
pub struct Step {
    /// Speed before the step and speed of the step: 0:300rpm, -60rpm:60rpm, 0:25Hz of a frequency converter; a bare number has the
    /// unit of the other one, or rpm
    #[arg(long, value_name = "FROM:TO", allow_hyphen_values = true, value_parser = speeds)]
    pub velocity: (Quantity, Quantity),
    /// How long the speed of the step is commanded, at most 60 s
    #[arg(long = "for", value_name = "TIME", default_value = "1s", value_parser = duration)]
    pub time: Duration,
    /// The speed has settled once it stays this near to the new one: a share of the step
    #[arg(long, value_name = "SHARE", default_value = "2%")]
    pub band: Quantity,
    /// File to write every sample to: .csv, .arrows, .arrow or .parquet. It is created before the axis moves
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the step: .svg, or .html (interactive)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Compare with a step of the same speeds that was recorded before to a CSV file: figures, and drawn below this one
    #[arg(long, value_name = "FILE")]
    pub before: Option<PathBuf>,
    /// Refuse any speed above this [default: 3000rpm, or 100% for speeds in percent]
    #[arg(long, value_name = "SPEED")]
    pub limit: Option<Quantity>,
    #[command(flatten)]
    pub control: InMode,
}

fn speeds(text: &str) -> Result<(Quantity, Quantity), String> {
    let wrong = || format!("`{text}` is not FROM:TO, such as 0:300rpm");
    let (from, to) = text.split_once(':').ok_or_else(wrong)?;
    let parse = |text: &str| text.parse::<Quantity>().map_err(|error| error.to_string());
    let (mut from, mut to) = (parse(from)?, parse(to)?);
    let unit = to.unit.clone().or_else(|| from.unit.clone());
    from.unit = from.unit.or_else(|| unit.clone());
    to.unit = to.unit.or(unit);
    Ok((from, to))
}

/// When there are values.
#[derive(Debug, Clone, Copy)]
pub enum Every {
    Cycle,
    Interval(Duration),
}

fn every(text: &str) -> Result<Every, String> {
    if text == "cycle" {
        return Ok(Every::Cycle);
    }
    duration(text).map(Every::Interval)
}

/// The least size of a file, and the shortest time.
const LEAST_OCTETS: u64 = 10_000;
const LEAST_TIME: Duration = Duration::from_secs(1);

fn rotation(text: &str) -> Result<Rotation, String> {
    for (unit, octets) in [("kB", 1e3), ("KB", 1e3), ("MB", 1e6), ("GB", 1e9)] {
        let Some(number) = text.strip_suffix(unit) else {
            continue;
        };
        let number: f64 = number
            .trim()
            .parse()
            .map_err(|_| format!("`{text}` is not a size"))?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "saturates, and is checked below"
        )]
        let size = (number * octets) as u64;
        return if size < LEAST_OCTETS {
            Err("a file has 10 kB or more".to_owned())
        } else {
            Ok(Rotation::Octets(size))
        };
    }
    let time = duration(text).map_err(|error| format!("{error}; a size is 500kB, 100MB or 2GB"))?;
    if time < LEAST_TIME {
        return Err("a file lasts 1 s or longer".to_owned());
    }
    Ok(Rotation::Time(time))
}
