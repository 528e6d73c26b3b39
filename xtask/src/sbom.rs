//! `sbom`: the software bill of materials of the program, for the packages that are handed out: CycloneDX 1.5 in JSON.
//!
//! It has the same packages as `notices`, those of the page of the workbench among them. It has neither a time nor a serial number: the same commit gives the same bytes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde::Deserialize;
use serde_json::{Value, json};

use crate::Outcome;
use crate::linked::{Linked, PROGRAM, text};

/// The part of `Cargo.lock` that has the checksums.
#[derive(Debug, Deserialize)]
struct Lock {
    package: Vec<Locked>,
}

#[derive(Debug, Deserialize)]
struct Locked {
    name: String,
    version: String,
    checksum: Option<String>,
}

/// Prints what is linked for a target, with versions, licences and checksums of the packages, and which needs which.
pub fn run(root: &Path, target: &str) -> Outcome<()> {
    let lock: Lock = toml::from_str(&std::fs::read_to_string(root.join("Cargo.lock"))?)?;
    let page = std::fs::read_to_string(root.join("crates/workbench/web/package-lock.json"))?;
    let mut bill = bill(&Linked::read(root, target)?, &lock, target);
    add_page(&mut bill, &serde_json::from_str(&page)?);
    println!("{}", serde_json::to_string_pretty(&bill)?);
    Ok(())
}

fn bill(linked: &Linked, lock: &Lock, target: &str) -> Value {
    let references: BTreeMap<&str, String> = linked
        .packages()
        .map(|package| (text(&package["id"]), reference(package)))
        .collect();
    let (mut program, mut components, mut dependencies) = (Value::Null, Vec::new(), Vec::new());
    for package in linked.packages() {
        let needs = linked.needs(text(&package["id"])).iter();
        let needs: Vec<&String> = needs.filter_map(|id| references.get(id.as_str())).collect();
        dependencies.push(json!({ "ref": reference(package), "dependsOn": needs }));
        if package["name"] == PROGRAM {
            program = component(package, "application", lock);
        } else {
            components.push(component(package, "library", lock));
        }
    }
    json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "component": program,
            "properties": [{ "name": "cargo:target", "value": target }],
        },
        "components": components,
        "dependencies": dependencies,
    })
}

/// The package that has the page.
const WORKBENCH: &str = "profidrive-workbench";

/// Adds the packages that are built into the page of the workbench, where that is linked.
fn add_page(bill: &mut Value, lock: &Value) {
    let is_workbench = |reference: &Value| text(reference).starts_with(&format!("pkg:cargo/{WORKBENCH}@"));
    let list = |value: &mut Value| value.as_array_mut().map(std::mem::take).unwrap_or_default();
    let (mut components, mut dependencies) = (list(&mut bill["components"]), list(&mut bill["dependencies"]));
    if let Some(owner) = dependencies.iter_mut().find(|one| is_workbench(&one["ref"])) {
        let packages = &lock["packages"];
        let named = |name: &str| &packages[format!("node_modules/{name}")];
        let reference = |name: &str| {
            let version = text(&named(name)["version"]);
            format!("pkg:npm/{}@{version}", name.replace('@', "%40"))
        };
        let needs = |package: &Value| -> Vec<String> {
            let needs = package["dependencies"].as_object().into_iter().flatten();
            needs.map(|(name, _)| name.clone()).collect()
        };
        let references = |names: &[String]| {
            names
                .iter()
                .map(|name| Value::from(reference(name)))
                .collect::<Vec<_>>()
        };
        let mut next = needs(&packages[""]);
        if let Some(own) = owner["dependsOn"].as_array_mut() {
            own.extend(references(&next));
        }
        let mut known = BTreeSet::new();
        while let Some(name) = next.pop() {
            if !known.insert(name.clone()) {
                continue;
            }
            let (package, reference) = (named(&name), reference(&name));
            components.push(json!({
                "type": "library",
                "bom-ref": reference,
                "name": name,
                "version": package["version"],
                "licenses": [{ "expression": package["license"] }],
                "purl": reference,
            }));
            let needed = needs(package);
            dependencies.push(json!({ "ref": reference, "dependsOn": references(&needed) }));
            next.extend(needed);
        }
    }
    bill["components"] = components.into();
    bill["dependencies"] = dependencies.into();
}

/// Returns the name of a package in the bill, which is its package URL.
fn reference(package: &Value) -> String {
    let (name, version) = (text(&package["name"]), text(&package["version"]));
    format!("pkg:cargo/{name}@{version}")
}

fn component(package: &Value, kind: &str, lock: &Lock) -> Value {
    let (name, version) = (text(&package["name"]), text(&package["version"]));
    let reference = reference(package);
    // older packages separate two licences by a slash, which is no licence expression
    let licence = text(&package["license"]).replace('/', " OR ");
    let mut component = json!({
        "type": kind,
        "bom-ref": reference,
        "name": name,
        "version": version,
        "licenses": [{ "expression": licence }],
        "purl": reference,
    });
    let mut locked = lock.package.iter();
    let locked = locked.find(|locked| locked.name == name && locked.version == version);
    // packages of this workspace have none
    if let Some(checksum) = locked.and_then(|locked| locked.checksum.as_deref()) {
        component["hashes"] = json!([{ "alg": "SHA-256", "content": checksum }]);
    }
    component
}
