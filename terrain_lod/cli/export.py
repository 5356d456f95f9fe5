"""What a mesh is made into before it is written: taller, draped, or a solid for printing."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Final

from cyclopts import Group, Parameter

from ..arguments import positive
from ..errors import InputError
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh
from ..mesh.solid import solid
from ..mesh.stretched import stretched
from .options import Switch

_FILE: Final = Group("File", sort_key=5)
_BASE: Final = 5.0
_DRAPED: Final = (".glb", ".obj")


@Parameter(name="*", group=_FILE)
@dataclass(frozen=True)
class ExportOptions:
    """What is written of a mesh."""

    exaggeration: float = 1.0
    """How many times as high heights are written; errors in metres are true ones."""
    drape: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """A picture laid over the ground, reprojected where it says where it is; .glb and .obj."""
    solid: Switch = False
    """A closed body for printing: walls along borders and holes, and a flat base."""
    base: float | None = None
    """How far the base is below the lowest point. Default: 5."""
    size_mm: float | None = None
    """The longer side of a solid in millimetres, which its numbers then are."""

    def require(self, output: Path) -> None:
        """Refuse what does not go together, before the work begins."""
        positive("exaggeration", self.exaggeration)
        for option in ("base", "size_mm"):
            value = getattr(self, option)
            if value is None:
                continue
            name = option.replace("_", "-")
            if not self.solid:
                raise InputError(f"expected --solid with --{name}, got it alone")
            if not value > 0:
                raise InputError(f"expected --{name} above 0, got {value:g}")
        if self.drape is not None and self.solid:
            raise InputError("expected --drape or --solid, got both")
        if self.drape is not None and output.suffix.lower() not in _DRAPED:
            raise InputError(f"expected {' or '.join(_DRAPED)} with --drape, got {output.name}")
        if self.drape is not None and not self.drape.is_file():
            raise InputError(f"expected a picture with --drape, got nothing at {self.drape}")

    def is_plain(self) -> bool:
        return self == ExportOptions()

    def save(self, mesh: Mesh, ground: Heightmap, output: Path) -> None:
        """Write a mesh of `ground`."""
        picture = None
        if self.drape is not None:
            from ..files.rasters.ortho import coordinates, read_ortho

            picture = read_ortho(self.drape, ground)
            mesh = replace(mesh, textures=coordinates(mesh.vertices, mesh.origin, ground))
        mesh = stretched(mesh, self.exaggeration)
        if self.solid:
            mesh = solid(mesh, base=_BASE if self.base is None else self.base, size=self.size_mm)
        mesh.save(output, picture=picture)
