"""What a comparison tries: every level of detail and every peer, over a sweep of its parameter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from ...device.layout import PARTITIONINGS
from ...ground.heightmap import Heightmap
from ...terrain.lod import (
    BudgetLod,
    CoplanarityLod,
    DistanceLod,
    Lod,
    MaxErrorLod,
    PromiseLod,
    ScreenErrorLod,
    UniformLod,
)
from .peers import PEERS, Peer

TILES: Final = (7, 15, 31, 63)

# vertical errors asked for, in shares of the height range
_METRES: Final = (0.0005, 0.002, 0.008, 0.03)
_PIXELS: Final = (0.5, 1.0, 2.0, 4.0)
_FACTORS: Final = (0.2, 0.4, 0.7, 1.0)  # of a tile's cells
_BUDGETS: Final = (4, 10, 30)  # triangles a tile
_SHARES: Final = (0.01, 0.03, 0.1)
_STEPS: Final = (2, 4, 8, 16)


@dataclass(frozen=True)
class Contender:
    """One maker of meshes at one value of its parameter.

    Attributes
    ----------
    family : str
        The level of detail's or the peer's name.
    parameter : float
    unit : str
        Of the parameter: ``"m"``, ``"pixels"``, ``"triangles"``, ``"segments"``, ``"share"`` or
        ``"samples"``.
    lod : Lod, PromiseLod or None
    peer : Peer or None
        One of the two is there.
    edges, partitioning : str
    tile : int
        Cells; these three say nothing of a peer.
    symbol : str
        What people read for ``"m"``: the symbol of the ground's unit.
    """

    family: str
    parameter: float
    unit: str
    lod: Lod | PromiseLod | None = field(default=None, repr=False)
    peer: Peer | None = field(default=None, repr=False)
    edges: str = ""
    partitioning: str = "fractional_odd"
    tile: int = 0
    symbol: str = "m"

    @property
    def is_static(self) -> bool:
        """Whether one mesh serves all cameras."""
        return isinstance(self.lod, MaxErrorLod | UniformLod | None)

    @property
    def asked_metres(self) -> float | None:
        return self.parameter if self.unit == "m" else None

    @property
    def asked_pixels(self) -> float | None:
        return self.parameter if self.unit == "pixels" else None

    @property
    def label(self) -> str:
        """What people read: ``"MaxErrorLod 5 m, edge"``."""
        unit = {"share": "×", "m": self.symbol}.get(self.unit, self.unit)
        return f"{self.family} {self.parameter:,g} {unit}" + (self.edges and f", {self.edges}")


def tolerances(ground: Heightmap) -> tuple[float, ...]:
    """Return the vertical errors to ask for, rounded to one digit; at least 1 mm."""
    low, high = ground.height_range
    asked = (max(share * (high - low), 1e-3) for share in _METRES)
    return tuple(dict.fromkeys(float(f"{metres:.0e}") for metres in asked))


def installed(peers: Sequence[Peer] = PEERS) -> tuple[list[Peer], list[str]]:
    """Return the peers that are installed, and the names of those that are not."""
    return (
        [peer for peer in peers if peer.is_installed],
        [peer.name for peer in peers if not peer.is_installed],
    )


def contenders(ground: Heightmap, tile: int) -> list[Contender]:
    """Return everything that the sweep of `ground` tries at one tile size."""
    symbol = ground.unit_symbols[1]
    return [replace(one, symbol=symbol) for one in (*_ours(ground, tile), *_theirs(ground))]


def _ours(ground: Heightmap, tile: int) -> Iterator[Contender]:
    def ours(lod: Lod | PromiseLod, parameter: float, unit: str, edges: str) -> Contender:
        return Contender(type(lod).__name__, parameter, unit, lod, edges=edges, tile=tile)

    cells = (max(1.0, round(share * tile)) for share in _FACTORS)
    factors = tuple(dict.fromkeys(cells))
    for factor in factors:
        yield ours(UniformLod(factor), factor, "segments", "min")
    for formula in (DistanceLod, CoplanarityLod):
        for edges in ("min", "max"):
            for factor in factors:
                yield ours(formula(maximum=factor), factor, "segments", edges)
    tiles = int(np.prod([-(-(extent - 1) // tile) for extent in ground.shape]))
    for edges in ("edge", "min", "max"):
        for metres in tolerances(ground):
            yield ours(MaxErrorLod(metres), metres, "m", edges)
        for pixels in _PIXELS:
            yield ours(ScreenErrorLod(pixels), pixels, "pixels", edges)
    for budget in (tiles * each for each in _BUDGETS):
        yield ours(BudgetLod(budget), budget, "triangles", "edge")


def _theirs(ground: Heightmap) -> Iterator[Contender]:
    asked = {"m": tolerances(ground), "share": _SHARES, "samples": _STEPS}
    for peer in installed()[0]:
        for parameter in asked[peer.asks]:
            yield Contender(peer.name, parameter, peer.asks, peer=peer)


def tile_sizes(ground: Heightmap) -> list[Contender]:
    """Return the two promises at a middle tolerance, for every tile size."""
    metres = tolerances(ground)[len(tolerances(ground)) // 2]
    return [
        Contender(
            type(lod).__name__,
            value,
            unit,
            lod,
            edges="edge",
            tile=tile,
            symbol=ground.unit_symbols[1],
        )
        for lod, value, unit in (
            (MaxErrorLod(metres), metres, "m"),
            (ScreenErrorLod(1.0), 1.0, "pixels"),
        )
        for tile in TILES
    ]


def partitionings(tile: int) -> list[Contender]:
    """Return distance LOD in every partitioning: what differs is how much it pops."""
    lod = DistanceLod(maximum=float(tile))
    return [
        Contender("DistanceLod", float(tile), "segments", lod, None, "min", name, tile)
        for name in PARTITIONINGS
    ]
