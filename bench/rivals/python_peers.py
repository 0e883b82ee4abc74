"""Open3D, small_gicp and pymeshlab as peers: normals and projections, one thread, jobs from the standard input.

Arguments: the library, a file of points and a file for the answers, both doubles, three a row.
"""

import importlib.metadata
import json
import os
import sys
import time

import numpy


def reply(**what):
    print(json.dumps(what), flush=True)


class Open3D:
    def __init__(self, points):
        import open3d

        self.open3d = open3d
        self.points = points

    def normals(self, search):
        # A cloud of its own for every job, because estimation starts from normals that are there.
        cloud = self.open3d.geometry.PointCloud(self.open3d.utility.Vector3dVector(self.points))
        before = time.process_time()
        cloud.estimate_normals(search)
        return time.process_time() - before, "normals", numpy.asarray(cloud.normals)

    def normals_radius(self, radius):
        return self.normals(self.open3d.geometry.KDTreeSearchParamRadius(radius))

    def normals_count(self, count):
        return self.normals(self.open3d.geometry.KDTreeSearchParamKNN(int(count)))


class SmallGicp:
    def __init__(self, points):
        import small_gicp

        self.small_gicp = small_gicp
        self.points = points

    def normals_count(self, count):
        cloud = self.small_gicp.PointCloud(self.points)
        before = time.process_time()
        self.small_gicp.estimate_normals(cloud, num_neighbors=int(count), num_threads=1)
        return time.process_time() - before, "normals", cloud.normals()[:, :3]


class PyMeshLab:
    def __init__(self, points):
        import pymeshlab

        self.pymeshlab = pymeshlab
        self.points = points

    def cloud(self):
        meshes = self.pymeshlab.MeshSet()
        meshes.add_mesh(self.pymeshlab.Mesh(vertex_matrix=self.points))
        return meshes

    def normals_count(self, count):
        meshes = self.cloud()
        before = time.process_time()
        meshes.compute_normal_for_point_clouds(k=int(count))
        seconds = time.process_time() - before
        return seconds, "normals", meshes.current_mesh().vertex_normal_matrix()

    def apss(self, _radius):
        # The filter takes its supports from the density of the points, and needs normals; both are its index. It
        # crashes unless the control mesh is the current one and comes after the points to project.
        meshes = self.cloud()
        meshes.add_mesh(self.pymeshlab.Mesh(vertex_matrix=self.points))
        before = time.process_time()
        meshes.compute_normal_for_point_clouds(k=30)
        meshes.compute_mls_projection_apss(controlmesh=1, proxymesh=0)
        seconds = time.process_time() - before
        return seconds, "points", meshes.mesh(0).vertex_matrix()


LIBRARIES = {"open3d": Open3D, "small_gicp": SmallGicp, "pymeshlab": PyMeshLab}


def main():
    library, points, answers = sys.argv[1:]
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    peer = LIBRARIES[library](numpy.fromfile(points).reshape(-1, 3))
    reply(**{library: importlib.metadata.version(library), "python": sys.version.split()[0]})
    for line in sys.stdin:
        job, number = line.split()
        try:
            seconds, kind, rows = getattr(peer, job)(float(number))
        except Exception as error:
            reply(error=f"{type(error).__name__}: {error}")
            continue
        numpy.ascontiguousarray(rows, dtype=float).tofile(answers)
        reply(cpu=seconds, kind=kind)


main()
