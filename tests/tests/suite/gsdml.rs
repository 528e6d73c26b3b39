//! Device descriptions before judges we did not write: a schema validator, another reader, another controller.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Duration;

use profile::catalogue::AKD;
use system_tests::profinetpy::controller;
use system_tests::{Lab, Side, built, judge, peer, python, root, step};

const MODULES: &str = "GSDML-V2.1-KOLLMORGEN-AKDLIKE-20140301.xml";
const SUBMODULES: &str = "GSDML-V2.32-Kollmorgen-DriveObject-20170601-103000.xml";

/// Returns the exported description of the AKD, in a folder of its own.
fn exported(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    let output = Command::new(built("profidrive"))
        .args(["gsdml", "export", "--model", "akd", "-o"])
        .arg(&folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    PathBuf::from(String::from_utf8(output.stdout).unwrap().lines().next().unwrap())
}

fn vendor_file(name: &str) -> PathBuf {
    root().join("tests/descriptions").join(name)
}

/// Returns the verdict of libxml2 by the schema of `tests/descriptions/`.
fn validate(file: &Path) -> Output {
    Command::new("xmllint")
        .args(["--nonet", "--noout", "--schema"])
        .arg(vendor_file("gsdml.xsd"))
        .arg(file)
        .output()
        .expect("xmllint is not installed: run `make setup`")
}

#[test]
fn the_schema_takes_the_exported_file() {
    for file in [
        exported("gsdml-schema"),
        vendor_file(MODULES),
        vendor_file(SUBMODULES),
    ] {
        let verdict = validate(&file);
        assert!(
            verdict.status.success(),
            "{}",
            String::from_utf8_lossy(&verdict.stderr)
        );
    }
}

/// A judge that cannot say no is none. What it refuses our own check refuses too.
#[test]
fn the_schema_refuses_what_is_wrong() {
    let file = exported("gsdml-schema-broken");
    let text = std::fs::read_to_string(&file).unwrap();
    for (from, to) in [
        ("VendorID=\"0x0105\"", "VendorID=\"261x\""),
        ("DNS_CompatibleName=\"akd\"", "DNS_CompatibleName=\"AKD\""),
        ("MinDeviceInterval=\"512\"", "MinDeviceInterval=\"0\""),
        ("ModuleItemTarget=\"M_TEL_9\"", "ModuleItemTarget=\"M_TEL_99\""),
        ("ModuleItem ID=\"M_TEL_9\"", "ModuleItem ID=\"M_TEL_7\""),
        ("ModuleIdentNumber=\"0x00010009\"", "ModuleIdentNumber=\"0x0\""),
        ("GraphicItemTarget=\"G_DEVICE\"", "GraphicItemTarget=\"G_NONE\""),
        ("Name TextId=\"T_TEL_9\"", "Name TextId=\"T_TEL_99\""),
        ("Text TextId=\"T_TEL_9\"", "Text TextId=\"T_TEL_7\""),
        ("<IOConfigData ", "<IOConfigDate "),
        ("SubslotNumber=\"32769\"", "SubslotNumber=\"1\""),
        (
            "MaxSupportedRecordSize=\"4068\"",
            "MaxSupportedRecordSize=\"1000\"",
        ),
        ("Consistency=\"All items consistency\"", "Consistency=\"all\""),
        (
            "SupportedRT_Classes=\"RT_CLASS_1\"",
            "SupportedRT_Classes=\"RT_CLASS_2\"",
        ),
        ("<ProfileClassID>Device", "<ProfileClassID>Servo"),
        ("MainFamily=\"Drives\"", "MainFamily=\"Motion\""),
    ] {
        assert!(text.contains(from), "{from}");
        let broken = file.with_file_name("GSDML-V2.35-Kollmorgen-broken-20261121.xml");
        std::fs::write(&broken, text.replacen(from, to, 1)).unwrap();
        assert!(!validate(&broken).status.success(), "{from} -> {to}");
        let own = Command::new(built("profidrive"))
            .args(["gsdml", "check"])
            .arg(&broken)
            .output()
            .unwrap();
        assert_eq!(own.status.code(), Some(5), "{from} -> {to}: {own:?}");
    }
}

fn parsed(file: &Path) -> serde_json::Value {
    let output = Command::new(python())
        .arg(peer("profinetpy_gsdml.py"))
        .arg(file)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn profinet_py_reads_the_exported_file_as_the_tables_have_it() {
    let read = parsed(&exported("gsdml-profinetpy"));
    let device = &AKD.device;
    assert_eq!(read["vendor"], device.vendor_id);
    assert_eq!(read["device"], device.device_id);
    let point = &read["points"][0];
    assert_eq!(point["ident"], device.access_point_module);
    assert_eq!(point["submodules"][0]["ident"], device.access_point_submodule);
    assert_eq!(
        point["system"],
        serde_json::json!([
            [0x8000, device.interface_submodule],
            [0x8001, device.port_submodule]
        ])
    );
    let modules = read["modules"].as_object().unwrap();
    assert_eq!(modules.len(), device.telegrams.len());
    assert_eq!(point["modules"].as_array().unwrap().len(), device.telegrams.len());
    for telegram in device.telegrams {
        let module = &modules[&format!("M_TEL_{}", telegram.telegram)];
        let submodule = &module["submodules"][0];
        assert_eq!(module["ident"], telegram.module);
        assert_eq!(submodule["ident"], telegram.submodule);
        assert_eq!(submodule["api"], device.api);
        assert_eq!(
            (&submodule["input"], &submodule["output"]),
            (&telegram.inputs.into(), &telegram.outputs.into()),
            "telegram {}",
            telegram.telegram
        );
    }
}

/// Our reader and profinet-py's find the same in files laid out as vendors do.
#[test]
fn both_readers_agree_on_vendor_files() {
    for name in [MODULES, SUBMODULES] {
        let (theirs, file) = (parsed(&vendor_file(name)), vendor_file(name));
        let ours = gsdml::parse(&std::fs::read(file).unwrap()).unwrap();
        assert_eq!(theirs["vendor"], ours.identity.vendor_id);
        assert_eq!(theirs["device"], ours.identity.device_id);
        for (theirs, ours) in theirs["points"]
            .as_array()
            .unwrap()
            .iter()
            .zip(&ours.access_points)
        {
            assert_eq!(
                (&theirs["id"], &theirs["ident"]),
                (&ours.id.as_str().into(), &ours.module_ident.into())
            );
            let system = ours.interface.iter().map(|i| (i.subslot, i.ident));
            let system = system.chain(ours.ports.iter().map(|p| (p.subslot, p.ident)));
            assert_eq!(theirs["system"], serde_json::json!(system.collect::<Vec<_>>()));
        }
        let modules = theirs["modules"].as_object().unwrap();
        assert_eq!(modules.len(), ours.modules.len());
        for ours in &ours.modules {
            let theirs = &modules[&ours.id];
            assert_eq!(theirs["ident"], ours.ident);
            for (theirs, ours) in theirs["submodules"]
                .as_array()
                .unwrap()
                .iter()
                .zip(&ours.virtual_submodules)
            {
                let lengths = serde_json::json!([theirs["input"], theirs["output"]]);
                assert_eq!(lengths, serde_json::json!(ours.lengths()), "{}", ours.id);
                assert_eq!(
                    (&theirs["ident"], &theirs["api"]),
                    (&ours.ident.into(), &ours.api.into())
                );
            }
            assert_eq!(
                theirs["pluggable"].as_array().unwrap().len(),
                ours.submodules.len()
            );
        }
    }
}

/// profinet-py, configured from nothing but the file, exchanges data with the drive that is simulated by it.
/// The dissector finds nothing wrong in what they say.
fn connects(lab: &Lab, file: &Path, simulate: &[&str], project: &[&str], ratio: &str) {
    let at = [
        "--mac",
        Side::Device.mac(),
        "--name",
        "drive-one",
        "--ip",
        "192.168.77.50/24",
    ];
    connects_to(lab, file, &[&at, simulate].concat(), project, ratio);
}

/// The same with everything that `simulate` is reported.
fn connects_to(lab: &Lab, file: &Path, simulate: &[&str], project: &[&str], ratio: &str) {
    let capture = lab.capture(&project.join("").replace(['-', ':'], ""));
    let drive = system_tests::simulate(lab, simulate);
    let line = [
        "--mac",
        Side::Device.mac(),
        "--name",
        "drive-one",
        "--ip",
        "192.168.77.50",
        "--gsdml",
        file.to_str().unwrap(),
    ];
    let seconds = ["--ratio", ratio, "--seconds", "1"];
    let steps = ["--steps", "find,connect,im0_connected,exchange,release"];
    let finished = controller(lab, &[&line[..], &seconds, project, &steps].concat(), 30);
    let steps = finished.ok().json_lines();
    let exchange = step(&steps, "exchange");
    assert_eq!(exchange["state"], "RUNNING", "{exchange}");
    assert_eq!(exchange["errors"], serde_json::json!([]), "{exchange}");
    assert!(exchange["received"].as_u64().unwrap() > 10, "{exchange}");
    let finished = drive.interrupt(Duration::from_secs(5)).ok();
    assert!(finished.out.contains("telegram"), "{}", finished.out);
    judge::judge(&capture.stop())
        .clean()
        .saw("pn_dcp", 2)
        .saw("pn_io", 10);
}

#[test]
fn profinet_py_connects_by_the_exported_file() {
    let lab = Lab::new("gsdml-exported");
    let file = exported("gsdml-connect");
    for module in ["M_TEL_1", "M_TEL_353"] {
        connects(&lab, &file, &[], &["--module", module], "16");
    }
}

#[test]
fn profinet_py_connects_by_a_vendor_file() {
    let lab = Lab::new("gsdml-vendor");
    let file = vendor_file(MODULES);
    let simulate = ["--gsdml", file.to_str().unwrap()];
    connects(&lab, &file, &simulate, &["--module", "ID_MOD_9"], "16");
    let old = ["--module", "ID_MOD_7", "--access-point", "ID_DAP_OLD"];
    connects(&lab, &file, &simulate, &old, "32");
    let file = vendor_file(SUBMODULES);
    let simulate = ["--gsdml", file.to_str().unwrap()];
    let plugged = ["--module", "M_DO", "--submodule", "2:S_MDI"];
    connects(&lab, &file, &simulate, &plugged, "16");
}

/// The drives of a plant take the description too; in virtual time, where our own controllers are, they cannot.
#[test]
fn a_plant_of_drives_from_a_vendor_file() {
    let lab = Lab::new("gsdml-plant");
    let plant = lab.folder().join("plant.toml");
    let text = format!(
        "[[drive]]\nname = \"drive-one\"\nmac = \"{}\"\nip = \"192.168.77.50/24\"\n\
         event = [{{ at = \"100ms\", do = \"warning=107\" }}]\n",
        Side::Device.mac()
    );
    std::fs::write(&plant, text).unwrap();
    let (plant, file) = (plant.to_str().unwrap(), vendor_file(MODULES));
    let simulate = [plant, "--gsdml", file.to_str().unwrap()];
    connects_to(&lab, &file, &simulate, &["--module", "ID_MOD_9"], "16");
    let virtual_time = [&["simulate"], &simulate[..], &["--virtual-time", "--for", "1s"]].concat();
    let refused = Command::new(built("profidrive"))
        .args(virtual_time)
        .output()
        .unwrap();
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    let words = String::from_utf8(refused.stderr).unwrap();
    assert!(
        words.contains("--virtual-time") && words.contains("--gsdml"),
        "{words}"
    );
}
