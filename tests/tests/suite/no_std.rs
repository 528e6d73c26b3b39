//! The crates without I/O are for firmware too: they link without the standard library.

use std::process::Command;

use system_tests::root;

/// A static library with a panic handler of its own: the handler of the standard library would be a second one.
#[test]
fn profile_profinet_gsdml_and_uss_need_no_standard_library() {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let output = Command::new(cargo)
        .args(["build", "-q", "--locked", "--manifest-path"])
        .arg(root().join("tests/no-std/Cargo.toml"))
        .arg("--target-dir")
        .arg(root().join("target/no-std"))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(root().join("target/no-std/debug/libno_std_proof.a").exists());
}
