"""One chunk of a store on a device: a terrain of its own, and what lies between its samples."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device.device import Device
from ..ground.heightmap import Heightmap
from ..ground.relief import Relief
from ..mesh.mesh import Mesh
from ..pyramid.codes import decode
from ..pyramid.division import NODE
from ..pyramid.drift import gathered
from ..pyramid.store import Store
from ..terrain.buffers import DeviceGround
from ..terrain.lod import PromiseLod
from ..terrain.lod_promises import MaxErrorLod, ScreenErrorLod
from ..terrain.terrain import Terrain
from .cut import Place
from .made import Made
from .piece import EAST, NORTH, SOUTH, WEST, Piece, clipped
from .view import Asked, Boxes

# bytes a sample of a chunk on a device and beside it: heights, the errors of all patterns of all
# nodes, and what is known of them
_BYTES: Final = 24
# a mesh's vertices are in floats of a chunk, and so known to this part of it
_GROUP: Final = 64


def window_bytes(chunk: int) -> int:
    """Return how many bytes a chunk takes while it is held."""
    return _BYTES * (chunk + 1) ** 2


@dataclass(frozen=True, eq=False)
class Window:
    """A chunk that is held.

    Attributes
    ----------
    store : Store
    place : Place
    terrain : Terrain
        Of the chunk's lattice, as if there were no other samples.
    lattice : DeviceGround
        The lattice by itself.
    drift : list of (NR, NC) float32
        How far all samples are from the lattice, in squares of 1, 2, 4 ... nodes.
    """

    store: Store
    place: Place
    terrain: Terrain
    lattice: DeviceGround
    drift: list[npt.NDArray[Any]]

    @classmethod
    def of(cls, store: Store, place: Place, device: Device) -> Window:
        """Read a chunk that has data, and put it on a device."""
        own, (level, row, column) = store.description, place
        stride, (dx, dy), (x0, y0) = 1 << level, own.spacing, own.origin
        size = store.division.chunk * stride
        ground = Heightmap(
            store.heights(*place),
            spacing=(dx * stride, dy * stride),
            origin=(x0 + column * size * dx, y0 - row * size * dy),
            base=own.base,
            crs=own.crs,
            units=own.units,
            name=own.name,
        )
        drift = [decode(store.nodes(*place).errors[..., 0])]
        while max(drift[-1].shape) > 1:
            drift.append(gathered(drift[-1], 1))
        lattice = DeviceGround.upload(Relief(ground), NODE, device)
        return cls(store, place, Terrain(ground, tile=NODE, device=device), lattice, drift)

    def made(self, asked: Asked, share: float) -> Made:
        """Mesh the chunk for a share of an error, and say how far it is from all samples."""
        lod = _part_of(asked, share)
        mesh = self.terrain.mesh(asked.camera, lod=lod, partitioning="integer", cull=asked.cull)
        patches = mesh.patches
        assert patches is not None  # of a terrain
        own, (level, row, column) = self.store.description, self.place
        stride, (dx, dy) = 1 << level, self.terrain.ground.spacing
        first = np.array([column, row]) * self.store.division.chunk * stride
        rows, columns = self.terrain.ground.shape
        ends = first + np.array([columns - 1, rows - 1]) * stride
        inside = mesh.vertices[:, :2].astype(np.float64) / [dx, -dy]
        places = first + inside * stride
        sides = float(first[0]), float(first[1]), float(ends[0]), float(ends[1])
        errors, boxes = self._judged(asked, lod, mesh, inside)
        piece = Piece(
            level,
            sides,
            self._lines(),
            places,
            mesh.vertices[:, 2].astype(np.float64),
            mesh.normals,
            mesh.triangles,
            np.repeat(np.arange(patches.count, dtype=np.int32), np.diff(patches.point_offsets)),
            mesh.triangle_patches,
            errors,
            np.zeros(patches.count, bool),
            asked.allowed(boxes),
        )
        for side, axis in ((WEST, 0), (NORTH, 1), (EAST, 0), (SOUTH, 1)):
            places[piece.on(side), axis] = sides[side]
        for axis, end in enumerate((own.columns - 1, own.rows - 1)):
            piece = clipped(piece, axis, float(end))
        return Made(asked, share, piece, mesh, boxes)

    def _lines(self) -> tuple[npt.NDArray[np.float32], ...]:
        """Return the heights along the sides: west, north, east, south."""
        heights = self.terrain.ground.heights
        return heights[:, 0], heights[0], heights[:, -1], heights[-1]

    def _judged(
        self, asked: Asked, lod: PromiseLod, mesh: Mesh, inside: npt.NDArray[np.float64]
    ) -> tuple[npt.NDArray[np.float64], Boxes]:
        """Return for each patch how far it may be from any sample, and a box around these."""
        patches, achieved = mesh.patches, mesh.achieved
        assert patches is not None
        assert achieved is not None
        boxes, drawn = self._boxes(mesh), patches.drawn
        errors = np.zeros(patches.count)
        if self.place[0] == 0:
            # the engine measured every sample: as a part of what each patch was asked for
            within = np.full(patches.count, achieved.metres)
            if achieved.pixels is not None:
                share = achieved.pixels / lod.pixels
                seen = replace(asked, metres=np.inf, pixels=lod.pixels).allowed(boxes)
                within = np.minimum(within, share * seen)
            errors[drawn] = within[drawn]
        elif drawn.any():
            between = self._between(inside, mesh.vertices[:, 2], mesh.triangles)
            errors[drawn] = np.maximum.reduceat(between, patches.triangle_offsets[:-1][drawn])
            errors[drawn] += self._drift_of(patches.areas[drawn])
        return errors, boxes.taller(errors)

    def _drift_of(self, areas: npt.NDArray[np.int32]) -> npt.NDArray[np.float64]:
        """Return how far all samples of patches are from the lattice."""
        top, left, down, across = areas.T
        nodes = -(-np.maximum(down, across) // NODE)
        level = np.minimum(np.ceil(np.log2(nodes)).astype(int), len(self.drift) - 1)
        found = np.zeros(len(areas))
        for number, drift in enumerate(self.drift):
            these, size = level == number, NODE << number
            found[these] = drift[top[these] // size, left[these] // size]
        return found

    def measured(self, piece: Piece, mesh: Mesh) -> Piece:
        """Return a joined piece with the errors of what was moved measured on its triangles."""
        assert mesh.patches is not None
        changed = piece.moved[piece.patch_of_triangle]
        if not changed.any():
            return piece
        level, row, column = self.place
        first = np.array([column, row]) * self.store.division.chunk
        inside = piece.places / (1 << level) - first
        between = self._between(inside, piece.heights, piece.triangles[changed])
        errors = np.where(piece.moved, 0.0, piece.errors)
        np.maximum.at(errors, piece.patch_of_triangle[changed], between)
        errors[piece.moved] += self._drift_of(mesh.patches.areas[piece.moved])
        return replace(piece, errors=errors)

    def _between(
        self,
        inside: npt.NDArray[np.float64],
        heights: npt.NDArray[Any],
        triangles: npt.NDArray[np.int32],
    ) -> npt.NDArray[np.float64]:
        """Return how far each triangle is from the lattice's surface; (T,)."""
        device, count = self.lattice.device, len(triangles)
        points = np.ones((len(inside), 4), np.float32)
        points[:, :2], points[:, 2] = inside, heights
        errors = device.empty(count, np.float32)
        group = device.group_size(_GROUP)
        kernel = device.kernel(
            "streaming/between.cl", "between", GROUP=group, **self.lattice.defines
        )
        kernel(
            (count,),
            (group,),
            **self.lattice.arguments,
            is_full=int(self.place[0] == 0),
            count=count,
            points=device.array(points),
            triangles=device.array(np.ascontiguousarray(triangles)),
            errors=errors,
        )
        return errors.host().astype(np.float64)

    def _boxes(self, mesh: Mesh) -> Boxes:
        """Return boxes around the patches of a mesh of this chunk, all their samples included."""
        patches = mesh.patches
        assert patches is not None
        (dx, dy), (x0, y0, base) = self.terrain.ground.spacing, self.terrain.origin
        top, left, down, across = patches.areas.T
        low, high = self.terrain.ground.height_range
        lowest, highest = np.full(patches.count, low - base), np.full(patches.count, high - base)
        drawn = patches.drawn
        if drawn.any():
            starts = patches.point_offsets[:-1][drawn]
            lowest[drawn] = np.minimum.reduceat(mesh.vertices[:, 2], starts)
            highest[drawn] = np.maximum.reduceat(mesh.vertices[:, 2], starts)
        return Boxes(
            np.stack([x0 + left * dx, y0 - (top + down) * dy, lowest + base], axis=-1),
            np.stack([x0 + (left + across) * dx, y0 - top * dy, highest + base], axis=-1),
        )


def _part_of(asked: Asked, share: float) -> PromiseLod:
    """Return a part of the error that is asked for, as a level of detail."""
    if asked.camera is not None and not np.isinf(asked.pixels):
        return ScreenErrorLod(pixels=asked.pixels * share)
    return MaxErrorLod(metres=asked.metres * share)
