"""What profinet-py reads out of a device description, as one JSON object.

Written against the package's published interface (its help texts and signatures) only.

    profinetpy_gsdml.py FILE
"""

import json
import sys

import profinet


def submodule(item):
    return {"id": item.id, "ident": item.submodule_ident, "api": item.api, "input": item.input_length,
            "output": item.output_length}


def main():
    device = profinet.load_gsdml(sys.argv[1])
    points = [{"id": point.id, "ident": point.module_ident, "submodules": [submodule(s) for s in point.submodules],
               "system": [[s.subslot_number, s.submodule_ident] for s in point.system_submodules],
               "modules": sorted(point.useable_modules)} for point in device.daps]
    modules = {module.id: {"ident": module.module_ident, "submodules": [submodule(s) for s in module.submodules],
                           "pluggable": sorted(module.useable_submodules)} for module in device.modules.values()}
    print(json.dumps({"vendor": device.vendor_id, "device": device.device_id, "points": points, "modules": modules}))


main()
