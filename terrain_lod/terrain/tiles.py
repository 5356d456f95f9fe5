"""Ground on the device, cut into tiles, and what is known of each: the record that stages share."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera
from ..device import layout
from ..device.device import Device, DeviceArray
from ..ground.grid import TileGrid
from ..ground.heightmap import Heightmap
from ..ground.relief import Relief
from .analysis import TileAnalysis, analyse_on_device, analyse_tiles
from .buffers import DeviceAnalysis, DeviceGround, DeviceLadder, DevicePatches, PatchSet
from .control_points import control_points_on_device, patches_on_device
from .ladder import ladder_on_device, measure_tiles
from .leaves import Drawn
from .lod import Scene
from .quadtree import DeviceQuadtree


@dataclass(frozen=True, eq=False)
class DeviceTiles:
    """The P tiles of a ground.

    Attributes
    ----------
    ground : DeviceGround
        Samples, and the grid that cuts them.
    analysis : DeviceAnalysis
        Planes, deviations and ranges.
    made_patches : DevicePatches or None
        :attr:`patches`, where they have been made.
    ladder : DeviceLadder or None
        Errors, which promises of tiles are kept with; None until the first one asks.
    tree : DeviceQuadtree or None
        What promises of patches of every size are kept with; likewise.
    """

    ground: DeviceGround
    analysis: DeviceAnalysis
    made_patches: DevicePatches | None = None
    ladder: DeviceLadder | None = None
    tree: DeviceQuadtree | None = None

    @classmethod
    def of(cls, ground: DeviceGround, *, plane: str = "least_squares") -> DeviceTiles:
        """Analyse every tile."""
        analysis = analyse_on_device(ground, plane=plane)
        return cls(ground, analysis)

    @cached_property
    def patches(self) -> DevicePatches:
        """What the hull stage of formulas takes, made when the first one asks."""
        return self.made_patches or patches_on_device(self.ground, self.analysis)

    def _with(self, **changes: Any) -> DeviceTiles:
        """Return the same with more that is known."""
        return replace(
            self, made_patches=self.__dict__.get("patches", self.made_patches), **changes
        )

    def with_ladder(self) -> DeviceTiles:
        """Return the same with every error measured."""
        if self.ladder is not None:
            return self
        return self._with(ladder=ladder_on_device(self.ground, self.analysis))

    def with_tree(self, levels: int | None) -> DeviceTiles:
        """Return the same with a quadtree over them, of at most so many levels."""
        if self.tree is not None:
            return self
        return self._with(tree=DeviceQuadtree.of(self.ground, self.analysis, levels))

    def updated(self, ground: Heightmap, rows: slice, columns: slice) -> tuple[DeviceTiles, int]:
        """Rewrite the tiles for another heightmap, and say how many were looked at anew.

        It differs in these samples alone, start and stop given. The arrays are rewritten where
        they stand: nobody else may use this record from now on, but on an error, when all is as
        it was.
        """
        relief = Relief(ground, self.ground.relief.detail)
        changed = self.grid.touching(*relief.touching(rows, columns))
        before = self._before(rows, changed)
        try:
            uploaded = self.ground.updated(relief, rows)
            analyse_tiles(uploaded, self.analysis, changed)
            # corners without data stand at the lowest height there is: all of them may move
            patches = self._with().made_patches
            if patches is not None:
                points = control_points_on_device(uploaded, self.analysis)
                patches = replace(patches, control_points=points)
            if self.ladder is not None:
                measure_tiles(uploaded, self.analysis, self.ladder, changed)
            tree = self.tree and self.tree.updated(uploaded, self.analysis, changed)
            self.device.finish()  # what fails there fails here
        except BaseException:
            for array, first, values in before:
                array.paste(values, first)
            raise
        return DeviceTiles(uploaded, self.analysis, patches, self.ladder, tree), len(changed)

    def _before(
        self, rows: slice, changed: npt.NDArray[np.int32]
    ) -> list[tuple[DeviceArray, int, DeviceArray]]:
        """Return what an update may overwrite: arrays, the first row of each, and rows from it."""
        across = self.grid.shape[1]
        top, bottom = int(changed[0]) // across, int(changed[-1]) // across + 1
        parts = [
            (self.ground.heights, rows.start, rows.stop),
            (self.analysis.planes, top, bottom),
            (self.analysis.details, top, bottom),
        ]
        if self.ground.masked:
            parts.append((self.ground.holes, rows.start, rows.stop))
        if self.ladder is not None:
            parts += [
                (self.ladder.tiles, top * across, bottom * across),
                (self.ladder.inner, top * across, bottom * across),
                (self.ladder.across, top * across, (bottom + 1) * across),
                (self.ladder.down, top * (across + 1), bottom * (across + 1)),
            ]
        return [(array, first, array.copy(first, end)) for array, first, end in parts]

    @property
    def patch_set(self) -> PatchSet:
        """The tiles as patches, as the stages after the hull see them."""
        header = "terrain/patch_tiles.h"
        return PatchSet(self.ground, header, self.grid.count, {}, self.analysis.details)

    @property
    def device(self) -> Device:
        return self.ground.device

    @property
    def grid(self) -> TileGrid:
        return self.ground.grid

    def view(self, camera: Camera | None) -> npt.NDArray[Any]:
        """Return the ``layout.VIEW`` record of a camera, all zero where there is none."""
        return np.zeros((), layout.VIEW) if camera is None else camera.view(self.ground.origin)

    @cached_property
    def found(self) -> TileAnalysis:
        """The analysis, brought down."""
        return TileAnalysis.of(self.grid, self.analysis)

    def described(
        self, drawn: Drawn | None
    ) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.float32]]:
        """Return areas and deviations of patches: leaves of the tree, or all tiles."""
        if drawn is None:
            return self.grid.areas, self.found.deviation.ravel()
        return drawn.areas, drawn.deviation

    @cached_property
    def scene(self) -> Scene:
        """What levels of detail take their defaults from."""
        low = float(np.nanmin(self.found.minimum))
        high = float(np.nanmax(self.found.maximum))
        known = self.found.deviation[~np.isnan(self.found.deviation)]
        return Scene(
            diagonal=float(np.hypot(np.hypot(*self.grid.extent), high - low)),
            rough_deviation=float(np.percentile(known, 98)),
            tile=self.grid.tile,
        )
