"""Heights of a mesh as it is drawn, and rays against it, thousands a call on the device."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device import layout
from ..device.device import Device, DeviceArray, Kernel
from ..device.scan import exclusive_scan
from .hits import Array, Hits, checked_points, checked_rays
from .mesh import Mesh
from .soundness import sound_mesh

_GROUP: Final = 64
_TRIANGLES_A_BIN: Final = 2.0
_MOST_BINS: Final = 4096  # along a side
_FLOAT: Final = np.float32(2.0**-22)  # how far a float32 outline may be off its place, relative


class MeshQueries:
    """A mesh that can be asked for heights and rays.

    Parameters
    ----------
    mesh : Mesh
        Any; terrain tells the tiles and factors of what is hit.
    device : Device, optional

    Raises
    ------
    InputError
        If the mesh has positions that are not finite or corners that are no vertices.
    DeviceError
        If the device has no 64-bit floats.
    DeviceMemoryError
        If the device cannot hold the mesh and the lists of its triangles.

    Notes
    -----
    Triangles are listed by the bins of a lattice over the mesh, about two a bin; a query looks at
    few of them. Rays are decided as in Woop, Benthin, Wald, *Watertight Ray/Triangle
    Intersection*, JCGT 2(1), 2013, in 64 bits.
    """

    def __init__(self, mesh: Mesh, *, device: Device | None = None) -> None:
        self.mesh = mesh = sound_mesh(mesh)
        self.device = Device.of(device)
        self.device.require_doubles("queries")
        vertices, triangles = mesh.vertices, mesh.triangles
        self._bins, self._low, self._high = _lattice(vertices, len(triangles))
        self.device.require(f"queries of {mesh!r}", vertices.nbytes, triangles.nbytes)
        self._vertices = self.device.array(vertices)
        self._triangles = self.device.array(triangles)
        self._offsets, self._lists = self._listed()
        self._ranges = self._ranged()

    def height_at(self, points: npt.ArrayLike) -> Array:
        """Return the elevations of the mesh at points of the world.

        Parameters
        ----------
        points : array_like, (N, 2)
            World x and y.

        Returns
        -------
        (N,) float64
            The highest where triangles lie above each other; NaN beside the mesh.

        Raises
        ------
        InputError
            If the points are not such, or not finite.
        """
        relative = checked_points(points) - self.mesh.origin[:2]
        # the outline is where float32 could put it: what is on it may be off by as much
        inner = np.clip(relative, self._low, self._high)
        near = np.abs(relative - inner) <= _FLOAT * np.maximum(
            np.abs(self._low), np.abs(self._high)
        )
        relative = np.ascontiguousarray(np.where(near, inner, relative))
        found = self.device.empty(len(relative), np.float64)
        self._kernel("mesh_heights")(
            (len(relative),),
            (_GROUP,),
            count=len(relative),
            bins=self._bins,
            offsets=self._offsets,
            lists=self._lists,
            triangles=self._triangles,
            vertices=self._vertices,
            points=self.device.array(relative),
            found=found,
        )
        elevations: Array = found.host() + self.mesh.origin[2]
        return elevations

    def cast(self, origins: npt.ArrayLike, directions: npt.ArrayLike) -> Hits:
        """Find what rays meet first.

        Parameters
        ----------
        origins, directions : array_like, (N, 3)
            World points, and directions of any length; one of either serves all.

        Returns
        -------
        Hits
            On either side of a triangle; tile -1 and factor NaN where the mesh knows none.

        Raises
        ------
        InputError
            If the rays are not such, not finite, or a direction is zero.
        """
        starts, ways = checked_rays(origins, directions)
        device, count = self.device, len(starts)
        distances, found = device.empty(count, np.float64), device.empty(count, np.int32)
        self._kernel("mesh_rays")(
            (count,),
            (_GROUP,),
            count=count,
            bins=self._bins,
            offsets=self._offsets,
            lists=self._lists,
            ranges=self._ranges,
            triangles=self._triangles,
            vertices=self._vertices,
            origins=device.array(starts - self.mesh.origin),
            directions=device.array(ways),
            ts=distances,
            found=found,
        )
        return self._hits(starts, ways, distances.host(), found.host())

    def _hits(
        self, starts: Array, ways: Array, distance: Array, triangle: npt.NDArray[np.int32]
    ) -> Hits:
        """Say what is known of the triangles that were hit."""
        hit, patches = triangle >= 0, self.mesh.patches
        tile = np.full(len(triangle), -1, np.int32)
        factor = np.full((len(triangle), 2), np.nan, np.float32)
        normal = np.full((len(triangle), 3), np.nan)
        if patches is not None:
            tile[hit] = np.searchsorted(patches.triangle_offsets, triangle[hit], side="right") - 1
            factor[hit] = patches.inside_factors[tile[hit]]
        a, b, c = np.moveaxis(self.mesh.vertices[self.mesh.triangles[triangle[hit]]], 1, 0)
        across = np.cross((b - a).astype(np.float64), (c - a).astype(np.float64))
        normal[hit] = across / np.linalg.norm(across, axis=1, keepdims=True)
        return Hits(starts + distance[:, None] * ways, distance, tile, triangle, factor, normal)

    def _listed(self) -> tuple[DeviceArray, DeviceArray]:
        """Return where the list of each bin begins, and the lists: counted, then filled."""
        device, count = self.device, self._triangles.shape[0]
        bins = int(self._bins["across"]) * int(self._bins["down"])
        shared: dict[str, Any] = {"count": count, "bins": self._bins}
        shared |= {"triangles": self._triangles, "vertices": self._vertices}
        counts = device.zeros(bins, np.uint32)
        self._kernel("count_bins")((count,), (_GROUP,), **shared, counts=counts)
        offsets, total = exclusive_scan(counts)
        device.require(f"{total} entries of triangles in {bins} bins", total * 4)
        lists = device.empty(total, np.int32)
        self._kernel("fill_bins")(
            (count,), (_GROUP,), **shared, offsets=offsets, counts=counts.fill(0), lists=lists
        )
        return offsets, lists

    def _ranged(self) -> DeviceArray:
        """Return the range of heights of each bin."""
        bins = self._offsets.shape[0] - 1
        ranges = self.device.empty((bins, 2), np.float32)
        self._kernel("bin_ranges")(
            (bins,),
            (_GROUP,),
            count=bins,
            offsets=self._offsets,
            lists=self._lists,
            triangles=self._triangles,
            vertices=self._vertices,
            ranges=ranges,
        )
        return ranges

    def _kernel(self, name: str) -> Kernel:
        return self.device.kernel("mesh/queries.cl", name)

    def __repr__(self) -> str:
        return f"MeshQueries({self.mesh!r})"


def _lattice(
    vertices: npt.NDArray[np.float32], triangles: int
) -> tuple[npt.NDArray[Any], npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Return the lattice of bins over vertices, and their lowest and highest x and y."""
    bins = np.zeros((), layout.BINS)
    if not len(vertices):
        bins["across"] = bins["down"] = 1
        return bins, np.zeros(2, np.float32), np.zeros(2, np.float32)
    low, high = vertices[:, :2].min(axis=0), vertices[:, :2].max(axis=0)
    extent = np.maximum((high - low).astype(np.float64), 1e-30)
    # square bins, no more of them along a thin mesh than there are triangles
    wanted = max(triangles / _TRIANGLES_A_BIN, 1.0)
    size = np.sqrt(extent[0] * extent[1] / wanted)
    counts = np.clip(np.ceil(extent / max(size, extent.max() / wanted)), 1, _MOST_BINS)
    # rounded down, so that the farthest vertex stays within the last bin
    per = np.nextafter((counts / extent).astype(np.float32), np.float32(0))
    bins["across"], bins["down"] = counts
    bins["low_x"], bins["low_y"] = low
    bins["per_x"], bins["per_y"] = per
    return bins, low, high
