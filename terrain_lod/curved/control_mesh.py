"""Control meshes of Catmull-Clark surfaces: polygons, half-edges, and a step of subdivision."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arguments import array, items
from ..errors import InputError
from ..files.meshes.readers import mesh_file, read

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, init=False)
class ControlMesh:
    """Polygons that shape a smooth surface.

    Parameters
    ----------
    vertices : (V, 3) array_like
    faces : (F, N) array_like, or sequence of sequences of int
        Corners, counter-clockwise seen from outside; three or more a face.
    creases : (C, 2) array_like, optional
        Pairs of vertices whose edge stays sharp. Outlines are sharp anyhow, and a vertex stays
        where three sharp edges meet, or where it has one face only.

    Raises
    ------
    InputError
        If vertices are not finite points, a face has fewer than three corners, one of them twice or
        one that is no vertex, or a crease is no edge.
    """

    vertices: Array
    faces: tuple[tuple[int, ...], ...]
    creases: Indices

    def __init__(
        self,
        vertices: npt.ArrayLike,
        faces: Iterable[Iterable[int]],
        creases: npt.ArrayLike = (),
    ) -> None:
        vertices = array("vertices", vertices, ("V", 3))
        corners = tuple(tuple(array("corners of a face", face, ("N",), np.int64).tolist())
                        for face in items("faces", faces))  # fmt: skip
        for number, face in enumerate(corners):
            if len(face) < 3 or len(set(face)) < len(face):
                raise InputError(f"expected three or more different corners, got {face} as face "
                                 f"{number}")  # fmt: skip
            if not 0 <= min(face) <= max(face) < len(vertices):
                raise InputError(f"expected corners below {len(vertices)}, got {face} as face "
                                 f"{number}")  # fmt: skip
        creases = array("creases", creases, ("C", ...), np.int64)
        creases = array("creases", creases if creases.size else creases.reshape(0, 2), ("C", 2),
                        np.int64)  # fmt: skip
        known = {(a, b) for face in corners for a, b in _sides(face)}
        for a, b in creases.tolist():
            if (a, b) not in known and (b, a) not in known:
                raise InputError(f"expected creases that are edges, got {a} to {b}")
        for name, value in (("vertices", vertices), ("faces", corners), ("creases", creases)):
            object.__setattr__(self, name, value)

    @classmethod
    def load(cls, path: str | Path, creases: npt.ArrayLike = ()) -> ControlMesh:
        """Read the polygons of a mesh file as they are, such as an OBJ file of quads.

        Raises
        ------
        FileError
            If the file cannot be read.
        InputError
            As above.
        """
        raw = read(mesh_file(path))
        # a vertex for each position, whatever normals and texture coordinates it has
        points, place = np.unique(raw.points.astype(np.float64), axis=0, return_inverse=True)
        faces = np.split(place.ravel()[raw.corners], np.cumsum(raw.sizes)[:-1])
        return cls(points, faces, creases)

    def __repr__(self) -> str:
        return f"ControlMesh({len(self.vertices)} vertices, {len(self.faces)} faces)"

    @property
    def quads(self) -> Indices:
        """Corners (F, 4), of a mesh of quads."""
        return np.array(self.faces, np.int64).reshape(-1, 4)

    @property
    def is_quads(self) -> bool:
        return all(len(face) == 4 for face in self.faces)

    def refined(self) -> ControlMesh:
        """Return the mesh after a step of Catmull-Clark subdivision.

        A corner c of a face becomes a quad: the corner, the point of the edge behind it, the face's
        point, the point of the edge before it; faces in order, corners in order.

        Notes
        -----
        Catmull, Clark: *Recursively generated B-spline surfaces on arbitrary topological meshes*,
        1978; sharp edges as in DeRose, Kass, Truong: *Subdivision Surfaces in Character Animation*,
        1998.
        """
        points, rings = self.vertices, Rings.of(self)
        count, ends = len(points), rings.edge_ends
        centres = np.array([points[list(face)].mean(axis=0) for face in self.faces])
        middles = points[ends].mean(axis=1)
        smooth = ~rings.sharp_edges
        between = np.zeros_like(middles)
        np.add.at(between, rings.edges, centres[rings.faces])
        edge_points = np.where(smooth[:, None], (2 * middles + between) / 4, middles)
        # of a smooth vertex (n - 2) / n p + means of its neighbours and of its faces' centres / n
        valence = np.bincount(rings.starts, minlength=count)
        n = np.maximum(valence, 1)[:, None]
        around, faces_around = np.zeros_like(points), np.zeros_like(points)
        np.add.at(around, ends.ravel(), points[ends[:, ::-1]].reshape(-1, 3))
        np.add.at(faces_around, rings.starts, centres[rings.faces])
        moved = (n - 2) / n * points + (around + faces_around) / n**2
        creased = (6 * points + rings.crease_neighbours) / 8
        kept = rings.corners | (valence == 0)
        kind = np.where(kept, 2, np.where(rings.sharp_count >= 2, 1, 0))[:, None]
        vertices = np.choose(kind, [moved, creased, points])
        edge_of = rings.edges + count
        face_of = rings.faces + count + len(ends)
        quads = np.stack([rings.starts, edge_of, face_of, edge_of[rings.before]], axis=1)
        sharp = np.flatnonzero(rings.creased_edges)
        halves = np.stack([ends[sharp], np.repeat(sharp[:, None] + count, 2, axis=1)], axis=2)
        return ControlMesh(
            np.concatenate([vertices, edge_points, centres]), quads.tolist(), halves.reshape(-1, 2)
        )


@dataclass(frozen=True, eq=False)
class Rings:
    """The H half-edges of a control mesh, one a corner of a face, from that corner to the next.

    Attributes
    ----------
    starts, faces : (H,) int64
        The vertex that each begins at, and the face it goes around.
    after, before : (H,) int64
        The next and the previous half-edge of the face.
    twins : (H,) int64
        The half-edge of the face beyond; -1 where there is none, or more than one.
    edges : (H,) int64
        Numbers of the edges.
    edge_ends : (E, 2) int64
    creased_edges, sharp_edges : (E,) bool
        Those that are to be sharp; and with them those that have no two faces.
    sharp_count : (V,) int64
        Sharp edges at each vertex.
    corners : (V,) bool
        Vertices that stay where they are.
    crease_neighbours : (V, 3) float64
        Sums of the other ends of sharp edges.
    """

    starts: Indices
    faces: Indices
    after: Indices
    before: Indices
    twins: Indices
    edges: Indices
    edge_ends: Indices
    creased_edges: npt.NDArray[np.bool_]
    sharp_edges: npt.NDArray[np.bool_]
    sharp_count: Indices
    corners: npt.NDArray[np.bool_]
    crease_neighbours: Array

    @classmethod
    def of(cls, mesh: ControlMesh) -> Rings:
        sizes = np.array([len(face) for face in mesh.faces], np.int64)
        starts = np.array([corner for face in mesh.faces for corner in face], np.int64)
        faces, own = np.repeat(np.arange(len(sizes)), sizes), np.arange(len(starts))
        first = np.repeat(np.cumsum(sizes) - sizes, sizes)
        after = first + (own - first + 1) % sizes[faces]
        before = first + (own - first - 1) % sizes[faces]
        directed = np.stack([starts, starts[after]], axis=1)
        edge_ends, edges = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
        edges, used = edges.ravel(), np.bincount(edges.ravel(), minlength=len(edge_ends))
        # of an edge with two half-edges that run in opposite directions each is the other's twin
        order = np.argsort(edges, kind="stable")
        twins = np.full(len(starts), -1, np.int64)
        pairs = order[np.repeat(used == 2, used)].reshape(-1, 2)
        pairs = pairs[starts[pairs[:, 0]] != starts[pairs[:, 1]]]
        twins[pairs], twins[pairs[:, ::-1]] = pairs[:, ::-1], pairs
        creased = np.zeros(len(edge_ends), bool)
        if len(mesh.creases):
            both = np.concatenate([edge_ends, np.sort(mesh.creases, axis=1)])
            number = np.unique(both, axis=0, return_inverse=True)[1].ravel()
            creased = np.isin(number[: len(edge_ends)], number[len(edge_ends) :])
        alone = np.zeros(len(edge_ends), bool)
        alone[edges[twins < 0]] = True
        sharp, count = creased | alone, len(mesh.vertices)
        sharp_ends = edge_ends[sharp]
        sharp_count = np.bincount(sharp_ends.ravel(), minlength=count)
        neighbours = np.zeros((count, 3))
        np.add.at(neighbours, sharp_ends.ravel(), mesh.vertices[sharp_ends[:, ::-1].ravel()])
        single = np.bincount(starts, minlength=count) == 1
        return cls(
            starts, faces, after, before, twins, edges, edge_ends, creased, sharp, sharp_count,
            (sharp_count > 2) | single, neighbours,
        )  # fmt: skip


def _sides(face: Sequence[Any]) -> Iterable[tuple[Any, Any]]:
    return zip(face, (*face[1:], face[0]), strict=True)
