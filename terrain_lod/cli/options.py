"""The options that commands share, and what they become: a ground, a camera, a LOD, a terrain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from cyclopts import Group, Parameter, Token

from ..camera.camera import Camera, Point
from ..camera.camera_file import load_camera
from ..camera.viewpoint import default_camera
from ..errors import FileError, InputError
from ..ground.heightmap import Heightmap
from ..terrain.lod import AnyLod, PromiseLod, unweighted

if TYPE_CHECKING:
    from ..device.device import Device
    from ..terrain.terrain import Terrain


def numbers(form: str, *counts: int, word: str | None = None) -> Parameter:
    """Return how one token such as ``500000,4000000,1200`` or ``1920x1080`` is read, or a word."""

    def convert(_: Any, tokens: Sequence[Token]) -> tuple[float, ...] | str:
        text = tokens[0].value
        if word is not None and text == word:
            return text
        try:
            values = tuple(float(part) for part in text.replace("x", ",").split(","))
        except ValueError:
            values = ()
        if len(values) not in counts:
            raise ValueError(f"expected {form}, got {text!r}")
        return values

    return Parameter(converter=convert, n_tokens=1, allow_leading_hyphen=True, metavar=form)


_Point = Annotated[Point | None, numbers("X,Y,Z", 3)]
_Size = Annotated[tuple[int, int] | None, numbers("WIDTHxHEIGHT", 2)]
_Spacing = Annotated[tuple[float, ...] | None, numbers("DX[,DY]", 1, 2)]
_Bounds = Annotated[tuple[float, float, float, float] | None, numbers("WEST,SOUTH,EAST,NORTH", 4)]
_Window = Annotated[tuple[float, float, float, float] | None, numbers("COLUMN,ROW,WIDTH,HEIGHT", 4)]
GroundSpacing = Annotated[
    tuple[float, ...] | Literal["map"] | None, numbers("DX[,DY]|map", 1, 2, word="map")
]
HeightRange = Annotated[tuple[float, float] | None, numbers("LOW,HIGH", 2)]
Switch = Annotated[bool, Parameter(show_default=False)]
Output = Annotated[Path, Parameter(alias="-o", metavar="FILE")]
OutputFolder = Annotated[Path, Parameter(alias="-o", metavar="DIR")]
Partitioning = Literal["fractional_odd", "fractional_even", "integer", "pow2"]
AnyPartitioning = Literal[Partitioning, "semi_uniform"]
Sun = Annotated[tuple[float, float] | None, numbers("AZIMUTH,ELEVATION", 2)]

Ground = Annotated[
    str, Parameter(metavar="GROUND", help="A raster file or the name of a bundled sample.")
]

_GROUND: Final = Group("Ground", sort_key=1)
_CAMERA: Final = Group("Camera", sort_key=2)
DETAIL: Final = Group("Level of detail", sort_key=3)
_WORK: Final = Group("Tiles and device", sort_key=4)


@Parameter(name="*", group=_GROUND)
@dataclass(frozen=True)
class GroundOptions:
    """How to read the ground."""

    spacing: GroundSpacing = None
    """Distance between samples in world units, instead of what the file says; map takes the
    file's numbers, however much its map is stretched."""
    height_range: HeightRange = None
    """Heights that the lowest and the highest value of an image stand for."""
    nodata: float | None = None
    """Value that stands for no data, instead of what the file says."""
    bounds: _Bounds = None
    """Read only the samples within these, in the file's own CRS."""
    window: _Window = None
    """Read only these samples of the file."""
    overview: int | None = None
    """Read a smaller version that the file holds; 0 is the largest of them."""
    band: int | None = None
    """Which band holds the heights, from 1."""
    z_unit: str | None = None
    """Unit of the file's heights, such as foot, instead of what the file says."""
    z_scale: float | None = None
    """A number of the file times this is a height, in z-unit or else in the unit of x and y."""

    def load(self, name: str) -> Heightmap:
        """Return the ground called `name`: a file if there is one, else a bundled sample."""
        from ..files.rasters.loading import load
        from ..files.rasters.samples import sample, sample_names

        overrides = {key: value for key, value in vars(self).items() if value is not None}
        if not Path(name).exists() and name in sample_names():
            if overrides:
                option = "--" + next(iter(overrides)).replace("_", "-")
                raise InputError(f"expected a file with {option}, got the sample {name!r}")
            return sample(name)
        if (Path(name) / "zarr.json").is_file():
            raise InputError(
                f"expected a raster file, got the pyramid {name}: info, view, mesh and render "
                "take it"
            )
        if not Path(name).exists() and not Path(name).suffix:
            samples = ", ".join(sample_names())
            raise FileError(f"expected a raster file or a sample ({samples}), got {name!r}")
        if "spacing" in overrides and len(overrides["spacing"]) == 1:
            overrides["spacing"] = overrides["spacing"][0]
        return load(name, **overrides)


