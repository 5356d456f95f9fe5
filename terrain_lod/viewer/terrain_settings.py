"""What a viewer of ground can be set to."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Final

from ..arguments import whole
from ..device.layout import DEFAULT_TILE, MAX_TILE
from ..numbered import TILE, begin, numbers_of, with_number
from ..terrain.lod import WEIGHTS, AnyLod, Lod, PromiseLod, Weighted, unweighted
from ..terrain.lod_formulas import UniformLod
from ..terrain.lods import LODS
from .settings import SHARED, SUN, Choice, Settings, Slider, slider_of

MODES: Final = (
    "shaded",
    "wireframe",
    "lod",
    "deviation",
    "error",
    "normals",
    "size",
    "factor",
)
# each a third or half as many again: kernels are built for each, which takes a second or two once
TILES: Final = (3, 4, 6, 8, 11, 15, 21, 31, 45, 63)


@dataclass(frozen=True, kw_only=True)
class TerrainSettings(Settings):
    """What a viewer of ground is set to.

    Attributes
    ----------
    horizon, silhouette : float
        Weights of tiles against the sky and of tiles seen edge on; see
        :class:`terrain_lod.Weighted`.
    edge_rule : str
        Rule for the factors that formulas give to shared edges.
    tile : int
        Cells along a tile.
    sky_light : bool
        Valleys have less of the sky's light.
    """

    lod: str = "screen-error"
    horizon: float = 1.0
    silhouette: float = 1.0
    edge_rule: str = "min"
    partitioning: str = "integer"
    tile: int = DEFAULT_TILE
    sky_light: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "tile", whole("tile", self.tile, 1, MAX_TILE))
        if not self.formulas:
            begun = {name: begin(kind, self.diagonal, self.tile) for name, kind in LODS.items()}
            object.__setattr__(self, "formulas", begun)

    def __str__(self) -> str:
        rule = "" if self.usable_edge_rule is None else f", edge rule {self.edge_rule}"
        return f"{super().__str__()}{rule}, tiles of {self.tile}"

    @property
    def choices(self) -> tuple[Choice, ...]:
        return (
            Choice("mode", "m", MODES),
            Choice("lod", "l", tuple(self.formulas), "level of detail"),
            Choice("edge_rule", "e", ("min", "max"), "factor of shared edges"),
            *SHARED,
            Choice("sky_light", "k", (True, False), "light of the sky"),
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
    def usable_edge_rule(self) -> str | None:
        """The edge rule, where the level of detail is a formula."""
        promises = self.tessellated and isinstance(self.formulas[self.lod], PromiseLod)
        return None if promises else self.edge_rule

    @property
    def can_be_steady(self) -> bool:
        """Whether patches can stay as they are from one mesh to the next."""
        lod = unweighted(self.detail())
        promised = isinstance(lod, PromiseLod) and lod.triangles is None
        return promised and self.partitioning == "integer"

    def asked(self) -> str | None:
        """Return the error that the level of detail is to keep, if it is asked for one."""
        lod = unweighted(self.detail())
        if not isinstance(lod, PromiseLod) or lod.triangles is not None:
            return None
        if not math.isfinite(lod.pixels):
            return f"{lod.metres:.3g}"
        return f"{lod.pixels:g} pixel{'' if lod.pixels == 1 else 's'}"

    def detail(self) -> AnyLod:
        """Return the level of detail."""
        if not self.tessellated:
            return UniformLod(1.0)
        chosen: Lod | PromiseLod = self.formulas[self.lod]
        if self.horizon == self.silhouette == 1.0:
            return chosen
        return Weighted(chosen, horizon=self.horizon, silhouette=self.silhouette)
