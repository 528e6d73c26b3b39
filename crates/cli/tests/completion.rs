//! Completion as a shell has it: the script is read by bash, which calls the program. And the configuration of a user.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder that goes with the test, with a cache of stations, a machine file and a configuration.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("profidrive-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(path.join("profidrive")).unwrap();
        std::fs::write(
            path.join("profidrive/stations"),
            "akd-1 akd\nakd-2 akd\nvlt-1 vlt\n",
        )
        .unwrap();
        let machine = "[[drive]]\nname = \"feed\"\nmodel = \"akd\"\ngroups = [\"line1\"]\n";
        std::fs::write(path.join("machine.toml"), machine).unwrap();
        Self(path)
    }

    /// The program with the folders of a user here, and no other environment.
    fn program(&self, program: impl AsRef<Path>) -> Command {
        let bin = Path::new(env!("CARGO_BIN_EXE_profidrive")).parent().unwrap();
        let mut command = Command::new(program.as_ref());
        command
            .env_clear()
            .env("PATH", format!("{}:/usr/bin:/bin", bin.display()))
            .env("XDG_CACHE_HOME", &self.0)
            .env("XDG_CONFIG_HOME", &self.0)
            .current_dir(&self.0);
        command
    }

    /// What bash offers for the last word of a line.
    fn offered(&self, words: &[&str]) -> Vec<String> {
        let quoted: Vec<String> = words.iter().map(|word| format!("'{word}'")).collect();
        let last = words.len() - 1;
        let script = format!(
            "eval \"$(profidrive completions bash)\"\nCOMP_WORDS=({})\nCOMP_CWORD={last}\nCOMP_TYPE=9\n\
             _clap_complete_profidrive profidrive '{}' ''\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"",
            quoted.join(" "),
            words[last]
        );
        let output = self.program("bash").args(["-c", &script]).output().unwrap();
        assert!(output.status.success(), "{output:?}");
        let text = String::from_utf8(output.stdout).unwrap();
        text.lines()
            .filter(|line| !line.is_empty())
            .map(str::to_owned)
            .collect()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn a_shell_offers_commands_drives_parameters_and_faults() {
    let folder = Folder::new("completion");
    for (line, expected) in [
        (&["profidrive", "sca"][..], &["scan"][..]),
        (&["profidrive", "read", "akd"], &["akd-1", "akd-2"]),
        (&["profidrive", "read", "akd-1,v"], &["akd-1,vlt-1"]),
        (&["profidrive", "status", "@"], &["@line1"]),
        (&["profidrive", "stop", "al"], &["all"]),
        (&["profidrive", "stop", "fe"], &["feed"]),
        (&["profidrive", "decode", "--only", "t"], &["trouble"]),
        (&["profidrive", "read", "akd-1", "DRV.ACC"], &["DRV.ACC"]),
        (&["profidrive", "read", "vlt-1", "3-41"], &["3-41"]),
        (&["profidrive", "read", "vlt-1", "DRV."], &[]),
        (
            &["profidrive", "write", "vlt-1", "max-speed-"],
            &["max-speed-backward"],
        ),
        (&["profidrive", "record", "akd-1", "nist_b"], &["NIST_B"]),
        (&["profidrive", "read", "vlt-1", "--"], &[]),
    ] {
        let offered = folder.offered(line);
        if expected.is_empty() {
            assert!(
                !offered.iter().any(|one| one.contains("DRV")),
                "{line:?}: {offered:?}"
            );
        } else {
            assert_eq!(offered, expected, "{line:?}");
        }
    }
    let faults = folder.offered(&["profidrive", "explain", "--model", "akd", "70"]);
    assert!(faults.contains(&"702".to_owned()), "{faults:?}");
}

#[test]
fn a_machine_file_that_is_not_valid_keeps_no_drive_from_being_completed() {
    let folder = Folder::new("completion-broken");
    std::fs::write(folder.0.join("machine.toml"), "not = [valid").unwrap();
    assert_eq!(folder.offered(&["profidrive", "read", "akd"]), ["akd-1", "akd-2"]);
    std::fs::write(folder.0.join("profidrive/stations"), [0xFF; 100]).unwrap();
    assert!(folder.offered(&["profidrive", "read", "akd"]).is_empty());
}

#[test]
fn the_configuration_names_the_interface_and_colours_and_nothing_else() {
    let folder = Folder::new("configuration");
    let file = folder.0.join("profidrive/config.toml");
    let run = |arguments: &[&str], variables: &[(&str, &str)]| {
        let mut command = folder.program(env!("CARGO_BIN_EXE_profidrive"));
        let output = command
            .args(arguments)
            .envs(variables.iter().copied())
            .output()
            .unwrap();
        let text = |octets: &[u8]| String::from_utf8_lossy(octets).into_owned();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    std::fs::write(&file, "interface = \"no-such-9\"\ncolor = \"always\"\n").unwrap();
    let (code, _, err) = run(&["scan"], &[]);
    assert!(
        code == Some(4) && err.contains("no network interface `no-such-9`"),
        "{err}"
    );
    let words = "the interface `no-such-9` is from the configuration file";
    assert!(err.contains(words), "{err}");
    for (arguments, variables) in [
        (&["scan", "-i", "no-such-8"][..], &[][..]),
        (&["scan"], &[("PROFIDRIVE_INTERFACE", "no-such-8")]),
    ] {
        let (_, _, err) = run(arguments, variables);
        assert!(err.contains("no network interface `no-such-8`"), "{err}");
        assert!(!err.contains("configuration file"), "{err}");
    }
    let coloured = ["explain", "0x047F", "--as", "stw1"];
    let decode = ["decode", "--hex", "047F0000", "--telegram", "1"];
    let colours = |variables: &[(&str, &str)]| {
        let all = [
            run(&coloured, variables),
            run(&decode, variables),
            run(&["scan"], variables),
        ];
        all.iter()
            .any(|(_, out, err)| out.contains('\u{1b}') || err.contains('\u{1b}'))
    };
    assert!(colours(&[]));
    assert!(!colours(&[("NO_COLOR", "1")]));

    std::fs::write(&file, "interface = \"eth0\"\nmax-speed = \"300rpm\"\n").unwrap();
    let (code, _, err) = run(&coloured, &[]);
    assert_eq!(code, Some(2), "{err}");
    assert!(
        err.contains("config.toml, line 2: unknown field `max-speed`"),
        "{err}"
    );
    // a drive can be stopped all the same
    let (_, _, err) = run(&["stop", "akd-1", "-i", "no-such-8"], &[]);
    assert!(err.contains("warning: ") && err.contains("no-such-8"), "{err}");

    let (code, _, err) = run(&coloured, &[("PROFIDRIVE_CONFIG", "/no/such/file.toml")]);
    assert!(code == Some(1) && err.contains("/no/such/file.toml"), "{err}");
    let other = folder.0.join("other.toml");
    std::fs::write(&other, "").unwrap();
    let (code, ..) = run(&coloured, &[("PROFIDRIVE_CONFIG", other.to_str().unwrap())]);
    assert_eq!(code, Some(0));
}
