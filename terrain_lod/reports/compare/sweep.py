"""What a comparison tries: every level of detail and every peer, over a sweep of its parameter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from ...device.layout import DEFAULT_TILE, FLAT_TILE, PARTITIONINGS
from ...errors import InputError
from ...ground.heightmap import Heightmap
from ...numbered import Number, begin, numbers_of, summary_of
from ...terrain.lod import AnyLod, Lod, PromiseLod, Weighted, unweighted
from ...terrain.lod_formulas import DistanceLod
from ...terrain.lod_promises import BudgetLod, MaxErrorLod, ScreenErrorLod
from ...terrain.lods import LODS
from .peers import PEERS, Peer

TILES: Final = (4, 6, 8, 15, 31)

# vertical errors asked for, in shares of the height range
_METRES: Final = (0.0005, 0.002, 0.008, 0.03)
_TIMES: Final = (0.5, 1.0, 2.0, 4.0)  # a number's default
_WEIGHTS: Final = (2.0, 4.0, 8.0)  # of the horizon
_FACTORS: Final = (0.2, 0.4, 0.7, 1.0)  # of a tile's cells
_BUDGETS: Final = (4, 10, 30)  # triangles for as many cells as a tile of the book's has
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
        Of the parameter: ``"m"``, ``"pixels"``, ``"triangles"``, ``"segments"``, ``"share"``,
        ``"samples"`` or any other of a level of detail.
    lod : Lod, PromiseLod, Weighted or None
    peer : Peer or None
        One of the two is there.
    edge_rule, partitioning : str
        Of formulas; empty where it is the default.
    tile : int
        Cells; these three say nothing of a peer.
    symbol : str
        What people read for ``"m"``: the symbol of the ground's unit.
    """

    family: str
    parameter: float
    unit: str
    lod: AnyLod | None = field(default=None, repr=False)
    peer: Peer | None = field(default=None, repr=False)
    edge_rule: str = ""
    partitioning: str = ""
    tile: int = 0
    symbol: str = "m"

    @property
    def is_static(self) -> bool:
        """Whether one mesh serves all cameras."""
        if self.lod is None:
            return True
        return not (self.lod.needs_camera or isinstance(self.lod, BudgetLod))

    @property
    def promises(self) -> bool:
        """Whether an error was asked for that is to be kept."""
        return self.lod is None or isinstance(self.lod, PromiseLod)

    @property
    def is_flat(self) -> bool:
        """Whether it is made of tiles alone, not of patches of every size."""
        return self.lod is not None and _is_formula(unweighted(self.lod))

    @property
    def asked_metres(self) -> float | None:
        return self.parameter if self.unit == "m" and self.promises else None

    @property
    def asked_pixels(self) -> float | None:
        return self.parameter if self.unit == "pixels" and self.promises else None

    @property
    def name(self) -> str:
        """What people call it: "Screen error", "Coplanarity, weighted", or the peer's name."""
        if self.peer is not None:
            return self.peer.name
        kind = type(unweighted(self.lod)) if self.lod is not None else None
        named = (name for name, each in LODS.items() if each is kind and ":" not in name)
        name = next(named, self.family).replace("-", " ")
        weighted = ", weighted" if isinstance(self.lod, Weighted) else ""
        return f"{name[:1].upper()}{name[1:]}{weighted}"

    @property
    def purpose(self) -> str:
        """What it makes, in a sentence."""
        if self.peer is not None:
            return " ".join((self.peer.make.__doc__ or "").split("\n\n")[0].split())
        words = summary_of(type(unweighted(self.lod))) if self.lod is not None else ""
        return f"{words[:1].upper()}{words[1:]}."

    @property
    def setting(self) -> str:
        """What it is asked for: "5 m"."""
        unit = {"share": "of the triangles", "m": self.symbol}.get(self.unit, self.unit)
        return f"{self.parameter:,g} {unit}"

    @property
    def label(self) -> str:
        """What people read: "Max error 5 m, max"."""
        rule = f", {self.edge_rule}" if self.edge_rule else ""
        return f"{self.name} {self.setting}{rule}"


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


