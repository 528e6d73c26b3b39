//! What differs between systems: modes, links that are not followed, owners.

use std::fs::{DirBuilder, File, Metadata, OpenOptions};
use std::io;
use std::path::Path;

#[cfg(unix)]
mod os {
    use std::os::unix::fs::{DirBuilderExt, MetadataExt, OpenOptionsExt};

    use super::{DirBuilder, Metadata, OpenOptions, io};

    pub fn set_mode(options: &mut OpenOptions, mode: u32) {
        options.mode(mode);
    }

    pub fn set_folder_mode(builder: &mut DirBuilder, mode: u32) {
        builder.mode(mode);
    }

    /// Opening fails at a link, and does not wait for whoever writes into a pipe.
    pub fn refuse_links(options: &mut OpenOptions) {
        options.custom_flags(libc::O_NOFOLLOW | libc::O_NONBLOCK);
    }

    pub fn was_link(error: &io::Error) -> bool {
        error.raw_os_error() == Some(libc::ELOOP)
    }

    pub fn is_shared(folder: &Metadata) -> bool {
        folder.mode() & 0o022 != 0
    }

    /// Returns true for two looks at one file.
    pub fn is_same(one: &Metadata, other: &Metadata) -> bool {
        (one.dev(), one.ino()) == (other.dev(), other.ino())
    }

    /// Returns true for a file of this user that has no other name.
    pub fn is_own(file: &Metadata) -> io::Result<bool> {
        let exclusive = !file.is_file() || file.nlink() == 1;
        // the owner of its entry in /proc is the user this program runs as
        #[cfg(target_os = "linux")]
        let exclusive = exclusive && file.uid() == std::fs::metadata("/proc/self")?.uid();
        Ok(exclusive)
    }
}

#[cfg(not(unix))]
mod os {
    use super::{DirBuilder, Metadata, OpenOptions, io};

    pub fn set_mode(_options: &mut OpenOptions, _mode: u32) {}

    pub fn set_folder_mode(_builder: &mut DirBuilder, _mode: u32) {}

    /// Links require a permission of their own on this system, so they are not checked.
    pub fn refuse_links(_options: &mut OpenOptions) {}

    pub fn was_link(_error: &io::Error) -> bool {
        false
    }

    pub fn is_shared(_folder: &Metadata) -> bool {
        false
    }

    /// Returns whether a file that is open keeps its name there.
    pub fn is_same(_one: &Metadata, _other: &Metadata) -> bool {
        true
    }

    #[expect(clippy::unnecessary_wraps, reason = "as on other systems")]
    pub fn is_own(_file: &Metadata) -> io::Result<bool> {
        Ok(true)
    }
}

pub(super) use os::{is_own, is_shared, was_link};
pub(crate) use os::{is_same, refuse_links, set_folder_mode, set_mode};

/// Returns once the names in a folder are on the disk, where folders can be opened.
pub(super) fn flush_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) {
        File::open(folder)?.sync_all()
    } else {
        Ok(())
    }
}
