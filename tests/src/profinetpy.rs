//! The independent controller: `tests/peers/profinetpy_controller.py` at the controller's end.

use std::time::Duration;

use profile::catalogue::Device;

use crate::lab::{Lab, Side};
use crate::process::Finished;
use crate::programs::{peer, python};

/// Runs the script to its end, at most `limit` seconds.
pub fn controller<S: AsRef<str>>(lab: &Lab, arguments: &[S], limit: u64) -> Finished {
    let script = peer("profinetpy_controller.py");
    let mut line = vec![
        script.to_str().unwrap(),
        "--interface",
        Side::Controller.interface(),
        "--mac",
        Side::Device.mac(),
    ];
    line.extend(arguments.iter().map(AsRef::as_ref));
    lab.run(Side::Controller, python(), line, Duration::from_secs(limit))
}

/// Returns the value of the script's `--slots` for a drive with this telegram.
#[must_use]
pub fn slots(device: &Device, telegram: u16) -> String {
    let module = device.telegram(telegram).unwrap();
    let row = |slot: u16, subslot: u16, api: u16, ident: u32, submodule: u32, inputs: u16, outputs: u16| {
        format!("{slot}:{subslot}:{api}:{ident}:{submodule}:{inputs}:{outputs}")
    };
    let mut rows: Vec<String> = device
        .access_point()
        .map(|(subslot, submodule)| row(0, subslot, 0, device.access_point_module, submodule, 0, 0))
        .collect();
    let parameters = &device.layout.parameters;
    if let Some(submodule) = parameters.submodule {
        rows.push(row(
            1,
            parameters.subslot,
            device.api,
            module.module,
            submodule,
            0,
            0,
        ));
    }
    let (inputs, outputs) = (module.inputs, module.outputs);
    rows.push(row(
        1,
        device.layout.telegram,
        device.api,
        module.module,
        module.submodule,
        inputs,
        outputs,
    ));
    rows.join(",")
}
