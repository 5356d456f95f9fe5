"""Small meshes that tests draw themselves."""

from __future__ import annotations

import numpy as np

from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.mesh.mesh import Mesh


def mesh_of(vertices, triangles, **fields) -> Mesh:
    """Return a mesh with upright normals."""
    vertices = np.asarray(vertices, np.float32).reshape(-1, 3)
    normals = np.tile(np.float32([0, 0, 1]), (len(vertices), 1))
    return Mesh(vertices, normals, np.asarray(triangles, np.int32).reshape(-1, 3), **fields)


def grid_mesh(ground: Heightmap, step: int = 1) -> Mesh:
    """Return every `step`-th sample and the last, two triangles a cell, row by row.

    ::

        a---b      a, c, b  then  b, c, d: both face up
        |  /|
        | / |
        c---d
    """
    rows, columns = (np.union1d(np.arange(0, n, step), n - 1) for n in ground.shape)
    row, column = np.meshgrid(rows, columns, indexing="ij")
    dx, dy = ground.spacing
    vertices = np.stack([column * dx, -row * dy, ground.heights[row, column]], axis=-1)
    index = np.arange(row.size).reshape(row.shape)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    triangles = np.stack([a, c, b, b, c, d], axis=-1)
    return mesh_of(vertices, triangles, origin=np.array([*ground.origin, ground.base]))


def joined(*meshes: Mesh) -> Mesh:
    """Return meshes of one origin as one, their vertices not shared."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return mesh_of(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate(
            [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=True)]
        ),
        origin=meshes[0].origin,
    )


def unwelded(mesh: Mesh) -> Mesh:
    """Return the mesh with three vertices a triangle."""
    vertices = mesh.vertices[mesh.triangles.ravel()]
    return mesh_of(vertices, np.arange(len(vertices)), origin=mesh.origin)
