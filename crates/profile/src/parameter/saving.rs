//! Changes that are acknowledged when the value is in non-volatile memory.

use super::access::{ParameterAccess, SaveId};
use super::address::HEADER;
use super::block::{BlockWriter, ValueBlock};
use super::dialect::Dialect;
use super::format::Format;
use super::serve::{Refusal, serve_each};

/// A response block, and the save that it waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Served {
    /// Octets of the response block.
    pub length: usize,
    /// Set when the response counts only after a save: withhold it until the save has ended. If the save fails, the
    /// response is that of [`not_saved`].
    pub save: Option<SavingChange>,
}

/// A change that has started a save.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SavingChange {
    /// The save.
    pub save: SaveId,
    /// One bit for each parameter of the request that is saved, the lowest for the first.
    parameters: u64,
}

/// Writes the response to a change whose save has failed into `out` and returns its length: as `response`, but the
/// parameters that were to be saved are refused with [`Dialect::not_saved`].
#[must_use]
pub fn not_saved(response: &[u8], change: SavingChange, dialect: &Dialect, out: &mut [u8]) -> usize {
    let Some((&[reference, id, axis, parameters], mut rest)) = response.split_first_chunk::<HEADER>() else {
        return 0;
    };
    let mut written = BlockWriter::new(out);
    let [high, low] = dialect.not_saved.0.to_be_bytes();
    let all_changed = id & 0x80 == 0;
    let mut complete = written.put(&[reference, id | 0x80, axis, parameters]);
    for parameter in 0..parameters {
        let answer = match ValueBlock::parse(rest, 0, dialect.code_space) {
            Ok((_, used)) if !all_changed => {
                let (answer, after) = rest.split_at_checked(used).unwrap_or((rest, &[]));
                rest = after;
                answer
            }
            _ => &[Format::ZERO.0, 0],
        };
        let saved = change.parameters.checked_shr(parameter.into()).unwrap_or(0) & 1 == 1;
        let answer = if saved {
            &[Format::ERROR.0, 1, high, low]
        } else {
            answer
        };
        complete = complete.and_then(|()| written.put(answer));
    }
    complete.map_or(0, |()| written.position())
}

/// As [`serve`](super::serve()), for a drive that acknowledges a saved value when it is in non-volatile memory.
///
/// # Errors
/// As [`serve`](super::serve()).
pub fn serve_saving(
    request: &[u8],
    dialect: &Dialect,
    drive: &mut (impl ParameterAccess + ?Sized),
    out: &mut [u8],
) -> Result<Served, Refusal> {
    // saves of other channels are theirs to wait for
    let _ = drive.started_save();
    let (mut save, mut parameters) = (None, 0_u64);
    let length = serve_each(request, dialect, drive, out, |drive, parameter, answer| {
        if let Some(started) = drive.started_save() {
            save = Some(started);
            parameters |= u64::from(answer.is_ok()).checked_shl(parameter).unwrap_or(0);
        }
    })?;
    Ok(Served {
        length,
        save: save.map(|save| SavingChange { save, parameters }),
    })
}
