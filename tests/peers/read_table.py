"""Reads a recording (Parquet, Arrow file or Arrow stream) with pyarrow and prints what it has as JSON."""

import json
import sys

import pyarrow as pa
import pyarrow.ipc
import pyarrow.parquet


def read(path):
    if path.endswith(".parquet"):
        return pyarrow.parquet.read_table(path)
    if path.endswith(".arrow"):
        return pa.ipc.open_file(path).read_all()
    return pa.ipc.open_stream(path).read_all()


table = read(sys.argv[1])
text = lambda metadata: {key.decode(): value.decode() for key, value in (metadata or {}).items()}
print(
    json.dumps(
        {
            "rows": table.num_rows,
            "gaps": sum(table["gap"].to_pylist()),
            "drives": sorted(set(table["drive"].to_pylist())),
            "columns": table.column_names,
            "types": [str(field.type) for field in table.schema],
            "schema": text(table.schema.metadata).get("schema"),
            "units": {field.name: text(field.metadata).get("unit") for field in table.schema},
        }
    )
)
