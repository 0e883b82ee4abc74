"""What plyfile reads of the points of a PLY file, and its comments."""

import sys

from plyfile import PlyData

from told import tell

ply = PlyData.read(sys.argv[1])
points = ply["vertex"].data
columns = {name: points[name] for name in points.dtype.names}
tell(columns, comments=ply.comments, obj_info=ply.obj_info, text=ply.text, order=ply.byte_order)
