"""``terrain-lod build`` and ``info``: pyramids on disk."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from ..errors import InputError, MissingExtraError
from .options import GroundSpacing, HeightRange
from .output import complain, progress_bar, say, say_table

DASK = 'pip install "terrain_lod[dask]"'


@Parameter(name="*")
@dataclass(frozen=True)
class ReadingOptions:
    """How to read ground that need not fit into memory."""

    spacing: GroundSpacing = None
    """Distance between samples in world units, instead of what the file says; map takes the
    file's numbers, however much its map is stretched."""
    height_range: HeightRange = None
    """Heights that the lowest and the highest value of an image stand for."""
    nodata: float | None = None
    """Value that stands for no data, instead of what the file says."""
    band: int | None = None
    """Which band holds the heights, from 1."""
    z_unit: str | None = None
    """Unit of the file's heights, such as foot, instead of what the file says."""
    z_scale: float | None = None
    """A number of the file times this is a height, in z-unit or else in the unit of x and y."""

    def given(self) -> dict[str, Any]:
        given = {name: value for name, value in vars(self).items() if value is not None}
        if "spacing" in given and len(given["spacing"]) == 1:
            given["spacing"] = given["spacing"][0]
        return given


def build(
    ground: Annotated[Path, Parameter(metavar="GROUND")],
    store: Annotated[Path, Parameter(metavar="STORE")],
    /,
    *,
    workers: int | None = None,
    scheduler: Annotated[str | None, Parameter(metavar="ADDRESS")] = None,
    chunk: int = 512,
    base: float | None = None,
    reading: ReadingOptions = ReadingOptions(),
) -> None:
    """Make a pyramid on disk of ground of any size, which view, render and mesh then open.

    A build that was stopped goes on where it was when the same command runs again.

    Parameters
    ----------
    ground
        A raster file, or a folder of tiles side by side.
    store
        Folder to write; ends in .tlod by custom.
    workers
        Processes made for this build. Without it, all is done in one.
    scheduler
        Address of a cluster of dask, whose workers find both paths under the same names.
    chunk
        Cells along a chunk, a power of two from 16 to 4096.
    base
        What heights are stored relative to: the same in stores that are to meet without a crack.
    """
    from ..pyramid.build import build as build_store
    from ..pyramid.build import memory_line
    from ..pyramid.division import Division
    from ..sources.opening import source_of

    given = reading.given()
    source = source_of(ground, **given)
    say(f"{ground}: {memory_line(Division(*source.shape, chunk))}")
    with _team(workers, scheduler) as team, progress_bar("building") as progress:
        build_store(ground, store, workers=team, progress=progress, chunk=chunk, base=base, **given)
    say(f"{store}: built; terrain-lod info {store} verifies it")


@contextmanager
def _team(workers: int | None, scheduler: str | None) -> Iterator[Any]:
    """Yield who works."""
    if scheduler is None:
        yield workers
        return
    if workers is not None:
        raise InputError("expected --workers or --scheduler, got both: a cluster has its own")
    try:
        from distributed import Client
    except ImportError:
        raise MissingExtraError(
            f"expected dask.distributed, for --scheduler, got no such package: {DASK}"
        ) from None
    try:
        client = Client(scheduler, timeout=10)
    except (OSError, ValueError) as error:
        raise InputError(
            f"expected a dask scheduler at {scheduler}, got none that answers ({error})"
        ) from None
    with client:
        yield client


def is_store(name: str) -> bool:
    """Return whether a ground is a pyramid on disk."""
    return (Path(name) / "zarr.json").is_file()


def open_store(name: str, memory: str | None, device: Any) -> Any:
    """Open a pyramid as a terrain; options of reading are those of its build."""
    from ..streaming.terrain import open as open_terrain

    return open_terrain(name, memory=memory, device=device)


def info(store: Annotated[Path, Parameter(metavar="STORE")], /) -> int:
    """Say what a pyramid on disk holds, and verify every chunk of it."""
    from ..pyramid.store import Store
    from ..pyramid.verify import damages, rows_of

    opened = Store.open(store)
    say_table(("what", ""), rows_of(opened))
    with progress_bar("verifying") as progress:
        found = list(damages(opened, progress))
    for line in found:
        complain(line)
    if found:
        return 2
    say(f"{store}: every chunk is as it was written")
    return 0
