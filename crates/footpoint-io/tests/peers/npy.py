"""What numpy reads of an array of records (npy) or of an archive of arrays (npz)."""

import sys

import numpy

from told import tell

found = numpy.load(sys.argv[1])
names = found.files if sys.argv[1].endswith(".npz") else found.dtype.names
tell({name: found[name] for name in names})
