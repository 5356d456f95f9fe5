"""A mesh that moves: uploaded once, posed again and again on the device."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from ..arguments import array, one_of
from ..device import layout
from ..device.device import Device
from ..mesh.mesh import Mesh
from ..tessellation.tessellator import tessellate_device
from .curved_mesh import CurvedMesh
from .patch_factors import UniformFactor, checked_factor
from .patched_mesh import PatchedMesh, require_curvable, unit_normals
from .pn import edge_factors_on_device, evaluate_on_device, nets_on_device, patch_factors_on_device
from .smooth import diagonal_of, from_device


class PosedMesh:
    """PN-triangles of a mesh whose vertices move while its triangles stay.

    What meets at an edge, the pattern and its triangles are found once. A pose uploads vertices and
    normals, and makes control nets and points of them.

    Parameters
    ----------
    mesh : Mesh
        As it rests. Vertices in one place stay in one place, so that a closed mesh stays closed.
    factor : float, optional
        Segments of all edges, 1 to 64.
    partitioning : {"fractional_odd", "fractional_even", "integer", "pow2"}, optional
    device : Device, optional

    Raises
    ------
    InputError
        If the mesh is empty or not sound, or the factor or the word is none.
    DeviceMemoryError
        If the device cannot hold the mesh.

    Examples
    --------
    >>> figure = PosedMesh(mesh, factor=5)                          # doctest: +SKIP
    >>> frame = figure.pose(mesh.vertices * (1, 1, 1.1), mesh.normals)      # doctest: +SKIP
    """

    def __init__(
        self,
        mesh: Mesh,
        *,
        factor: float = 5.0,
        partitioning: str = "fractional_odd",
        device: Device | None = None,
    ) -> None:
        require_curvable(mesh)
        one_of("partitioning", partitioning, layout.PARTITIONINGS)
        device = Device.of(device)
        lod, view = UniformFactor(checked_factor("factor", factor)), np.zeros((), layout.VIEW)
        with device.timed() as timeline:
            self._base = PatchedMesh.upload(mesh, device)
            patches, nets = self._base.patches, self._base.nets
            of_edges = edge_factors_on_device(patches, lod, diagonal_of(mesh), view)
            factors = patch_factors_on_device(
                patches, nets, of_edges, view, cull=False, back_cosine=None
            )
            self._pattern = tessellate_device(
                "triangle", factors.edge, factors.inside, partitioning, clockwise=True
            )
            vertices = evaluate_on_device(nets, self._pattern)
            self._rest = from_device(mesh, self._pattern, vertices, timeline)
        # of all vertices in a place the first
        corners = self._base.adjacency.patches
        self._first = np.arange(len(mesh.vertices))
        self._first[corners[:, :3]] = corners[:, layout.PATCH_DOMINANT :]

    def __repr__(self) -> str:
        return f"PosedMesh({len(self._first)} vertices, {self._rest!r})"

    @property
    def rest(self) -> CurvedMesh:
        """The mesh before any pose."""
        return self._rest

    def pose(self, vertices: npt.ArrayLike, normals: npt.ArrayLike) -> CurvedMesh:
        """Return the curved mesh of the vertices where they are now.

        Parameters
        ----------
        vertices, normals : (V, 3) array_like
            Of the mesh's vertices, relative to its origin; normals of any length. Of vertices that
            rest in one place, the first says where that goes.

        Raises
        ------
        InputError
            If there are not as many as the mesh has vertices, or some are not finite.
        """
        places, directions = (
            self._checked(name, each)
            for name, each in (("vertices", vertices), ("normals", normals))
        )
        patches = self._base.patches
        with patches.device.timed() as timeline:
            patches.positions.write(np.ascontiguousarray(places[self._first]))
            patches.normals.write(unit_normals(directions))
            made = evaluate_on_device(nets_on_device(patches), self._pattern)
            return replace(
                self._rest,
                vertices=made.positions.host(),
                normals=made.normals.host(),
                timings=timeline.seconds,
            )

    def _checked(self, name: str, values: npt.ArrayLike) -> npt.NDArray[np.float32]:
        shape = (len(self._first), 3)
        return array(name, values, shape, np.float32)
