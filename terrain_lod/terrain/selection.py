"""The hull stage of levels of detail that promise an error: factors from the error ladder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ..arguments import one_of
from ..camera.camera import Camera
from ..device import layout
from ..device.device import DeviceArray, Kernel
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from .buffers import DeviceGround, DeviceLadder
from .measure import measure_patches
from .tiles import DeviceTiles

# how an edge's factor is chosen: by its own error, or from the two tiles' factors
EDGE_RULES: Final = {"edge": 0, "min": 1, "max": 2}

_GROUP: Final = 64

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
    """What a selection works on, and its state.

    Attributes
    ----------
    tiles : DeviceTiles
    ladder : DeviceLadder
        Theirs.
    edge_rule : str
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

    tiles: DeviceTiles
    ladder: DeviceLadder
    edge_rule: str
    allowed: DeviceArray
    share: DeviceArray
    factors: DeviceFactors
    changed: DeviceArray
    measured: DeviceArray

    @classmethod
    def start(
        cls,
        tiles: DeviceTiles,
        camera: Camera | None,
        *,
        metres: float,
        pixels: float,
        edge_rule: str = "edge",
        cull: bool = True,
        weights: DeviceArray | None = None,
    ) -> Selection:
        """Find what each tile is allowed; infinite `metres` or `pixels` are not asked for.

        An error counts as many times as the tile's weight, (P,) float32, says; 1 if not given.
        """
        one_of("edge rule", edge_rule, EDGE_RULES)
        assert tiles.ladder is not None  # who promises has it measured
        device, count = tiles.device, tiles.grid.count
        allowed = device.empty(count, np.float32)
        _kernel(tiles.ground, edge_rule, "allow")(
            (count,),
            (_GROUP,),
            grid=tiles.grid.record(),
            view=tiles.view(camera),
            cull=int(cull),
            metres=metres,
            pixels=pixels,
            details=tiles.analysis.details,
            weights=device.empty(count, np.float32).fill(1.0) if weights is None else weights,
            allowed=allowed,
        )
        return cls(
            tiles,
            tiles.ladder,
            edge_rule,
            allowed,
            share=device.empty(count, np.float32).fill(FIRST_SHARE),
            # no factor is -1: the first choice changes every tile
            factors=DeviceFactors(
                device.empty((count, layout.EDGES), np.float32).fill(-1.0),
                device.empty((count, layout.INSIDES), np.float32).fill(-1.0),
            ),
            changed=device.empty(count, np.uint8),
            measured=device.zeros(count, np.float32),
        )

    def choose(self) -> None:
        """Choose edges, and the cheapest insides beside them, that the shares allow."""
        grid, ladder = self.tiles.grid, self.ladder
        self._kernel("select_edges")(
            (grid.count,),
            (_GROUP,),
            grid=grid.record(),
            edge_share=edge_share(grid.tile),
            allowed=self.allowed,
            share=self.share,
            details=self.tiles.analysis.details,
            errors=ladder.tiles,
            across_errors=ladder.across,
            down_errors=ladder.down,
            edge_factors=self.factors.edge,
            changed=self.changed,
        )
        self._kernel("fit_inside")(
            (grid.count,),
            (_GROUP,),
            **self.tiles.ground.arguments,
            allowed=self.allowed,
            share=self.share,
            measured=self.measured,
            errors=ladder.tiles,
            inner_errors=ladder.inner,
            order=ladder.order,
            edge_factors=self.factors.edge,
            inside_factors=self.factors.inside,
            changed=self.changed,
        )

    def only_changed(self) -> DeviceFactors:
        """Return the factors chosen last with every other tile culled: what is to be measured."""
        edge = self.tiles.device.empty(self.factors.edge.shape, np.float32)
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
        counts = self.tiles.device.zeros(2, np.uint32)
        count = self.tiles.grid.count
        self._kernel("tighten")(
            (count,),
            (_GROUP,),
            patches=count,
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
        measure_patches(self.tiles.patch_set, pattern, self.changed, self.measured)

    def _kernel(self, name: str) -> Kernel:
        return _kernel(self.tiles.ground, self.edge_rule, name)


def _kernel(ground: DeviceGround, edge_rule: str, name: str) -> Kernel:
    defines = {"LEVELS": ground.grid.levels, "EDGE_RULE": EDGE_RULES[edge_rule], **ground.defines}
    return ground.device.kernel("terrain/selection.cl", name, **defines)
