//! `profidrive run`

use std::time::Duration;

use clap::Args;
use drive_client::axis::Purpose;
use profidrive::notation::Quantity;
use profidrive::state::Mode;

use super::axis::{self, End, SetMode};
use crate::args::{Cyclic, Interface, duration};
use crate::connect::{self, Need};
use crate::failure::Failure;
use crate::output::Output;

#[derive(Debug, Args)]
pub struct Run {
    /// Station name, IP address or MAC address
    pub drive: String,
    /// Speed: 60rpm, -1rps; a bare number is in rpm
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub velocity: Quantity,
    /// How long to run at the speed; until Ctrl-C when left out
    #[arg(long = "for", value_name = "TIME", value_parser = duration)]
    pub time: Option<Duration>,
    /// Refuse any speed above this
    #[arg(long, value_name = "SPEED", default_value = "3000rpm")]
    pub limit: Quantity,
    #[command(flatten)]
    pub mode: SetMode,
    #[command(flatten)]
    pub cyclic: Cyclic,
}

pub fn run(args: &Run, interface: &Interface, output: &Output) -> Result<(), Failure> {
    let speed = axis::rpm(&args.velocity, "--velocity")?;
    let limit = axis::rpm(&args.limit, "--limit")?.abs();
    axis::within(speed, limit)?;
    axis::checked(&args.cyclic)?;
    let (mut session, mut drive) = connect::drive(interface, Need::Cyclic, &args.drive, output)?;
    let time = args.time.map_or_else(
        || "until Ctrl-C".into(),
        |time| format!("for {} s", time.as_secs_f64()),
    );
    let before = axis::enter_mode(&mut session, &mut drive, Mode::Velocity, &args.mode, output)?;
    output.say(&format!(
        "this moves the axis: {} turns at {speed} rpm {time}; Ctrl-C stops it",
        drive.label()
    ));
    let end = if args.time.is_some() { End::Time } else { End::Open };
    let settings = axis::settings(&args.cyclic, Purpose::Speed, limit);
    let result = match session.take_axis(&mut drive, settings) {
        Ok(mut taken) => {
            axis::watch(&mut taken, "run", output);
            let result = taken.enable().and_then(|mut enabled| {
                enabled.run(speed)?;
                enabled.hold(args.time.unwrap_or(axis::FOR_EVER))
            });
            axis::finish(taken, result, end, "run", serde_json::Map::new(), output)
        }
        Err(error) => Err(error),
    };
    axis::leave_mode(&mut session, &mut drive, before, output);
    result.map_err(|error| axis::explained(error, end, &mut session, &mut drive))?;
    Ok(session.close()?)
}
