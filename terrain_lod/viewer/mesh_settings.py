"""What a viewer of curved meshes can be set to."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Final

from ..curved import patch_factors
from ..curved.patch_factors import MAX_FACTOR, EdgeFactor, UniformFactor
from ..curved.smooth import NORMALS, SEMI_UNIFORM
from ..device.layout import PARTITIONINGS
from ..drawing.picture import SUN_ON_MESHES
from .settings import (
    SHARED,
    SUN,
    Choice,
    Settings,
    Slider,
)

MODES: Final = ("shaded", "wireframe", "lod", "normals")
LODS: Final = ("uniform", "distance", "length", "silhouette", "orientation", "curvature")

_CHOICES: Final = (
    Choice("mode", "m", MODES),
    Choice("lod", "l", LODS, "factor of an edge"),
    Choice("partitioning", "p", (*PARTITIONINGS, SEMI_UNIFORM)),
    Choice("sharp", "x", ("normals", "angle", "never"), "sharp edges by"),
    Choice("normals", "n", NORMALS),
    Choice("back_faces", "b", (True, False), "back faces"),
    *SHARED[1:],
)
_FACTOR: Final = Slider(
    "factor", "factor", 1.0, MAX_FACTOR, ("lod", ("uniform",)), logarithmic=True
)


@dataclass(frozen=True, kw_only=True)
class BezierSettings(Settings):
    """What a viewer of Bézier patches is set to: one factor for all of them."""

    azimuth: float = SUN_ON_MESHES[0]

    @property
    def choices(self) -> tuple[Choice, ...]:
        return (Choice("mode", "m", MODES), *SHARED)

    @property
    def numbers(self) -> tuple[Slider, ...]:
        return (_FACTOR, *SUN)


@dataclass(frozen=True, kw_only=True)
class CurvedSettings(Settings):
    """What a viewer of PN-triangles is set to.

    Attributes
    ----------
    cosine : float
        How far an outline reaches; of the silhouette formula.
    sharp : str
        Which edges are sharp: where "normals" differ, by the "angle" of their faces, "never".
    crease : float
        That angle, degrees.
    normals : str
        Of the curved surface, or blended.
    back_faces : bool
        Whether patches that are turned away are drawn.
    """

    azimuth: float = SUN_ON_MESHES[0]
    pixels: float = 8.0
    cosine: float = 0.3
    sharp: str = "normals"
    crease: float = 30.0
    normals: str = "quadratic"
    back_faces: bool = True

    def __post_init__(self) -> None:
        # the first view is from outside: all of the mesh is farther than its diagonal
        object.__setattr__(self, "far", self.far or 2 * self.diagonal)

    @property
    def choices(self) -> tuple[Choice, ...]:
        return _CHOICES

    @property
    def numbers(self) -> tuple[Slider, ...]:
        size, distance = self.diagonal, ("lod", ("distance",))
        ranged, pixels = ("lod", LODS[1:]), ("lod", ("length", "curvature"))
        return (
            _FACTOR,
            Slider("near", "near", 0.0, size, distance),
            Slider("far", "far", 0.01 * size, 4 * size, distance),
            Slider("pixels", "pixels", 0.125, 64.0, pixels, logarithmic=True),
            Slider("cosine", "width of outline", 0.01, 1.0, ("lod", ("silhouette",))),
            Slider("minimum", "least factor", 1.0, MAX_FACTOR, ranged, logarithmic=True),
            Slider("maximum", "most factor", 1.0, MAX_FACTOR, ranged, logarithmic=True),
            Slider("crease", "sharp above, degrees", 0.0, 180.0, ("sharp", ("angle",))),
            *SUN,
        )

    def __str__(self) -> str:
        sharp = {
            "normals": "sharp where normals differ",
            "angle": f"sharp above {self.crease:.0f} degrees",
            "never": "never sharp",
        }
        return f"{super().__str__()}, {sharp[self.sharp]}, {self.normals} normals"

    def formula(self) -> EdgeFactor:
        """Return how many segments an edge gets."""
        if not self.tessellated:
            return UniformFactor(1.0)
        kind: type[EdgeFactor] = getattr(patch_factors, f"{self.lod.title()}Factor")
        return kind(**{field.name: getattr(self, field.name) for field in fields(kind)})  # type: ignore[arg-type]
