"""The hull stage of levels of detail that promise an error: factors from the error ladder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from . import layout
from .arguments import one_of
from .buffers import DeviceAnalysis, DeviceFactors, DeviceGround, DeviceLadder
from .device import DeviceArray
from .grid import TileGrid
from .pattern import DevicePattern

# how an edge's factor is chosen: by its own error, or from the two tiles' factors
EDGE_RULES: Final = {"edge": 0, "min": 1, "max": 2}

_GROUP: Final = 64
_RUNS: Final = 1024  # work-groups on a CPU, each with a run of patches

# the least share of what is allowed that the ladder is still asked for; below it, full resolution
_LEAST_SHARE: Final = 0.05


@dataclass(frozen=True, eq=False)
class Selection:
    """What a selection works on: the terrain's constants, and its state.

    Attributes
    ----------
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
        device = analysis.details.device
        allowed = device.empty(grid.count, np.float32)
        device.kernel("selection.cl", "allow", **_defines(grid, edges))(
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
            grid,
            analysis,
            ladder,
            edges,
            allowed,
            share=device.empty(grid.count, np.float32).fill(1.0),
            # no factor is -1: the first choice changes every tile
            factors=DeviceFactors(
                device.empty((grid.count, layout.EDGES), np.float32).fill(-1.0),
                device.empty((grid.count, layout.INSIDES), np.float32).fill(-1.0),
            ),
            changed=device.empty(grid.count, np.uint8),
            measured=device.zeros(grid.count, np.float32),
        )

    def choose(self) -> None:
        """Choose the cheapest factors that the ladder and the shares allow."""
        device, defines = self.allowed.device, _defines(self.grid, self.edges)
        wanted = device.empty((self.grid.count, layout.INSIDES), np.float32)
        device.kernel("selection.cl", "select_inside", **defines)(
            (self.grid.count,),
            (_GROUP,),
            grid=self.grid.record(),
            allowed=self.allowed,
            share=self.share,
            errors=self.ladder.tiles,
            costs=self.ladder.costs,
            wanted=wanted,
        )
        device.kernel("selection.cl", "select_edges", **defines)(
            (self.grid.count,),
            (_GROUP,),
            grid=self.grid.record(),
            allowed=self.allowed,
            share=self.share,
            details=self.analysis.details,
            across_errors=self.ladder.across,
            down_errors=self.ladder.down,
            wanted=wanted,
            edge_factors=self.factors.edge,
            changed=self.changed,
        )
        device.kernel("selection.cl", "settle_inside", **defines)(
            (self.grid.count,),
            (_GROUP,),
            patches=self.grid.count,
            wanted=wanted,
            edge_factors=self.factors.edge,
            inside_factors=self.factors.inside,
            changed=self.changed,
        )

    def only_changed(self) -> DeviceFactors:
        """Return the factors chosen last with every other tile culled: what is to be measured."""
        edge = self.allowed.device.empty(self.factors.edge.shape, np.float32)
        self.allowed.device.kernel(
            "selection.cl", "only_changed", **_defines(self.grid, self.edges)
        )(
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
        device = self.allowed.device
        counts = device.zeros(2, np.uint32)
        device.kernel("selection.cl", "tighten", **_defines(self.grid, self.edges))(
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

    def measure(self, ground: DeviceGround, pattern: DevicePattern) -> None:
        """Measure the triangles of the tiles that changed, at every sample."""
        device = ground.device
        group = device.group_size(64)
        groups = self.grid.count if device.is_gpu else min(self.grid.count, _RUNS)
        kernel = device.kernel(
            "tile_error.cl", "tile_error", TILE=self.grid.tile, GROUP=group, **ground.defines
        )
        kernel(
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
            offsets=device.empty((pattern.points.shape[0], 2), np.int32),
            point_heights=device.empty(pattern.points.shape[0], np.float32),
            errors=self.measured,
            scratch=group * 4,
        )


def _defines(grid: TileGrid, edges: str) -> dict[str, int]:
    return {"LEVELS": grid.levels, "EDGE_RULE": EDGE_RULES[edges]}
