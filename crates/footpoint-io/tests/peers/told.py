"""Prints columns and what else a reader found as JSON: numbers as text, which holds NaN and every digit."""

import json

import numpy


def tell(columns, **others):
    told = {}
    for name, values in columns.items():
        values = numpy.asarray(values)
        is_float = values.dtype.kind == "f"
        told[name] = {
            "type": f"{values.dtype.kind}{values.dtype.itemsize}",
            "values": [repr(float(v)) if is_float else str(int(v)) for v in values],
        }
    print(json.dumps({"columns": told, **others}))
