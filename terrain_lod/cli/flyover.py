"""``terrain-lod render`` along a path: the options, and what they become."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

from cyclopts import Group, Parameter

from ..camera.camera import Camera
from ..errors import InputError
from ..ground.heightmap import Heightmap
from ..terrain.lod import AnyLod, Lod, PromiseLod
from ..terrain.terrain import Terrain
from .lod_options import LodOptions
from .options import MeshingOptions, Switch
from .output import progress_bar, say

if TYPE_CHECKING:
    from ..drawing.drape import Drape

_PATH: Final = Group("Many pictures", sort_key=5)


@Parameter(name="*", group=_PATH)
@dataclass(frozen=True)
class PathOptions:
    """Which pictures are drawn, if more than one."""

    path: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """JSON list of cameras to fly through, or frames.json of another flight; then --output is
    a folder. As with the next two."""
    orbit: Switch = False
    """Once around the target."""
    flyover: Switch = False
    """Across the ground from the south to the north."""
    frames: int = 60
    """How many pictures. Those that are there already are not made again."""
    beside: Annotated[str | None, Parameter(metavar="NAME")] = None
    """A second level of detail, shown beside the first: a name as for --lod. It takes those options
    that it knows, without weights."""
    texture: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Picture laid over the ground in place of tints, row 0 north."""
    wireframe: Switch = False
    """Draw the triangles over the picture."""
    counts: Annotated[bool, Parameter(negative="--no-counts", show_default=False)] = True
    """Write the number of triangles into the pictures of a path, or do not."""

    @property
    def many(self) -> bool:
        """Whether there is a path."""
        chosen = [self.path is not None, self.orbit, self.flyover].count(True)
        if chosen > 1:
            raise InputError("expected one of --path, --orbit and --flyover, got more")
        if not chosen and self.beside is not None:
            raise InputError("expected --path, --orbit or --flyover with --beside")
        return chosen == 1

    def cameras(self, terrain: Terrain, camera: Camera) -> tuple[Camera, ...]:
        """Return the cameras of the path; `camera` gives its beginning or its size."""
        from ..camera.path import flyover, load_path, orbit

        if self.path is not None:
            return load_path(self.path, self.frames, size=camera.size)
        if self.orbit:
            return orbit(terrain.ground, self.frames, camera=camera)
        return flyover(terrain.ground, self.frames, size=camera.size)

    def second(self, options: LodOptions, tile: int | None) -> list[Lod | PromiseLod]:
        """Return the level of detail that is shown beside the first, if any."""
        return [] if self.beside is None else [options.beside(self.beside, tile)]

    def render(
        self,
        terrain: Terrain,
        camera: Camera,
        folder: Path,
        lods: list[AnyLod],
        meshing: MeshingOptions,
        **look: Any,
    ) -> None:
        """Write the pictures."""
        from ..drawing.flyover import Look, render_path

        cameras = self.cameras(terrain, camera)
        chosen = Look(
            drape=self.drape(terrain.ground), wireframe=self.wireframe, counts=self.counts, **look
        )
        with progress_bar("drawing") as progress:
            paths = render_path(
                terrain,
                cameras,
                folder,
                lods=lods,
                look=chosen,
                progress=progress,
                **vars(meshing),
            )
        say(f"{folder}: {len(paths)} pictures")

    def drape(self, ground: Heightmap) -> Drape | None:
        """Return what is laid over the ground."""
        from ..drawing.drape import Drape

        return None if self.texture is None else Drape.load(self.texture, ground)
