"""Prints the columns of a PCD file (pypcd4) or of the first scan of an E57 file (pye57): name, then all values."""

import sys

path = sys.argv[1]
if path.endswith(".pcd"):
    import pypcd4

    cloud = pypcd4.PointCloud.from_path(path)
    columns = {name: cloud.pc_data[name] for name in cloud.fields}
else:
    import pye57

    columns = pye57.E57(path).read_scan_raw(0)
for name, values in columns.items():
    print(name, *(repr(float(value)) for value in values))
