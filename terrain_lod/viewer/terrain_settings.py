"""What a viewer of ground can be set to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

from ..arguments import whole
from ..device.layout import MAX_TILE
from ..terrain.lod import (
    BudgetLod,
    CoplanarityLod,
    DistanceLod,
    Lod,
    MaxErrorLod,
    PromiseLod,
    ScreenErrorLod,
    UniformLod,
    Weighted,
)
from .settings import (
    SHARED,
    SUN,
    Choice,
    Settings,
    Slider,
)

MODES: Final = ("shaded", "wireframe", "lod", "deviation", "error", "normals")
LODS: Final = ("screen-error", "max-error", "budget", "coplanarity", "distance", "uniform")
# each half as many again: kernels are built for each, which takes a second or two the first time
TILES: Final = (3, 5, 7, 11, 15, 21, 31, 45, 63)
# small tiles follow a view closely, with fewer triangles for its error: docs/promises.md
_TILE: Final = 7
_PROMISES: Final = LODS[:3]
_RANGED: Final = ("lod", ("coplanarity", "distance"))

_CHOICES: Final = (
    Choice("mode", "m", MODES),
    Choice("lod", "l", LODS, "level of detail"),
    Choice("edge_rule", "e", ("edge", "min", "max"), "factor of shared edges"),
    *SHARED,
)


@dataclass(frozen=True, kw_only=True)
class TerrainSettings(Settings):
    """What a viewer of ground is set to.

    Attributes
    ----------
    metres, triangles, falloff, flat_weight : float
        Parameters of the levels of detail; each uses its own.
    horizon, silhouette : float
        Weights of tiles against the sky and of tiles seen edge on; see
        :class:`terrain_lod.Weighted`.
    edge_rule : str
        Rule for the factors of shared edges.
    tile : int
        Cells along a tile.
    """

    lod: str = "screen-error"
    metres: float = 0.0
    triangles: int = 100_000
    falloff: float = 1.0
    flat_weight: float = 0.0
    horizon: float = 1.0
    silhouette: float = 1.0
    factor: float = float(_TILE)
    maximum: float = float(_TILE)
    edge_rule: str = "edge"
    tile: int = _TILE

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "metres", self.metres or 2e-4 * self.diagonal)
        object.__setattr__(self, "tile", whole("tile", self.tile, 1, MAX_TILE))

    def __str__(self) -> str:
        return f"{super().__str__()}, edge rule {self.usable_edge_rule}, tiles of {self.tile}"

    @property
    def choices(self) -> tuple[Choice, ...]:
        return _CHOICES

    @property
    def numbers(self) -> tuple[Slider, ...]:
        size = self.diagonal
        metres, counts = (1e-6 * size, 1e-2 * size), (1e4, 1e6)
        pixels, budget = ("lod", ("screen-error",)), ("lod", ("budget",))
        return (
            Slider("pixels", "error, pixels", 0.25, 32.0, pixels, logarithmic=True),
            Slider("metres", "error, metres", *metres, ("lod", ("max-error",)), logarithmic=True),
            Slider("triangles", "triangles", *counts, budget, whole=True, logarithmic=True),
            Slider("near", "near", 0.0, size, _RANGED),
            Slider("far", "far", 0.01 * size, 2 * size, _RANGED),
            Slider("minimum", "least factor", 1.0, MAX_TILE, _RANGED),
            Slider("maximum", "most factor", 1.0, MAX_TILE, _RANGED),
            Slider("falloff", "falloff", 0.25, 8.0, ("lod", ("distance",)), logarithmic=True),
            Slider("flat_weight", "weight of flat", 0.0, 1.0, ("lod", ("coplanarity",))),
            Slider("factor", "factor", 1.0, MAX_TILE, ("lod", ("uniform",))),
            Slider("horizon", "weight of horizon", 1.0, 8.0),
            Slider("silhouette", "weight of edge on", 1.0, 8.0),
            Slider("tile", "tile, cells", TILES[0], TILES[-1], stops=TILES, logarithmic=True),
            *SUN,
        )

    def with_tile(self, tile: int) -> TerrainSettings:
        """Return these settings with other tiles; factors that were all of a tile stay so."""
        factor, maximum = (
            float(tile) if value == self.tile else value for value in (self.factor, self.maximum)
        )
        minimum = min(self.minimum, maximum)
        return replace(self, tile=tile, factor=factor, minimum=minimum, maximum=maximum)

    def changed(self, name: str, value: Any) -> TerrainSettings:
        new = super().changed(name, value)
        return self.with_tile(new.tile) if name == "tile" else new

    @property
    def usable_edge_rule(self) -> str:
        """The edge rule, as far as the level of detail has it."""
        promises = self.tessellated and self.lod in _PROMISES
        return self.edge_rule if promises or self.edge_rule != "edge" else "min"

    def detail(self) -> Lod | PromiseLod | Weighted:
        """Return the level of detail."""
        if not self.tessellated:
            return UniformLod(1.0)
        if self.horizon == self.silhouette == 1.0:
            return self._unweighted()
        return Weighted(self._unweighted(), horizon=self.horizon, silhouette=self.silhouette)

    def _unweighted(self) -> Lod | PromiseLod:
        ranged = {name: getattr(self, name) for name in ("near", "far", "minimum", "maximum")}
        match self.lod:
            case "screen-error":
                return ScreenErrorLod(self.pixels)
            case "max-error":
                return MaxErrorLod(self.metres)
            case "budget":
                return BudgetLod(int(self.triangles))
            case "coplanarity":
                return CoplanarityLod(**ranged, flat_weight=self.flat_weight)
            case "distance":
                return DistanceLod(**ranged, falloff=self.falloff)
        return UniformLod(self.factor)
