//! What `make package` hands out: complete, and a Debian package that can be installed and gives the program its capability.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use serde_json::Value;
use system_tests::{Lab, Side, built, root, simulate};

const SHORT: Duration = Duration::from_secs(60);

#[track_caller]
fn output(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let complaints = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {complaints}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Packs the program of this build into `folder` and gives the Debian package.
fn pack(folder: &Path) -> PathBuf {
    let target = format!("{}-unknown-linux-gnu", std::env::consts::ARCH);
    let mut pack = Command::new(root().join("tools/package"));
    output(pack.arg(built("profidrive")).arg(&target).arg(folder));
    output(
        Command::new("sha256sum")
            .args(["--check", "--strict", "SHA256SUMS"])
            .current_dir(folder),
    );
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    let [_, archive, package] = &files[..] else {
        panic!("checksums, archive and Debian package: {files:?}")
    };
    let listed = output(Command::new("tar").arg("-tf").arg(archive));
    for name in [
        "profidrive\n",
        "THIRD-PARTY\n",
        "profidrive.cdx.json\n",
        "man/profidrive-read.1\n",
        "completions/_profidrive\n",
    ] {
        assert!(listed.contains(name), "{name}: {listed}");
    }
    check_bill(archive, &target);
    package.clone()
}

fn from_archive(archive: &Path, target: &str, name: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let path = format!("profidrive-{version}-{target}/{name}");
    output(Command::new("tar").arg("-xOf").arg(archive).arg(path))
}

/// The bill of materials names what is linked: the packages whose licences are handed out, with the checksums that were
/// built, and every dependency of them.
fn check_bill(archive: &Path, target: &str) {
    let bill: Value = serde_json::from_str(&from_archive(archive, target, "profidrive.cdx.json")).unwrap();
    assert_eq!(
        (&bill["bomFormat"], &bill["specVersion"]),
        (&"CycloneDX".into(), &"1.5".into())
    );
    assert_eq!(bill["metadata"]["component"]["name"], "profidrive-cli");
    let list = |value: &Value| value.as_array().unwrap().clone();
    let components = list(&bill["components"]);
    let third_party = |component: &&Value| component.get("hashes").is_some();
    let mut billed: Vec<String> = components
        .iter()
        .filter(third_party)
        .map(|component| {
            let text = |name: &str| component[name].as_str().unwrap().to_owned();
            format!("{} {}", text("name"), text("version"))
        })
        .collect();
    let notices = from_archive(archive, target, "THIRD-PARTY");
    let listed = notices.lines().take_while(|line| !line.is_empty());
    let mut noticed: Vec<String> = listed
        .map(|line| line.split(':').next().unwrap().to_owned())
        .collect();
    billed.sort();
    noticed.sort();
    assert_eq!(billed, noticed);
    assert!(billed.len() > 20, "{billed:?}");

    let lock = std::fs::read_to_string(root().join("Cargo.lock")).unwrap();
    for component in components.iter().filter(third_party) {
        let checksum = component["hashes"][0]["content"].as_str().unwrap();
        assert!(
            lock.contains(&format!("checksum = \"{checksum}\"")),
            "{component}"
        );
        let licence = component["licenses"][0]["expression"].as_str().unwrap();
        assert!(!licence.is_empty() && !licence.contains('/'), "{component}");
    }
    // the page of the workbench has packages of another registry
    for name in ["preact", "preact-iso", "@preact/signals", "@preact/signals-core"] {
        let found = components.iter().find(|component| component["name"] == name);
        let version = found.and_then(|component| component["version"].as_str());
        let text = format!("{name} {}\n", version.unwrap_or("not in the bill"));
        assert!(notices.contains(&text), "{text}");
    }
    let mut references: Vec<Value> = components
        .iter()
        .map(|component| component["bom-ref"].clone())
        .collect();
    references.push(bill["metadata"]["component"]["bom-ref"].clone());
    let dependencies = list(&bill["dependencies"]);
    assert_eq!(dependencies.len(), references.len());
    for dependency in dependencies {
        let needs = list(&dependency["dependsOn"]);
        let known = needs.iter().all(|reference| references.contains(reference));
        assert!(known && references.contains(&dependency["ref"]), "{dependency}");
    }
}

/// The package database is one of the test; nothing on this machine changes.
fn dpkg(lab: &Lab, what: &[&str]) {
    let system = lab.folder().join("installed");
    for folder in [
        "var/lib/dpkg/info",
        "var/lib/dpkg/updates",
        "var/lib/dpkg/triggers",
    ] {
        std::fs::create_dir_all(system.join(folder)).unwrap();
    }
    for file in ["status", "available"] {
        let file = system.join("var/lib/dpkg").join(file);
        std::fs::OpenOptions::new()
            .append(true)
            .create(true)
            .open(file)
            .unwrap();
    }
    let mut line = vec![
        format!("--root={}", system.display()),
        format!("--log={}", lab.folder().join("dpkg.log").display()),
        // the libraries are those of this machine, and its programs run the package's script
        "--force-depends".to_owned(),
        "--force-script-chrootless".to_owned(),
    ];
    line.extend(what.iter().map(ToString::to_string));
    lab.run(Side::Controller, "dpkg", line, SHORT).ok();
}

#[test]
fn the_package_is_complete_and_installed_it_scans_without_root() {
    let lab = Lab::new("package");
    let package = pack(&lab.folder().join("package"));
    let contents = output(Command::new("dpkg-deb").arg("--contents").arg(&package));
    for path in [
        "./usr/bin/profidrive",
        "./usr/share/man/man1/profidrive.1.gz",
        "./usr/share/man/man1/profidrive-simulate.1.gz",
        "./usr/share/bash-completion/completions/profidrive",
        "./usr/share/doc/profidrive/changelog.gz",
        "./usr/share/doc/profidrive/copyright",
        "./usr/share/doc/profidrive/profidrive.cdx.json",
    ] {
        assert!(
            contents.lines().any(|line| line.ends_with(path)),
            "{path}: {contents}"
        );
    }
    assert!(
        contents.lines().all(|line| line.contains(" root/root ")),
        "{contents}"
    );

    dpkg(&lab, &["--install", package.to_str().unwrap()]);
    let installed = lab.folder().join("installed/usr/bin/profidrive");
    let _drive = simulate(&lab, &["--name", "akd-1", "--ip", "192.168.77.50/24"]);
    // root without its powers: what a program may do comes from the program file alone
    let scan = |program: &Path| {
        let unprivileged = ["--securebits", "+noroot,+noroot_locked", "--inh-caps", "-all"];
        let scan = [program.to_str().unwrap(), "scan", "-i", "ctl0"];
        lab.run(
            Side::Controller,
            "setpriv",
            [&unprivileged[..], &scan[..]].concat(),
            SHORT,
        )
    };
    let refused = scan(&built("profidrive"));
    assert!(
        refused.code != Some(0) && refused.err.contains("cap_net_raw"),
        "{refused:?}"
    );
    let found = scan(&installed).ok();
    assert!(found.out.contains("akd-1"), "{found:?}");

    dpkg(&lab, &["--purge", "profidrive"]);
    assert!(!installed.exists());
}

/// Both licences require that their text goes with every copy.
#[test]
fn every_published_crate_contains_both_licences() {
    let cargo = |arguments: &[&str]| {
        let program = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
        output(Command::new(program).args(arguments).current_dir(root()))
    };
    let metadata = cargo(&["metadata", "--format-version", "1", "--no-deps", "--offline"]);
    let metadata: Value = serde_json::from_str(&metadata).unwrap();
    let packages = metadata["packages"].as_array().unwrap().iter();
    let published: Vec<_> = packages.filter(|package| package["publish"].is_null()).collect();
    assert!(published.len() > 10, "{published:?}");
    for package in published {
        let name = package["name"].as_str().unwrap();
        let listed = cargo(&["package", "-p", name, "--list", "--allow-dirty", "--offline"]);
        let folder = Path::new(package["manifest_path"].as_str().unwrap())
            .parent()
            .unwrap();
        for file in ["LICENSE-APACHE", "LICENSE-MIT"] {
            assert!(
                listed.lines().any(|line| line == file),
                "{name}: {file}: {listed}"
            );
            let texts = [folder, &root()].map(|folder| std::fs::read(folder.join(file)).unwrap());
            assert!(texts[0] == texts[1], "{name}: {file}");
        }
    }
}
