"""What pye57 reads of the first scan of an E57 file."""

import sys

import pye57

from told import tell

tell(pye57.E57(sys.argv[1]).read_scan_raw(0))
