//! The independent controller: `tests/peers/profinetpy_controller.py` at the controller's end.

use std::time::Duration;

use profidrive::catalogue::Device;

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

/// What the script's `--slots` takes for a drive with this telegram.
#[must_use]
pub fn slots(device: &Device, telegram: u16) -> String {
    let module = device.telegram(telegram).unwrap();
    format!(
        "0:1:0:{dap}:{dap_sub}:0:0,0:0x8000:0:{dap}:{interface}:0:0,0:0x8001:0:{dap}:{port}:0:0,1:1:{api}:{tel}:{tel_sub}:{inputs}:{outputs}",
        dap = device.access_point_module,
        dap_sub = device.access_point_submodule,
        interface = device.interface_submodule,
        port = device.port_submodule,
        api = device.api,
        tel = module.module,
        tel_sub = module.submodule,
        inputs = module.inputs,
        outputs = module.outputs,
    )
}
