//! Replays the fuzz corpora: each seed whole, cut at every octet and with octets flipped.

use std::path::PathBuf;

use system_tests::fuzz_targets::TARGETS;
use system_tests::root;

fn seeds(target: &str) -> Vec<PathBuf> {
    let folder = root().join("fuzz/corpus").join(target);
    let mut seeds: Vec<PathBuf> = std::fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.unwrap().path())
        .collect();
    seeds.sort();
    seeds
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
}
