//! Octets without their frame: what they are, and what they say.

use profile::model::Model;
use profile::pkw::PkwDialect;
use uss::Protocol;

use crate::job::{self, Decoded, JobDrive, NoJob, Side};

/// What octets are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A parameter job (base mode parameter access); without a side it is guessed.
    Job(Option<Side>),
    /// The eight octets of the parameter channel in a PPO.
    Pkw,
    /// The parameter channel of the Danfoss FC protocol, where the index stands elsewhere.
    PkwFc,
    /// The parameter channel of USS.
    PkwUss,
    /// A telegram of a serial line.
    Serial(Protocol),
    /// Cyclic data of the telegram with this number.
    Telegram(u16),
}

/// Octets that are not what they were taken for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NotDecoded {
    /// No parameter job.
    #[error(transparent)]
    Job(#[from] NoJob),
    /// No such telegram or parameter channel.
    #[error("this is no such telegram: {0}")]
    Telegram(String),
}

/// Decodes octets of a drive of this model; without a model those of the drive that usually sends them. `from_controller`
/// says who sent them, where that is known; `request` is what a response answers.
///
/// ```
/// use profidrive_dissect::octets::{self, Kind};
/// let told = octets::decode(Kind::Serial(uss::Protocol::Fc), &[0x02, 0x06, 0x81, 0x04, 0x7C, 0x20, 0x00, 0xDD], None, None, None)?;
/// assert!(told.lines[0].1.starts_with("FC telegram, address 0x81"));
/// # Ok::<(), octets::NotDecoded>(())
/// ```
///
/// # Errors
/// When the octets are no such thing.
pub fn decode(
    kind: Kind,
    octets: &[u8],
    model: Option<Model>,
    from_controller: Option<bool>,
    request: Option<&[u8]>,
) -> Result<Decoded, NotDecoded> {
    let drive = |usual: &str| {
        model
            .or_else(|| Model::by_name(usual))
            .map_or_else(JobDrive::default, JobDrive::new)
    };
    let channel = |usual, dialect: Option<&PkwDialect>| {
        let drive = drive(usual);
        let from_controller = from_controller.or(request.map(|_| false));
        job::pkw::decode(&drive, dialect.unwrap_or(drive.ppo()), octets, from_controller)
    };
    let decoded = match kind {
        Kind::Job(side) => return Ok(job::decode(&mut drive("akd"), octets, side, request)?),
        Kind::Pkw => channel("standard", None),
        Kind::PkwFc => channel("vlt", Some(&PkwDialect::DANFOSS_FC)),
        Kind::PkwUss => channel("standard", Some(&PkwDialect::SIEMENS_USS)),
        Kind::Serial(protocol) => {
            let usual = match protocol {
                Protocol::Fc => "vlt",
                Protocol::Uss => "standard",
            };
            job::serial::decode(&drive(usual), protocol, octets, from_controller)
        }
        Kind::Telegram(number) => {
            job::telegram::decode(&drive(model_with(number)), number, octets, from_controller)
        }
    };
    decoded.map_err(NotDecoded::Telegram)
}

/// The model that a telegram can only be from; an AKD where it is one of the profile or of several vendors.
fn model_with(telegram: u16) -> &'static str {
    let has = |name: &&&str| {
        let model = Model::by_name(name).map(JobDrive::new);
        model.is_some_and(|model| model.telegram(telegram).is_some())
    };
    let mut having = Model::NAMES.iter().filter(has);
    match (having.next(), having.next()) {
        (Some(only), None) => only,
        _ => "akd",
    }
}
