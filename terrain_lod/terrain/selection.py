"""The hull stage of levels of detail that promise an error: factors from the error ladder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import one_of
from ..device import layout
from ..device.device import DeviceArray, Kernel
from ..ground.grid import TileGrid
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from .buffers import DeviceAnalysis, DeviceGround, DeviceLadder

# how an edge's factor is chosen: by its own error, or from the two tiles' factors
EDGE_RULES: Final = {"edge": 0, "min": 1, "max": 2}

_GROUP: Final = 64
_RUNS: Final = 1024  # work-groups on a CPU, each with a run of patches

# what the ladder predicts differs from what is measured by roundings, of places above all
FIRST_SHARE: Final = 0.998

# the least share of what is allowed that the ladder is still asked for; below it, full resolution
_LEAST_SHARE: Final = 0.05


def edge_share(tile: int) -> float:
    """Return how much of what tiles are allowed their edges may use.

    Coarse edges press an inside closer to them, and where tiles are large an edge's segments are
    few beside an inside's. Found by trial: the fewest triangles at 1 to 30 m of error on the
    bundled ridge and on fractals, with tiles of 7 to 63.
    """
    return min(1.0, float((7 / tile) ** 0.15))


@dataclass(frozen=True, eq=False)
class Selection:
    """What a selection works on: the terrain's constants, and its state.

    Attributes
    ----------
    ground : DeviceGround
    grid : TileGrid
    analysis : DeviceAnalysis
    ladder : DeviceLadder
    edges : str
        A key of :data:`EDGE_RULES`.
    allowed : DeviceArray, (P,) float32
        Error that each tile may have; NaN where it is culled.
    share : DeviceArray, (P,) float32
        Of that, what the ladder may use.
    factors : DeviceFactors
        As chosen last.
    changed : DeviceArray, (P,) uint8
        Whether a tile's factors were changed by the last choice.
    measured : DeviceArray, (P,) float32
        Error of each tile's triangles.
    """

    ground: DeviceGround
    grid: TileGrid
    analysis: DeviceAnalysis
    ladder: DeviceLadder
    edges: str
    allowed: DeviceArray
    share: DeviceArray
    factors: DeviceFactors
    changed: DeviceArray
    measured: DeviceArray

    @classmethod
    def start(
        cls,
        ground: DeviceGround,
        grid: TileGrid,
        analysis: DeviceAnalysis,
        ladder: DeviceLadder,
        view: npt.NDArray[Any],
        *,
        metres: float,
        pixels: float,
        edges: str = "edge",
        cull: bool = True,
        weights: DeviceArray | None = None,
    ) -> Selection:
        """Find what each tile is allowed; infinite `metres` or `pixels` are not asked for.

        An error counts as many times as the tile's weight, (P,) float32, says; 1 if not given.
        """
        one_of("edge rule", edges, EDGE_RULES)
        device = ground.device
        allowed = device.empty(grid.count, np.float32)
        _kernel(ground, grid, edges, "allow")(
            (grid.count,),
            (_GROUP,),
            grid=grid.record(),
            view=view,
            cull=int(cull),
            metres=metres,
            pixels=pixels,
            details=analysis.details,
            weights=device.empty(grid.count, np.float32).fill(1.0) if weights is None else weights,
            allowed=allowed,
        )
        return cls(
            ground,
            grid,
            analysis,
            ladder,
            edges,
            allowed,
            share=device.empty(grid.count, np.float32).fill(FIRST_SHARE),
            # no factor is -1: the first choice changes every tile
            factors=DeviceFactors(
                device.empty((grid.count, layout.EDGES), np.float32).fill(-1.0),
                device.empty((grid.count, layout.INSIDES), np.float32).fill(-1.0),
            ),
            changed=device.empty(grid.count, np.uint8),
            measured=device.zeros(grid.count, np.float32),
        )

    def choose(self) -> None:
        """Choose edges, and the cheapest insides beside them, that the shares allow."""
        self._kernel("select_edges")(
            (self.grid.count,),
            (_GROUP,),
            grid=self.grid.record(),
            edge_share=edge_share(self.grid.tile),
            allowed=self.allowed,
            share=self.share,
            details=self.analysis.details,
            errors=self.ladder.tiles,
            across_errors=self.ladder.across,
            down_errors=self.ladder.down,
            edge_factors=self.factors.edge,
            changed=self.changed,
        )
        self._kernel("fit_inside")(
            (self.grid.count,),
            (_GROUP,),
            grid=self.grid.record(),
            **self.ground.arguments,
            allowed=self.allowed,
            share=self.share,
            measured=self.measured,
            errors=self.ladder.tiles,
            inner_errors=self.ladder.inner,
            order=self.ladder.order,
            edge_factors=self.factors.edge,
            inside_factors=self.factors.inside,
            changed=self.changed,
        )

    def only_changed(self) -> DeviceFactors:
        """Return the factors chosen last with every other tile culled: what is to be measured."""
        edge = self.ground.device.empty(self.factors.edge.shape, np.float32)
        self._kernel("only_changed")(
            (edge.size,),
            (_GROUP,),
            count=edge.size,
            changed=self.changed,
            edge_factors=self.factors.edge,
            kept_factors=edge,
        )
        return DeviceFactors(edge, self.factors.inside)

    def tighten(self) -> tuple[int, int]:
        """Give tiles that exceed a smaller share.

        Returns
        -------
        exceeding, refinable : int
            Tiles that exceed, and those of them that were not meshed in full yet.
        """
        counts = self.ground.device.zeros(2, np.uint32)
        self._kernel("tighten")(
            (self.grid.count,),
            (_GROUP,),
            patches=self.grid.count,
            least_share=_LEAST_SHARE,
            allowed=self.allowed,
            measured=self.measured,
            share=self.share,
            counts=counts,
        )
        exceeding, refinable = counts.host()
        return int(exceeding), int(refinable)

    def measure(self, pattern: DevicePattern) -> None:
        """Measure the triangles of the tiles that changed, at every sample."""
        ground, device = self.ground, self.ground.device
        group = device.group_size(64)
        groups = self.grid.count if device.is_gpu else min(self.grid.count, _RUNS)
        defines = {"TILE": self.grid.tile, "GROUP": group, "LANES": device.lanes}
        device.kernel("terrain/tile_error.cl", "tile_error", **defines, **ground.defines)(
            (groups * group,),
            (group,),
            grid=self.grid.record(),
            **ground.arguments,
            patches=self.grid.count,
            changed=self.changed,
            point_offsets=pattern.point_offsets,
            points=pattern.points,
            triangle_offsets=pattern.primitive_offsets,
            triangles=pattern.primitives,
            corners=device.empty((pattern.points.shape[0], 4), np.float32),
            errors=self.measured,
            scratch=group * 4,
        )

    def _kernel(self, name: str) -> Kernel:
        return _kernel(self.ground, self.grid, self.edges, name)


def _kernel(ground: DeviceGround, grid: TileGrid, edges: str, name: str) -> Kernel:
    defines = {"LEVELS": grid.levels, "EDGE_RULE": EDGE_RULES[edges], **ground.defines}
    return ground.device.kernel("terrain/selection.cl", name, **defines)
