//! Arguments of the commands that move an axis.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use profidrive::motion::TelegramName;
use profile::notation::Quantity;

use super::duration;

#[derive(Debug, Clone, Args)]
pub struct Cyclic {
    /// Update time of the cyclic connection; at least 16 ms when left out, as the drive allows it
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub cycle: Option<Duration>,
    /// Update times without data after which both sides stop, together at most 1.92 s; at least 100 ms when left out, for a
    /// connection that commands nothing 1.92 s
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=255))]
    pub watchdog: Option<u16>,
}

/// Options of commands that move an axis.
#[derive(Debug, Clone, Args)]
pub struct Recorded {
    /// Record every cyclic sample of the motion to this file: .csv, .arrows, .arrow or .parquet. No file is replaced
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,
}

/// Options of commands that enable an axis.
#[derive(Debug, Clone, Args)]
pub struct Enabling {
    /// Move a drive that may run on when this program is killed or the line breaks, because a setting of the drive says so
    /// (VLT 8-04, Vacon ID 733); without it the command refuses such a drive
    #[arg(long)]
    pub may_run_on: bool,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

/// Options of commands that need the drive in one mode.
#[derive(Debug, Clone, Args)]
pub struct InMode {
    /// Put the drive into the mode this needs (PNU 930) and put mode and telegram (PNU 922) back afterwards; without it
    /// the command refuses a drive in another mode
    #[arg(long)]
    pub set_mode: bool,
    #[command(flatten)]
    pub enabling: Enabling,
}

#[derive(Debug, Clone, Args)]
pub struct Ack {
    /// By a parameter (DRV.CLRFAULTS) instead of the control word: takes no control, works beside a controller
    #[arg(long, conflicts_with_all = ["cycle", "watchdog"])]
    pub by_parameter: bool,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

#[derive(Debug, Clone, Args)]
pub struct Run {
    /// Speed: 60rpm, -1rps, 20% of the reference of the drive, or 25Hz of a frequency converter; a bare number is in rpm
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub velocity: Quantity,
    /// What 100 % of the reference is, for a drive that does not report it: 1500rpm
    #[arg(long, value_name = "SPEED")]
    pub reference_speed: Option<Quantity>,
    /// Telegram to connect with: its number as in PNU 922, or ppo1 to ppo8 of a VLT; left out it is the one that the drive
    /// reports if that carries a speed, else telegram 1
    #[arg(long, value_name = "NUMBER|ppoN", value_parser = telegram)]
    pub telegram: Option<TelegramName>,
    /// How long to run at the speed, counted from when it is reached; until Ctrl-C when left out
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub time: Option<Duration>,
    /// Refuse any speed above this [default: 3000rpm, or 100% for a speed in percent]
    #[arg(long, value_name = "SPEED")]
    pub limit: Option<Quantity>,
    /// Check and show, but take no control and move nothing
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    pub recorded: Recorded,
    #[command(flatten)]
    pub control: InMode,
}

#[derive(Debug, Clone, Args)]
pub struct Jog {
    /// Which jog setpoint of the drive: 1 (STW1 bit 8) or 2 (bit 9)
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=2))]
    pub jog: u8,
    /// Set the jog speed for this command: 60rpm, or 5Hz of a frequency converter; the drive's own value when left out
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub velocity: Option<Quantity>,
    /// Jog at --velocity itself by real-time jogging (STW1 bits 12 and 13, position mode, telegram 9, 352 or 353): no
    /// parameter of the drive is changed
    #[arg(long, requires = "velocity", conflicts_with = "jog")]
    pub real_time: bool,
    /// How long to jog
    #[arg(long = "for", value_name = "TIME", default_value = "2s", value_parser = duration)]
    pub time: Duration,
    /// Refuse any speed above this
    #[arg(long, value_name = "SPEED", default_value = "3000rpm")]
    pub limit: Quantity,
    /// Check and show, but take no control and move nothing
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    pub recorded: Recorded,
    #[command(flatten)]
    pub control: Enabling,
}

#[derive(Debug, Clone, Args)]
pub struct Home {
    /// Stop if homing takes longer
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration)]
    pub timeout: Duration,
    #[command(flatten)]
    pub recorded: Recorded,
    #[command(flatten)]
    pub control: InMode,
}

#[derive(Debug, Clone, Args)]
pub struct Move {
    /// Where to: 10rev, -90deg, 655360 (counts), or 120mm where the machine file has the pitch; with --relative how far
    #[arg(long, value_name = "POSITION", allow_hyphen_values = true)]
    pub to: Quantity,
    /// The position is a distance from where the axis is
    #[arg(long)]
    pub relative: bool,
    /// Speed: 300rpm, 5rps, 50mm/s; a bare number is in rpm
    #[arg(long, value_name = "SPEED")]
    pub velocity: Quantity,
    /// Acceleration: 3000rpm/s, 100mm/s2; DRV.ACC of the drive when left out
    #[arg(long, value_name = "RAMP")]
    pub acceleration: Option<Quantity>,
    /// Deceleration; DRV.DEC of the drive when left out
    #[arg(long, value_name = "RAMP")]
    pub deceleration: Option<Quantity>,
    /// Refuse any speed above this
    #[arg(long, value_name = "SPEED", default_value = "3000rpm")]
    pub limit: Quantity,
    /// Stop if the target is not reached in this time; a multiple of the reckoned time when left out
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub timeout: Option<Duration>,
    /// Check and show, but move nothing
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    pub recorded: Recorded,
    #[command(flatten)]
    pub control: InMode,
}

#[derive(Debug, Clone, Args)]
pub struct Task {
    /// Number of the motion task in the table of the drive
    #[arg(value_name = "NUMBER", value_parser = clap::value_parser!(u16).range(1..=128))]
    pub number: u16,
    /// Stop if the task, or the last one of its chain, is not at its target in this time
    #[arg(long, value_name = "TIME", default_value = "60s", value_parser = duration)]
    pub timeout: Duration,
    #[command(flatten)]
    pub recorded: Recorded,
    #[command(flatten)]
    pub control: InMode,
}

#[derive(Debug, Clone, Args)]
pub struct Stop {
    /// Switch the power stage off too (AKD: DRV.DIS; all others are always switched off); its controller needs OFF and ON
    /// afterwards
    #[arg(long)]
    pub disable: bool,
    /// How long the axis may take to come to rest. A drive that is taken over gets this beside the time of its ramp, as far as
    /// it reports that; then it is stopped by the quick stop (OFF3)
    #[arg(long, value_name = "TIME", default_value = "10s", value_parser = duration)]
    pub timeout: Duration,
}

fn telegram(text: &str) -> Result<TelegramName, &'static str> {
    let lower = text.to_ascii_lowercase();
    match lower.strip_prefix("ppo") {
        Some(number) => {
            let number = number.parse().ok();
            let number = number.filter(|number| (1..=8).contains(number));
            number.map(TelegramName::Ppo).ok_or("PPO types are ppo1 to ppo8")
        }
        None => text
            .parse()
            .map(TelegramName::Number)
            .map_err(|_| "a number as in PNU 922, or ppo1 to ppo8"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_describes_what_the_timeout_bounds() {
        let help = Stop::augment_args(clap::Command::new("stop"))
            .render_long_help()
            .to_string();
        let words: Vec<&str> = help.split_whitespace().collect();
        let text = words.join(" ");
        assert!(
            text.contains("beside the time of its ramp") && text.contains("quick stop"),
            "{text}"
        );
    }
}
