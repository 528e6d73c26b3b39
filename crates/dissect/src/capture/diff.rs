//! What differs between expected and plugged modules, out of a ModuleDiffBlock.

use profinet::wire::block::{DiffModule, DiffSubmodule, ModuleDiff, ModuleState};

use super::event::{Connect, ConnectSubmodule};
use super::records::api_text;
use crate::Weight;

/// One line for each module.
pub fn lines(diff: &ModuleDiff) -> Vec<(Weight, String, Connect)> {
    diff.modules.iter().map(line).collect()
}

fn line(module: &DiffModule) -> (Weight, String, Connect) {
    let differs = module.state != ModuleState::PROPER
        || module
            .submodules
            .iter()
            .any(|submodule| submodule.state.ident_info() != 0);
    let only_pending = !differs
        && module
            .submodules
            .iter()
            .all(|submodule| submodule.state.ar_info() == 1 && !submodule.state.has_diagnosis());
    let weight = if only_pending {
        Weight::Normal
    } else {
        Weight::Warning
    };
    let head = format!("slot {}{}", module.slot, api_text(module.api));
    let mut text = if differs {
        format!(
            "{head} differs: {}, plugged is 0x{:08X}",
            module.state.words(),
            module.ident
        )
    } else {
        format!("{head}: {} 0x{:08X}", module.state.words(), module.ident)
    };
    for submodule in &module.submodules {
        text = format!("{text}; {}", submodule_text(submodule));
    }
    let detail = Connect {
        step: "diff",
        api: Some(module.api),
        slot: Some(module.slot),
        ident: Some(module.ident),
        state: Some(module.state.0),
        submodules: module
            .submodules
            .iter()
            .map(|submodule| ConnectSubmodule {
                subslot: submodule.subslot,
                ident: submodule.ident,
                input: None,
                output: None,
                state: Some(submodule.state.0),
            })
            .collect(),
        ..Connect::default()
    };
    (weight, text, detail)
}

fn submodule_text(submodule: &DiffSubmodule) -> String {
    let state = submodule.state;
    let words = state.words().collect::<Vec<_>>();
    let words = if words.is_empty() {
        "as expected".to_owned()
    } else {
        words.join(", ")
    };
    let plugged = if state.ident_info() == 0 {
        String::new()
    } else {
        format!(", plugged is 0x{:X}", submodule.ident)
    };
    format!(
        "subslot {} {words} (0x{:04X}){plugged}",
        subslot(submodule.subslot),
        state.0
    )
}

/// Returns a subslot as people write it: those of interface and ports in hexadecimal.
pub fn subslot(number: u16) -> String {
    if number > 0xFF {
        format!("0x{number:04X}")
    } else {
        number.to_string()
    }
}
