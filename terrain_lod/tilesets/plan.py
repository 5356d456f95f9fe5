"""What is to be written, worked out and checked before the first tile is made."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from ..arguments import flag, one_of, positive, whole
from ..errors import InputError
from ..ground.heightmap import Heightmap
from .geoid import ELLIPSOID
from .glb import vertex_step
from .job import Job
from .levels import Level, reach
from .mapped import MappedGround
from .quantized_mesh import MOST, smallest_quantum
from .schemes import Geographic, Mercator, Region, Scheme, require_within
from .source import Source

SCHEMES: Final[dict[str, Scheme]] = {"geographic": Geographic(), "mercator": Mercator()}
BORDERS: Final = ("none", "skirts", "frozen")
DEEPEST: Final = 22
TILINGS: Final = ("implicit", "explicit")
# whole numbers of 64 bits hold areas of so many places
_DEEPEST_FROZEN: Final = 16
_MOST_TILES: Final = 10_000_000
# places along a tile, and the quantum of heights in metres, of formats that have no own
_PLACES: Final = 2**14
_FINE: Final = 2.0**-9


def require_options(
    format: str,
    error: float | None,
    zoom: int | None,
    scheme: str | None,
    tiling: str | None,
    borders: str | None,
) -> None:
    """Say so where options do not belong together, before any ground is read."""
    globe, boxes = format == "quantized-mesh", format == "3dtiles"
    _require(globe or scheme is None, "scheme", "quantized-mesh", format)
    _require(boxes or tiling is None, "tiling", "3dtiles", format)
    _require(globe or boxes or borders is None, "borders", "quantized-mesh and 3dtiles", format)
    _require(globe or boxes or error is None, "an error", "quantized-mesh and 3dtiles", format)
    one_of("borders", borders or "none", BORDERS)
    if globe and borders == "frozen":
        raise InputError(
            "expected borders none or skirts with quantized-mesh, whose places are 1/32767 of a "
            "tile and so differ between levels, got frozen: 3dtiles have frozen ones"
        )
    one_of("scheme", scheme or "geographic", SCHEMES)
    one_of("tiling", tiling or "implicit", TILINGS)
    if zoom is not None:
        whole("zoom", zoom, 0, DEEPEST)
    if error is not None:
        positive("error", error)


def planned(
    ground: Heightmap | MappedGround,
    folder: Path,
    *,
    format: str,
    error: float | None,
    zoom: int | None,
    scheme: str | None,
    tiling: str | None,
    borders: str | None,
    geoid: str,
    gzip: bool,
) -> Job:
    """Return the job of :func:`terrain_lod.write_tiles`, or say why there is none."""
    globe, boxes = format == "quantized-mesh", format == "3dtiles"
    source = Source.of(ground)
    chosen: Scheme = Region(source.bounds) if boxes else Mercator()
    if globe:
        chosen = SCHEMES[scheme or "geographic"]
    require_within(chosen, source.bounds)
    deepest = _deepest(source, chosen) if zoom is None else int(zoom)
    allowed = source.step / 4 if error is None else float(error)
    frozen = borders == "frozen"
    skirts = borders == "skirts" or (boxes and borders is None)
    if frozen and deepest > _DEEPEST_FROZEN:
        raise InputError(
            f"expected a zoom up to {_DEEPEST_FROZEN} with frozen borders, got {deepest}"
        )
    levels = {}
    for z in range(deepest + 1):
        above = deepest - z
        levels[z] = (
            _box_level(source, allowed, z, above, frozen)
            if boxes
            else _globe_level(source, allowed, above, skirts)
        )
    job = Job(
        source,
        chosen,
        levels,
        folder,
        flag("gzip", gzip),
        skirts=skirts,
        frozen=frozen,
        implicit=tiling != "explicit",
        encoding=format,
        picture=not (globe or boxes),
        about={"heights": _said(geoid)},
    )
    count = sum(len(columns) * len(rows) for columns, rows in map(job.tiles, levels))
    if count > _MOST_TILES:
        raise InputError(
            f"expected at most {_MOST_TILES:,} tiles, got {count:,} down to level {deepest}: "
            "choose a lower zoom"
        )
    return job


def _globe_level(source: Source, error: float, above: int, skirts: bool) -> Level:
    """Return a level of quantized-mesh, so many above the deepest."""
    low, high = source.height_range
    asked = error * 2.0**above
    walls = 4 * asked if skirts else 0.0
    quantum = smallest_quantum(min(low, 0.0) - walls, max(high, 0.0))
    if quantum > asked / 4:
        raise InputError(
            f"expected an error of at least {4 * quantum / 2**above:g} m with quantized-mesh for "
            f"heights from {low:g} to {high:g} m, got {error:g}: it has 32768 heights a tile; "
            "3dtiles have more"
        )
    return Level(asked, 0.0, quantum, MOST)


def _box_level(source: Source, error: float, z: int, above: int, frozen: bool) -> Level:
    """Return a level of 3D Tiles, so many above the deepest."""
    low, high = source.height_range
    asked = error * 2.0**above
    west, south, east, north = source.bounds
    # borders that all levels have are rounded alike at all levels
    step = vertex_step(max(east - west, north - south) / (1 if frozen else 2**z))
    if step > asked / 4:
        raise InputError(
            f"expected an error of at least {4 * step / 2**above:g} m for a ground so large, got "
            f"{error:g}"
        )
    deeper = above if frozen else 0
    # so far down that no height of a triangle between is the ground's
    bare = low - 64 * (high - low + asked)
    return Level(asked, step, _FINE, _PLACES << deeper, bare, holed=True, deeper=deeper)


def _said(geoid: str) -> str:
    if geoid == ELLIPSOID:
        return "metres above the ellipsoid WGS 84, as which those of the raster were taken"
    return f"metres above the ellipsoid WGS 84: the raster's, and the geoid {Path(geoid).name}'s"


def _require(holds: bool, option: str, formats: str, got: str) -> None:
    if not holds:
        raise InputError(f"expected {option} with {formats} alone, got format {got}")


def _deepest(source: Source, scheme: Scheme) -> int:
    """Return the first level whose lattice is as fine as the samples."""
    return next((z for z in range(DEEPEST) if reach(source, scheme, z) <= 1.0), DEEPEST)
