"""Closed meshes that the tests of curved patches draw themselves."""

from __future__ import annotations

import numpy as np
from rings import wavy_torus

from terrain_lod.mesh.mesh import Mesh
from terrain_lod.mesh.normals import vertex_normals


def with_normals(vertices, triangles) -> Mesh:
    """Return a mesh with the mean normals of the faces around each vertex."""
    vertices = np.asarray(vertices, np.float32)
    triangles = np.asarray(triangles, np.int32).reshape(-1, 3)
    return Mesh(vertices, vertex_normals(vertices, triangles).astype(np.float32), triangles)


def polyhedron(vertices, faces) -> Mesh:
    """Return flat polygons, each with corners and normals of its own."""
    corners, triangles = [], []
    for face in faces:
        first = len(corners)
        corners += [vertices[corner] for corner in face]
        triangles += [(first, first + k, first + k + 1) for k in range(1, len(face) - 1)]
    return with_normals(corners, triangles)


def cube() -> Mesh:
    """Three normals at every corner; faces counter-clockwise from outside.

    ::

          6-----7        z up, y back, x right
         /|    /|
        4-----5 |
        | 2---|-3
        |/    |/
        0-----1
    """
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return polyhedron(corners, faces)


def welded(mesh: Mesh) -> Mesh:
    """Return the mesh with one vertex a position, and normals of all faces around it."""
    vertices, index = np.unique(mesh.vertices, axis=0, return_inverse=True)
    return with_normals(vertices, index.ravel()[mesh.triangles])


def chamfered_cube(chamfer: float = 0.2) -> Mesh:
    """A cube whose faces stay flat and whose chamfers are shaded round.

    The six faces are of a size 1 - 2 chamfer; between them are twelve strips and eight corners,
    whose vertices have the normals of the faces: smooth, one normal a vertex.
    """
    low, high = chamfer, 1 - chamfer
    vertices, normals = [], []
    for axis in range(3):
        for end in (0.0, 1.0):
            for a, b in ((low, low), (high, low), (high, high), (low, high)):
                point = np.zeros(3)
                point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3] = end, a, b
                vertices.append(point)
                normal = np.zeros(3)
                normal[axis] = 2 * end - 1
                normals.append(normal)
    from scipy.spatial import ConvexHull

    hull = ConvexHull(vertices)
    return _outwards(np.array(vertices), np.array(normals), hull.simplices)


def _outwards(vertices, normals, triangles) -> Mesh:
    """Return a convex mesh about (0.5, 0.5, 0.5) with its triangles turned outwards."""
    triangles = np.array(triangles)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - 0.5) < 0
    triangles[inwards] = triangles[inwards][:, ::-1]
    return Mesh(vertices.astype(np.float32), normals.astype(np.float32), triangles.astype(np.int32))


def cone(sides: int = 12) -> Mesh:
    """A flat base, a round side whose normals split at the rim, and an apex of many normals."""
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    rim = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    out = np.stack([np.cos(angle), np.sin(angle), 0 * angle + 1], axis=1) / np.sqrt(2)
    between = angle + np.pi / sides
    up = np.stack([np.cos(between), np.sin(between), 0 * angle + 1], axis=1) / np.sqrt(2)
    # rim of the side, apexes, rim of the base, its middle
    vertices = np.concatenate([rim, np.tile([0, 0, 1.0], (sides, 1)), rim, [[0, 0, 0]]])
    down = np.tile([0, 0, -1.0], (sides + 1, 1))
    index = np.arange(sides)
    after = (index + 1) % sides
    side = np.stack([index, after, sides + index], axis=1)
    base = np.stack([2 * sides + after, 2 * sides + index, np.full(sides, 3 * sides)], axis=1)
    return Mesh(
        vertices.astype(np.float32),
        np.concatenate([out, up, down]).astype(np.float32),
        np.concatenate([side, base]).astype(np.int32),
    )


def torus(columns: int = 16, rows: int = 8) -> Mesh:
    """A smooth ring with a wavy girth, and the normals of a plain one."""
    return wavy_torus(columns, rows, waves=3)


def bulging(mesh: Mesh) -> Mesh:
    """Return a mesh of flat faces, split everywhere, whose normals lean towards its corners.

    Three normals or more meet at each corner, none across its edges: plain PN parts at all of them.
    """
    flat = polyhedron(mesh.vertices, mesh.triangles)
    middle = (mesh.vertices.max(axis=0) + mesh.vertices.min(axis=0)) / 2
    normals = flat.normals + 0.5 * (flat.vertices - middle)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(flat.vertices, normals, flat.triangles)


CLOSED = {
    "cube": cube,
    "smooth cube": lambda: welded(cube()),
    "chamfered cube": chamfered_cube,
    "cone": cone,
    "torus": torus,
    "bulging cube": lambda: bulging(cube()),
    "bulging chamfered cube": lambda: bulging(chamfered_cube()),
}
