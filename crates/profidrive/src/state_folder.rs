//! Where this library and its front ends keep what outlives them.

use std::path::PathBuf;

/// Returns the folder for what outlives a program of this user: `$XDG_STATE_HOME/profidrive`, else `~/.local/state/profidrive`.
/// `None` where the environment names no absolute folder. It may not exist yet.
#[must_use]
pub fn state_folder() -> Option<PathBuf> {
    let variable = |name| {
        std::env::var_os(name)
            .map(PathBuf::from)
            .filter(|path| path.is_absolute())
    };
    let state = variable("XDG_STATE_HOME").or_else(|| Some(variable("HOME")?.join(".local/state")));
    Some(state?.join("profidrive"))
}