def contenders(ground: Heightmap, tile: int | None = None) -> list[Contender]:
    """Return everything that the sweep of `ground` tries at one tile size, or each at its own."""
    symbol = ground.unit_symbols[1]
    return [replace(one, symbol=symbol) for one in (*_ours(ground, tile), *_theirs(ground))]


def _ours(ground: Heightmap, tile: int | None) -> Iterator[Contender]:
    for kind in LODS.values():
        name, what = swept_of(kind)
        cells = _cells(kind, tile)
        for edge_rule in _edge_rules(kind):
            for value in _tried(what, ground, cells):
                lod = kind(**{name: value})
                unit = what.unit or name
                yield Contender(kind.__name__, value, unit, lod, edge_rule=edge_rule, tile=cells)
    cells = _cells(ScreenErrorLod, tile)
    for weight in _WEIGHTS:
        weighted = Weighted(ScreenErrorLod(1.0), horizon=weight)
        yield Contender("Weighted", weight, "weight", weighted, tile=cells)


def _is_formula(lod: object) -> bool:
    kind = lod if isinstance(lod, type) else type(lod)
    return issubclass(kind, Lod)


def _cells(kind: type[Lod | PromiseLod], tile: int | None) -> int:
    """Return the cells of the tiles that a level of detail is tried on."""
    return tile or (FLAT_TILE if _is_formula(kind) else DEFAULT_TILE)


def swept_of(kind: type[Lod | PromiseLod]) -> tuple[str, Number]:
    """Return the number that several values are tried of, and what it may be.

    Raises
    ------
    InputError
        If the class has no numbers, or none of that name.
    """
    numbers = numbers_of(kind)
    name = kind.swept or next(iter(numbers), "")
    if name not in numbers:
        raise InputError(f"expected a number of {kind.__name__} to compare it by, got {name!r}")
    return name, numbers[name]


def _edge_rules(kind: type[Lod | PromiseLod]) -> tuple[str, ...]:
    """Return the rules for shared edges that are tried."""
    if issubclass(kind, PromiseLod):
        return ("",)
    return ("min", "max") if kind.needs_camera else ("min",)


def _tried(what: Number, ground: Heightmap, tile: int) -> tuple[float, ...]:
    """Return the values of a number that are tried, by its unit; else around its default."""
    if what.unit == "m":
        return tolerances(ground)
    if what.unit == "segments":
        return tuple(dict.fromkeys(max(1.0, round(share * tile)) for share in _FACTORS))
    if what.unit == "triangles":
        tiles = int(np.prod([-(-(extent - 1) // FLAT_TILE) for extent in ground.shape]))
        return tuple(tiles * each for each in _BUDGETS)
    middle = what.begin(float(np.hypot(*ground.extent)), tile) or 1.0
    low = -np.inf if what.low is None else what.low
    held = (min(max(times * middle, low), what.high) for times in _TIMES)
    return tuple(dict.fromkeys(held))


def drawn(ground: Heightmap, tile: int | None) -> list[AnyLod]:
    """Return the levels of detail that pictures are made of, as a viewer begins with them."""
    size = float(np.hypot(*ground.extent))
    kinds = (kind for kind in LODS.values() if not issubclass(kind, BudgetLod))
    begun = (begin(kind, size, _cells(kind, tile)) for kind in kinds)
    return [*begun, Weighted(ScreenErrorLod(1.0))]


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
            tile=tile,
            symbol=ground.unit_symbols[1],
        )
        for lod, value, unit in (
            (MaxErrorLod(metres), metres, "m"),
            (ScreenErrorLod(1.0), 1.0, "pixels"),
        )
        for tile in TILES
    ]


def partitionings(tile: int | None = None) -> list[Contender]:
    """Return distance LOD in every partitioning: what differs is how much it pops."""
    cells = _cells(DistanceLod, tile)
    lod = DistanceLod(maximum=float(cells))
    return [
        Contender("DistanceLod", float(cells), "segments", lod, None, "min", name, cells)
        for name in PARTITIONINGS
    ]