@Parameter(name="*", group=_GROUND)
@dataclass(frozen=True)
class OverlayOptions:
    """What is laid over the ground."""

    detail: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """A raster that is added all over the ground, again and again. Its spacing is a whole part of
    the ground's, and becomes that of tiles and errors."""
    detail_spacing: _Spacing = None
    """Distance between its samples, instead of what the file says."""
    detail_range: HeightRange = None
    """Heights that the lowest and the highest value of an image of detail stand for."""

    def load(self) -> Heightmap | None:
        """Return the detail, if there is any."""
        given = {name.removeprefix("detail_"): value for name, value in vars(self).items() if value}
        path = given.pop("detail", None)
        if path is not None:
            ranges = {"height_range": given["range"]} if "range" in given else {}
            return GroundOptions(spacing=given.get("spacing"), **ranges).load(str(path))
        if given:
            raise InputError(f"expected --detail with --detail-{next(iter(given))}, got none")
        return None


@Parameter(name="*", group=_CAMERA)
@dataclass(frozen=True)
class CameraOptions:
    """Where the picture is taken from."""

    camera: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """JSON with eye, target, up, fov, size; a report.json will do. The options below override."""
    eye: _Point = None
    """Where the camera stands, in world units. Default: south of the ground, above it."""
    target: _Point = None
    """What it looks at. Default: the middle of the ground."""
    up: _Point = None
    """Which way is up in the picture. Default: 0,0,1."""
    fov: float | None = None
    """Vertical field of view in degrees. Default: 45."""
    size: _Size = None
    """Pixels of the picture. Default: 1920x1080."""
    height: float | None = None
    """World height of the picture of a parallel camera, which has no field of view."""

    def over(self, ground: Heightmap) -> Camera:
        """Return the camera; what is not given comes from a good view over `ground`."""
        return self.instead_of(default_camera(ground))

    def instead_of(self, camera: Camera) -> Camera:
        """Return the camera; what is not given comes from `camera`."""
        if self.camera is not None:
            camera = load_camera(self.camera)
        given = {name: value for name, value in vars(self).items() if value is not None}
        given.pop("camera", None)
        return replace(camera, **given)


@Parameter(name="*", group=DETAIL)
@dataclass(frozen=True)
class MeshingOptions:
    """How factors become triangles."""

    edge_rule: Literal["min", "max"] | None = None
    """Factor of an edge between two tiles: the lower of what a formula wants for them, or the
    higher. Default: min."""
    partitioning: Partitioning | None = None
    """How the tessellator divides an edge. Default: integer where an error is kept, by patches of
    every size; else fractional_odd, or integer in tiles of an even number of cells."""


@Parameter(name="*", group=DETAIL)
@dataclass(frozen=True)
class VertexOptions(MeshingOptions):
    """How factors become triangles, and where their vertices stand."""

    heights: Literal["ground", "fitted"] = "ground"
    """Vertices on the ground, or floating within the error that a promise keeps: fewer
    triangles, more time."""


@Parameter(name="*", group=_WORK)
@dataclass(frozen=True)
class TerrainOptions:
    """How the ground is cut up, and what works on it."""

    tile: int | None = None
    """Cells along a tile, 1 to 63. Default: 4, or 15 in a flat grid."""
    levels: int | None = None
    """Sizes of patches, each twice the last; 1 is a flat grid of tiles. Default: up to the whole
    raster where an error is kept, 1 for formulas."""
    plane: Literal["least_squares", "corners"] = "least_squares"
    """The plane that a tile's deviation is measured from: the best fit, or the book's."""
    device: str | None = None
    """cpu, gpu, a number or part of a name, see doctor. Default: a GPU if there is one."""

    def open(self) -> Device:
        from ..device.device import Device

        return Device.open(self.device)

    def make(self, ground: Heightmap, lod: AnyLod, detail: Heightmap | None = None) -> Terrain:
        """Return the terrain that a level of detail is at its best on."""
        from ..terrain.terrain import Terrain

        return Terrain(
            ground,
            detail=detail,
            tile=self.tile,
            levels=self.levels or (None if isinstance(unweighted(lod), PromiseLod) else 1),
            plane=self.plane,
            device=self.open(),
        )
