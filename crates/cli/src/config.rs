//! The configuration of a user: the interface and colours. Limits, units, groups and names belong to a machine and stand in its
//! file.

use std::path::{Path, PathBuf};

use client::ErrorKind;
use serde::Deserialize;

use crate::failure::Failure;
use crate::output::Colours;

/// What the configuration file has. Options and variables of the environment come first.
#[derive(Debug, Clone, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Network interface towards the drives.
    pub interface: Option<String>,
    /// Whether output has colours.
    #[serde(default, rename = "color")]
    pub colours: Colours,
}

impl Config {
    /// Reads the file that PROFIDRIVE_CONFIG names, else the one in the usual place, where there is one.
    pub fn read() -> Result<Self, Failure> {
        let variable = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
        let named = variable("PROFIDRIVE_CONFIG").map(PathBuf::from);
        let usual = || Some(folder(variable)?.join("profidrive").join("config.toml"));
        let required = named.is_some();
        let Some(path) = named.or_else(usual) else {
            return Ok(Self::default());
        };
        match std::fs::read_to_string(&path) {
            Ok(text) => Self::parse(&text, &path),
            // that of another user, whose HOME this is, is as good as none
            Err(error)
                if !required
                    && matches!(
                        error.kind(),
                        std::io::ErrorKind::NotFound | std::io::ErrorKind::PermissionDenied
                    ) =>
            {
                Ok(Self::default())
            }
            Err(error) => Err(Failure::new(
                ErrorKind::Local,
                format!("cannot read the configuration {}: {error}", path.display()),
            )),
        }
    }

    fn parse(text: &str, path: &Path) -> Result<Self, Failure> {
        toml::from_str(text).map_err(|error| {
            let begin = error.span().and_then(|span| text.get(..span.start));
            let line = begin.map_or(1, |begin| begin.matches('\n').count() + 1);
            let message = error.message().trim_end();
            Failure::usage(format!("{}, line {line}: {message}", path.display()))
                .hint("the configuration has `interface` and `color` (auto, always, never)")
        })
    }
}

/// The folder for configurations of this user.
fn folder(variable: impl Fn(&str) -> Option<std::ffi::OsString>) -> Option<PathBuf> {
    let path = |name| {
        variable(name)
            .map(PathBuf::from)
            .filter(|path| path.is_absolute())
    };
    if cfg!(windows) {
        return path("APPDATA");
    }
    path("XDG_CONFIG_HOME").or_else(|| {
        let usual = if cfg!(target_os = "macos") {
            "Library/Application Support"
        } else {
            ".config"
        };
        Some(path("HOME")?.join(usual))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Config, Failure> {
        Config::parse(text, Path::new("config.toml"))
    }

    #[test]
    fn a_configuration_has_two_keys_and_says_where_it_is_wrong() {
        assert_eq!(parse(""), Ok(Config::default()));
        let whole = Config {
            interface: Some("eth1".into()),
            colours: Colours::Never,
        };
        assert_eq!(parse("interface = \"eth1\"\ncolor = \"never\"\n"), Ok(whole));
        for (text, words) in [
            (
                "\n\nmax-speed = 3",
                "config.toml, line 3: unknown field `max-speed`",
            ),
            ("color = \"blue\"", "config.toml, line 1: unknown variant `blue`"),
            ("interface = 3", "config.toml, line 1: invalid type"),
            ("color", "config.toml, line 1: "),
        ] {
            let failure = parse(text).unwrap_err();
            assert!(failure.message.starts_with(words), "{text}: {}", failure.message);
            assert_eq!(failure.kind, ErrorKind::Usage);
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_folder_is_that_of_the_desktop_rules() {
        let of = |set: &'static [(&'static str, &'static str)]| {
            folder(|name| {
                let found = set.iter().find(|(known, _)| *known == name);
                found.map(|(_, value)| (*value).into())
            })
        };
        let path = |text| Some(PathBuf::from(text));
        assert_eq!(of(&[("XDG_CONFIG_HOME", "/c"), ("HOME", "/h")]), path("/c"));
        assert_eq!(
            of(&[("XDG_CONFIG_HOME", "relative"), ("HOME", "/h")]),
            path("/h/.config")
        );
        assert_eq!(of(&[]), None);
    }
}
