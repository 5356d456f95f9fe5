"""What a viewer of ground can be set to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

from ..arguments import whole
from ..device.layout import MAX_TILE
from ..numbered import TILE, begin, numbers_of, with_number
from ..terrain.lod import WEIGHTS, AnyLod, Lod, PromiseLod, Weighted
from ..terrain.lod_formulas import UniformLod
from ..terrain.lods import LODS
from .settings import SHARED, SUN, Choice, Settings, Slider, slider_of

MODES: Final = ("shaded", "wireframe", "lod", "deviation", "error", "normals")
# each half as many again: kernels are built for each, which takes a second or two the first time
TILES: Final = (3, 5, 7, 11, 15, 21, 31, 45, 63)
# small tiles follow a view closely, with fewer triangles for its error: docs/promises.md
_TILE: Final = 7


@dataclass(frozen=True, kw_only=True)
class TerrainSettings(Settings):
    """What a viewer of ground is set to.

    Attributes
    ----------
    horizon, silhouette : float
        Weights of tiles against the sky and of tiles seen edge on; see
        :class:`terrain_lod.Weighted`.
    edge_rule : str
        Rule for the factors of shared edges.
    tile : int
        Cells along a tile.
    """

    lod: str = "screen-error"
    horizon: float = 1.0
    silhouette: float = 1.0
    edge_rule: str = "edge"
    tile: int = _TILE

    def __post_init__(self) -> None:
        object.__setattr__(self, "tile", whole("tile", self.tile, 1, MAX_TILE))
        if not self.formulas:
            begun = {name: begin(kind, self.diagonal, self.tile) for name, kind in LODS.items()}
            object.__setattr__(self, "formulas", begun)

    def __str__(self) -> str:
        return f"{super().__str__()}, edge rule {self.usable_edge_rule}, tiles of {self.tile}"

    @property
    def choices(self) -> tuple[Choice, ...]:
        return (
            Choice("mode", "m", MODES),
            Choice("lod", "l", tuple(self.formulas), "level of detail"),
            Choice("edge_rule", "e", ("edge", "min", "max"), "factor of shared edges"),
            *SHARED,
        )

    @property
    def numbers(self) -> tuple[Slider, ...]:
        return (
            *self.formula_sliders(),
            *(slider_of(name, what, self.diagonal) for name, what in WEIGHTS.items()),
            Slider("tile", "tile, cells", TILES[0], TILES[-1], stops=TILES, logarithmic=True),
            *SUN,
        )

    def with_tile(self, tile: int) -> TerrainSettings:
        """Return these settings with other tiles; factors that were all of a tile stay so."""
        made = dict(self.formulas)
        for lod, each in made.items():
            for name, what in numbers_of(type(each)).items():
                if what.start == TILE and getattr(each, name) == self.tile:
                    made[lod] = with_number(made[lod], name, tile, diagonal=self.diagonal)
        return replace(self, tile=tile, formulas=made)

    def changed(self, name: str, value: Any) -> TerrainSettings:
        new = super().changed(name, value)
        return self.with_tile(new.tile) if name == "tile" else new

    @property
    def usable_edge_rule(self) -> str:
        """The edge rule, as far as the level of detail has it."""
        promises = self.tessellated and isinstance(self.formulas[self.lod], PromiseLod)
        return self.edge_rule if promises or self.edge_rule != "edge" else "min"

    def detail(self) -> AnyLod:
        """Return the level of detail."""
        if not self.tessellated:
            return UniformLod(1.0)
        chosen: Lod | PromiseLod = self.formulas[self.lod]
        if self.horizon == self.silhouette == 1.0:
            return chosen
        return Weighted(chosen, horizon=self.horizon, silhouette=self.silhouette)
