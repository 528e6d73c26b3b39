//! Recordings.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use profidrive::recording::{Rotation, Trigger};

use super::{Cyclic, duration};

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
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Begin the next file after this time (1h) or size (100MB): NAME-0001.csv, NAME-0002.csv, ..
    #[arg(long, value_name = "TIME|SIZE", value_parser = rotation)]
    pub rotate: Option<Rotation>,
    #[command(flatten)]
    pub cyclic: Cyclic,
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
    for (unit, octets) in [("kB", 1e3), ("MB", 1e6), ("GB", 1e9)] {
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
