"""What laspy reads of a LAS or LAZ file: every dimension, and the bounds and the number of points of the header."""

import sys

import laspy

from told import tell

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
tell(columns, points=header.point_count, min=list(header.mins), max=list(header.maxs))
