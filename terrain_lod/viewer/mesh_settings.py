"""What a viewer of curved meshes can be set to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from ..curved.patch_factors import EDGE_FACTORS, EdgeFactor, UniformFactor
from ..curved.smooth import NORMALS, SEMI_UNIFORM
from ..device.layout import PARTITIONINGS
from ..drawing.picture import SUN_ON_MESHES
from ..numbered import begin
from .settings import SHARED, SUN, Choice, Settings, Slider

MODES: Final = ("shaded", "wireframe", "lod", "normals")

_CHOICES: Final = (
    Choice("partitioning", "p", (*PARTITIONINGS, SEMI_UNIFORM)),
    Choice("sharp", "x", ("normals", "angle", "never"), "sharp edges by"),
    Choice("normals", "n", NORMALS),
    Choice("back_faces", "b", (True, False), "back faces"),
    *SHARED[1:],
)


@dataclass(frozen=True, kw_only=True)
class BezierSettings(Settings):
    """What a viewer of Bézier patches is set to: one factor for all of them."""

    azimuth: float = SUN_ON_MESHES[0]

    def __post_init__(self) -> None:
        if not self.formulas:
            object.__setattr__(self, "formulas", {"uniform": UniformFactor()})

    @property
    def choices(self) -> tuple[Choice, ...]:
        return (Choice("mode", "m", MODES), *SHARED)

    @property
    def numbers(self) -> tuple[Slider, ...]:
        return (*self.formula_sliders(), *SUN)


@dataclass(frozen=True, kw_only=True)
class CurvedSettings(Settings):
    """What a viewer of PN-triangles is set to.

    Attributes
    ----------
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
    sharp: str = "normals"
    crease: float = 30.0
    normals: str = "quadratic"
    back_faces: bool = True

    def __post_init__(self) -> None:
        if not self.formulas:
            begun = {name: begin(kind, self.diagonal) for name, kind in EDGE_FACTORS.items()}
            object.__setattr__(self, "formulas", begun)

    @property
    def choices(self) -> tuple[Choice, ...]:
        return (
            Choice("mode", "m", MODES),
            Choice("lod", "l", tuple(self.formulas), "factor of an edge"),
            *_CHOICES,
        )

    @property
    def numbers(self) -> tuple[Slider, ...]:
        return (
            *self.formula_sliders(),
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
        chosen: EdgeFactor = self.formulas[self.lod]
        return chosen
