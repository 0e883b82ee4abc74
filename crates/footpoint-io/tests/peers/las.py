"""Prints what laspy reads of a LAS or LAZ file, as JSON: header, grid and every dimension."""

import json
import sys

import laspy

las = laspy.read(sys.argv[1])
columns = {"x": las.x, "y": las.y, "z": las.z}
for name in las.point_format.dimension_names:
    if name in "XYZ":
        continue
    values = las[name]
    if getattr(values, "ndim", 1) > 1:
        columns.update({f"{name}_{k}": values[:, k] for k in range(values.shape[1])})
    else:
        columns[name] = values
header = las.header
print(
    json.dumps(
        {
            "version": str(header.version),
            "format": header.point_format.id,
            "points": header.point_count,
            "min": list(header.mins),
            "max": list(header.maxs),
            "scales": list(header.scales),
            "offsets": list(header.offsets),
            "vlrs": len(header.vlrs),
            "evlrs": len(las.evlrs or []),
            "columns": {name: [float(v) for v in values] for name, values in columns.items()},
        }
    )
)
