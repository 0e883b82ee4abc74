"""What pypcd4 reads of a PCD file."""

import sys

import pypcd4

from told import tell

cloud = pypcd4.PointCloud.from_path(sys.argv[1])
tell({name: cloud.pc_data[name] for name in cloud.fields})
