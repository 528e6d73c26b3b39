//! Replays the fuzz corpora: each input whole, and each seed cut at every octet and with octets flipped.

use std::path::{Path, PathBuf};

use profinet::wire::ethernet::Frame;
use system_tests::fuzz_targets::TARGETS;
use system_tests::{rewrite, root};

fn seeds(target: &str) -> Vec<PathBuf> {
    let folder = root().join("fuzz/corpus").join(target);
    let mut seeds: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.unwrap().path())
        .collect();
    seeds.sort();
    seeds
}

/// Those that the fuzzer has not found.
fn captured(target: &str) -> impl Iterator<Item = PathBuf> {
    seeds(target).into_iter().filter(|seed| !is_found(seed))
}

/// Returns whether the fuzzer found this input: its name is a digest of 40 digits then. It has cut and changed it already.
fn is_found(seed: &Path) -> bool {
    seed.file_name().is_some_and(|name| name.len() == 40)
}

#[test]
fn every_seed_of_every_target() {
    for (name, target) in TARGETS {
        let seeds = seeds(name);
        assert!(seeds.len() > 1, "{name} has no corpus");
        for seed in seeds {
            println!("{name}: {}", seed.display());
            let data = std::fs::read(&seed).unwrap();
            target(&data);
            if is_found(&seed) {
                continue;
            }
            for cut in 0..data.len().min(600) {
                target(&data[..cut]);
            }
            let mut damaged = data.clone();
            for at in 0..data.len().min(400) {
                for flip in [0x01, 0x80, 0xFF] {
                    damaged[at] = data[at] ^ flip;
                    target(&damaged);
                }
                damaged[at] = data[at];
            }
        }
    }
}

#[test]
fn every_target_has_a_fuzzer_and_every_fuzzer_a_target() {
    let manifest = std::fs::read_to_string(root().join("fuzz/Cargo.toml")).unwrap();
    for (name, _) in TARGETS {
        let file = root().join(format!("fuzz/fuzz_targets/{name}.rs"));
        let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        assert!(
            text.contains(&format!("fuzz_targets::{name}(data)")),
            "{}",
            file.display()
        );
        assert!(
            manifest.contains(&format!("name = \"{name}\"\n")),
            "{name} is not in fuzz/Cargo.toml"
        );
    }
    assert_eq!(manifest.matches("[[bin]]").count(), TARGETS.len());
    // and no unused seeds
    for folder in std::fs::read_dir(root().join("fuzz/corpus")).unwrap() {
        let folder = folder.unwrap().file_name().into_string().unwrap();
        assert!(
            TARGETS.iter().any(|(name, _)| *name == folder),
            "fuzz/corpus/{folder} has no target"
        );
    }
}

/// The DCP and RPC seeds are whole frames and datagrams of the captures: nothing may change on the way through us.
#[test]
fn captured_payloads_come_out_as_they_went_in() {
    for seed in captured("dcp") {
        let data = std::fs::read(&seed).unwrap();
        let frame = Frame::parse(&data).unwrap();
        let again = rewrite::dcp(frame.payload).unwrap_or_else(|e| panic!("{}: {e}", seed.display()));
        let mut expected = frame.payload.to_vec();
        let length = u16::from_be_bytes([expected[8], expected[9]]);
        if length % 2 == 1 {
            // profinet-py does not pad the last block of what it sends
            expected[8..10].copy_from_slice(&(length + 1).to_be_bytes());
            expected.truncate(10 + usize::from(length));
            expected.push(0);
        }
        // p-net writes 1 into the reserved octet behind the role
        if let Some(at) = expected.windows(8).position(|w| w == [2, 4, 0, 4, 0, 0, 1, 1]) {
            expected[at + 7] = 0;
        }
        assert_eq!(again, expected[..again.len()], "{}", seed.display());
        assert!(expected[again.len()..].iter().all(|octet| *octet == 0));
    }
    for seed in captured("rpc") {
        let data = std::fs::read(&seed).unwrap();
        let again = rewrite::rpc(&data).unwrap_or_else(|e| panic!("{}: {e}", seed.display()));
        assert_eq!(again, data, "{}", seed.display());
    }
}
