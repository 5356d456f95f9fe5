"""Tangents of textured meshes, after MikkTSpace.

M. Mikkelsen: *Simulation of Wrinkled Surfaces Revisited*, 2008, and its ``mikktspace``: a vertex's
tangent is the mean, weighted by angle, of the directions of u in the triangles around it, each laid
into the plane of the vertex's normal.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from .mesh import Mesh
from .open_edges import weld

Array = npt.NDArray[np.float64]


def with_tangents(mesh: Mesh) -> tuple[Mesh, npt.NDArray[np.float32]]:
    """Return a textured mesh whose triangles at a vertex are not mirrored to each other.

    Parameters
    ----------
    mesh : Mesh
        With texture coordinates.

    Returns
    -------
    mesh : Mesh
        With more vertices where the texture is mirrored: they are split there.
    tangents : (V, 4) float32
        Unit, across the vertex's normal, and 1 or -1: see :class:`NormalMap`. Where the texture has
        no direction, any tangent.
    """
    textures = _textures(mesh)[mesh.triangles].astype(np.float64)
    du, dv = (textures[:, side] - textures[:, :1].squeeze(1) for side in (1, 2))
    mirrored = du[:, 0] * dv[:, 1] - du[:, 1] * dv[:, 0] < 0
    mesh, mirrored_vertices = _split(mesh, mirrored)
    points = mesh.vertices[mesh.triangles].astype(np.float64)
    normals = mesh.normals[mesh.triangles].astype(np.float64)
    one, two = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    along = np.where(mirrored, -1, 1)[:, None] * (dv[:, 1:] * one - du[:, 1:] * two)
    sums = np.zeros((len(mesh.vertices), 3))
    kinds = _kinds(mesh, mirrored_vertices)
    for corner in range(3):
        normal = normals[:, corner]
        before, after = (
            _unit(_across(points[:, (corner + step) % 3] - points[:, corner], normal))
            for step in (1, 2)
        )
        angles = np.arccos(np.clip((before * after).sum(axis=1), -1, 1))
        way = angles[:, None] * _unit(_across(along, normal))
        for axis in range(3):
            sums[:, axis] += np.bincount(
                kinds[mesh.triangles[:, corner]], way[:, axis], minlength=len(sums)
            )
    unit = mesh.normals.astype(np.float64)
    tangents = _unit(_across(sums[kinds], unit))
    lost = ~tangents.any(axis=1)
    least = np.eye(3)[np.abs(unit[lost]).argmin(axis=1)]
    tangents[lost] = _unit(_across(least, unit[lost]))
    hands = np.where(mirrored_vertices, -1.0, 1.0)
    return mesh, np.column_stack([tangents, hands]).astype(np.float32)


def _textures(mesh: Mesh) -> npt.NDArray[np.float32]:
    assert mesh.textures is not None
    return mesh.textures


def _split(mesh: Mesh, mirrored: npt.NDArray[np.bool_]) -> tuple[Mesh, npt.NDArray[np.bool_]]:
    """Return a mesh without vertices of both hands, and which vertices are mirrored."""
    hands = [np.zeros(len(mesh.vertices), bool) for _ in range(2)]
    for hand, of_hand in enumerate(hands):
        of_hand[mesh.triangles[mirrored == hand]] = True
    both = np.flatnonzero(hands[0] & hands[1])
    if not len(both):
        return mesh, hands[1]
    place = np.arange(len(mesh.vertices), dtype=np.int32)
    place[both] = len(place) + np.arange(len(both))
    triangles = mesh.triangles.copy()
    triangles[mirrored] = place[triangles[mirrored]]
    grown: dict[str, Any] = {
        name: np.concatenate([values, values[both]])
        for name, values in (
            ("vertices", mesh.vertices),
            ("normals", mesh.normals),
            ("textures", _textures(mesh)),
        )
    }
    hands[1][both] = False
    of_vertices = np.concatenate([hands[1], np.ones(len(both), bool)])
    return replace(mesh, triangles=triangles, patches=None, normal_map=None, **grown), of_vertices


def _kinds(mesh: Mesh, mirrored: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """Return the same number below V for vertices that are alike in all that tangents need."""
    rows = np.stack(
        [weld(mesh.vertices), weld(mesh.normals), weld(_textures(mesh)), mirrored.astype(np.int64)],
        axis=1,
    )
    _, kinds = np.unique(rows, axis=0, return_inverse=True)
    return kinds.reshape(-1)


def _across(vectors: Array, normals: Array) -> Array:
    """Return what of `vectors` is across unit `normals`."""
    rest: Array = vectors - normals * (vectors * normals).sum(axis=1, keepdims=True)
    return rest


def _unit(vectors: Array) -> Array:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    unit: Array = np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)
    return unit
