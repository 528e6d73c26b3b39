//! The stations of the last search, for the completion of their names: a small file that only completion reads.

use std::path::PathBuf;

use network::files::StateFile;
use profidrive::report::Station;

/// Stations that are kept.
const MOST: usize = 1000;

/// A station of the last search.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Known {
    /// Its name.
    pub name: String,
    /// The key of its model, where it has tables.
    pub model: Option<String>,
}

/// Keeps who answered. A cache that cannot be written is none.
pub fn remember<'s>(stations: impl IntoIterator<Item = &'s Station>) {
    let Some(file) = file() else { return };
    let text = text(stations);
    if !text.is_empty() {
        let _ = file.replace(text.as_bytes());
    }
}

/// Returns who answered to the last search.
pub fn known() -> Vec<Known> {
    let content = file().and_then(|file| file.read().ok().flatten());
    content.map_or_else(Vec::new, |content| read(&String::from_utf8_lossy(&content)))
}

/// A line for each station with a name: its name, and its model.
fn text<'s>(stations: impl IntoIterator<Item = &'s Station>) -> String {
    let line = |station: &Station| {
        let name = station.name.as_ref().filter(|name| is_name(name))?;
        Some(format!(
            "{name} {}\n",
            station.model.unwrap_or_default().to_lowercase()
        ))
    };
    stations.into_iter().filter_map(line).take(MOST).collect()
}

fn read(text: &str) -> Vec<Known> {
    let known = |line: &str| {
        let (name, model) = line.split_once(' ')?;
        is_name(name).then(|| Known {
            name: name.to_owned(),
            model: Some(model.to_owned()).filter(|model| !model.is_empty()),
        })
    };
    text.lines().filter_map(known).take(MOST).collect()
}

/// Only what a shell takes as one plain word.
fn is_name(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '.';
    !name.is_empty() && name.len() <= 240 && name.chars().all(plain)
}

fn file() -> Option<StateFile> {
    let variable = |name| {
        std::env::var_os(name)
            .map(PathBuf::from)
            .filter(|path| path.is_absolute())
    };
    let folder = if cfg!(windows) {
        variable("LOCALAPPDATA")
    } else {
        variable("XDG_CACHE_HOME").or_else(|| {
            let usual = if cfg!(target_os = "macos") {
                "Library/Caches"
            } else {
                ".cache"
            };
            Some(variable("HOME")?.join(usual))
        })
    };
    Some(StateFile::new(folder?.join("profidrive").join("stations")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_is_read_again_and_hostile_names_are_not_kept() {
        let station = |name: &str| Station {
            name: Some(name.to_owned()),
            ..Station::from(&profinet::controller::Station::default())
        };
        let stations = ["akd-1", "$(reboot)", "a b", "line.feed-2", ""].map(station);
        let read = read(&text(&stations));
        let names: Vec<&str> = read.iter().map(|known| known.name.as_str()).collect();
        assert_eq!(names, ["akd-1", "line.feed-2"]);
        let many: Vec<Station> = (0..2000).map(|n| station(&format!("akd-{n}"))).collect();
        assert_eq!(super::read(&text(&many)).len(), MOST);
        assert_eq!(super::read("a;b vlt\n\u{1b}[2J x\n"), []);
    }
}
