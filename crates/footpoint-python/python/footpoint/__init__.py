"""The smooth surface that a point cloud describes, computed exactly.

The surface is the *point set surface* of Alexa and Adamson, "On Normals and Projection Operators for Surfaces Defined
by Point Sets" (2004): where f(x) = n(x) . (x - a(x)) vanishes, with the weighted average a of the samples around x and the
normal n of a frame fitted to them. Its normal is not n but the gradient of f, and footpoint computes that exactly.

    import footpoint

    scan = footpoint.read("scan.ply")
    surface = footpoint.Surface(scan)
    smooth = surface.project()                        # the samples, taken to the surface
    normals = footpoint.orient(scan).normal           # exact normals with signs that agree
    picture = footpoint.render(surface)               # an array (height, width, 3)

Surface answers questions: evaluate, curvature, project, cast, and contour in the plane; with_normals gives it signs. The
functions normals, orient, distance and render take points, a Cloud or a Surface. read and write know ply, las, laz, e57, pcd,
obj, npy, npz and text.

Arrays. Points are arrays of shape (n, 3), or (n, 2) for a curve in the plane. One rule for all that is given: an array of
float64 in C order is used as it is, without a copy; other layouts, real numbers of other types (integers, float32) and
lists are copied to that; masked entries become NaN. Booleans, complex numbers, text and objects are a TypeError that names
the argument, a wrong shape is a ValueError. Queries may have any leading axes, which the results have too: (3,) is one
point with results of one point, (h, w, 3) a grid. Arrays are not to be changed while a call that uses them runs.

Lengths are in the unit of the points, angles of the command line alone are in degrees. A sample with a coordinate that is not
finite counts as absent, a query has the status INVALID. Quantities that do not exist are NaN, and `status` says why: row i
of the result belongs to row i of the queries, always.

Running. Other Python threads run during the work. `threads=0` takes all cores, `threads=1` the calling thread alone; results
are the same bits. Ctrl-C ends any call soon. `progress=` is called with (done, total), or is True for a bar: tqdm's, if
it is installed.
"""

from ._files import Cloud, read, write
from ._footpoint import __version__
from ._functions import distance, normals, orient
from ._picture import render
from ._results import (
    Component,
    Curvatures,
    Distances,
    Evaluations,
    Hits,
    Orientation,
    Polyline,
    Projections,
    Status,
    Support,
    SupportChoice,
)
from ._surface import Surface

__all__ = [
    "Cloud",
    "Component",
    "Curvatures",
    "Distances",
    "Evaluations",
    "Hits",
    "Orientation",
    "Polyline",
    "Projections",
    "Status",
    "Support",
    "SupportChoice",
    "Surface",
    "__version__",
    "distance",
    "normals",
    "orient",
    "read",
    "render",
    "write",
]
