"""A pyramid on disk: a Zarr store of format 3, with one line for whatever is wrong in it."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..errors import FileError, MissingExtraError
from .division import LADDER, NODE, Division, Samples
from .handed import handed_sizes
from .region import Nodes

FORMAT: Final = "terrain_lod pyramid"
VERSION: Final = 1
EXTRA: Final = 'pip install "terrain_lod[pyramid]"'

# what a store is made of, and the arrays of a level or of all regions in it
HEIGHTS, ERRORS, RANGES = "heights", "errors", "ranges"
CHUNK_ERRORS, CHUNK_RANGES = "chunk_errors", "chunk_ranges"
HANDED_HEIGHTS, HANDED_ERRORS, HANDED_RANGES = (
    "regions/heights",
    "regions/errors",
    "regions/ranges",
)


@dataclass(frozen=True)
class Description:
    """What a store says of itself, as its attributes have it.

    Attributes
    ----------
    rows, columns, chunk : int
        See :class:`~terrain_lod.pyramid.division.Division`.
    base : float
        Added to every height.
    spacing, origin : (float, float)
    crs : str or None
    units : (str, str)
    name : str
    fingerprint : str
        Of the source, and of how it was read.
    complete : bool
    """

    rows: int
    columns: int
    chunk: int
    base: float
    spacing: tuple[float, float]
    origin: tuple[float, float]
    crs: str | None
    units: tuple[str, str]
    name: str
    fingerprint: str
    complete: bool = False

    @cached_property
    def division(self) -> Division:
        return Division(self.rows, self.columns, self.chunk)

    def attributes(self) -> dict[str, Any]:
        """Return it as JSON has it."""
        own = {"format": FORMAT, "version": VERSION, "levels": len(self.division.levels)}
        return {"terrain_lod": own | {"node": NODE} | asdict(self)}


class Store:
    """The arrays of a pyramid.

    Parameters
    ----------
    path : pathlib.Path
    description : Description

    Attributes
    ----------
    path : pathlib.Path
    description : Description
    division : Division
    """

    def __init__(self, path: Path, description: Description) -> None:
        self.path, self.description = path, description
        self.division = description.division
        self._arrays: dict[str, Any] = {}

    @classmethod
    def open(cls, path: Path, *, unfinished: bool = False) -> Store:
        """Open the store at `path`.

        Raises
        ------
        FileError
            If there is none, it is none of ours, of a version that is not known yet, or not built
            to its end, unless `unfinished`.
        MissingExtraError
            If zarr is not installed.
        """
        zarr = _zarr()
        if not (path / "zarr.json").is_file():
            found = "another folder" if path.is_dir() else "a file" if path.exists() else "nothing"
            raise FileError(f"expected a store that terrain-lod build wrote, got {found} at {path}")
        try:
            attributes = dict(zarr.open_group(path, mode="r").attrs)
        except Exception as error:
            raise FileError(
                f"expected a store of format Zarr 3 at {path}, got damage ({_reason(error)})"
            ) from error
        own = attributes.get("terrain_lod")
        if not isinstance(own, dict) or own.get("format") != FORMAT:
            raise FileError(f"expected a pyramid of terrain_lod at {path}, got other arrays")
        if own.get("version") != VERSION:
            raise FileError(
                f"expected a pyramid of version {VERSION}, got {own.get('version')} at {path}: "
                "a newer terrain_lod reads it"
            )
        try:
            fields = {name: own[name] for name in Description.__dataclass_fields__}
            for name in ("spacing", "origin", "units"):
                fields[name] = tuple(fields[name])
            store = cls(path, Description(**fields))
        except (KeyError, TypeError) as error:
            raise FileError(f"expected the description of a pyramid at {path}, got one without "
                            f"{error}") from None  # fmt: skip
        if not (unfinished or store.description.complete):
            raise FileError(
                f"expected a finished store, got {path}, whose build ended early: run the same "
                "terrain-lod build again, which goes on where it stopped"
            )
        return store

    def make(self) -> None:
        """Make what of the store is not there yet: its description, then arrays without chunks."""
        zarr = _zarr()
        with writing(self.path):
            if not (self.path / "zarr.json").is_file():
                attributes = self.description.attributes()
                zarr.create_group(self.path, zarr_format=3, attributes=attributes)
            group = zarr.open_group(self.path, mode="r+")
            for name, (shape, chunks, shards, dtype) in _layout(self.division).items():
                if (self.path / name / "zarr.json").is_file():
                    continue
                group.create_array(
                    name, shape=shape, chunks=chunks, shards=shards, dtype=dtype,
                    fill_value=np.nan if dtype == "float32" else 0, compressors=_codecs(),
                )  # fmt: skip

    def describe(self) -> None:
        """Say in the store what it is, and whether all of it is there."""
        with writing(self.path):
            _zarr().open_group(self.path, mode="r+").attrs.update(self.description.attributes())

    def array(self, name: str) -> Any:
        if name not in self._arrays:
            try:
                array = _zarr().open_array(self.path / name, mode="r+")
                # a chunk that is not there is missing, not empty; zarr's own configuration is
                # shared by all threads
                self._arrays[name] = array.with_config({"write_empty_chunks": True})
            except Exception as error:
                raise self._damage(name, (), error) from error
        return self._arrays[name]

    def write(self, name: str, place: tuple[Any, ...], values: npt.NDArray[Any]) -> None:
        """Write whole files of an array."""
        with writing(self.path):
            self.array(name)[place] = values

    def read(self, name: str, place: tuple[int, ...] = ()) -> npt.NDArray[Any]:
        """Read one chunk of an array, or all of a small one.

        Raises
        ------
        FileError
            If it is missing or damaged; names it.
        """
        try:
            array = self.array(name)
            if not self.file_of(name, place).is_file():
                raise FileNotFoundError("its file is missing")
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                return np.asarray(array[place] if place else array[...])
        except FileError:
            raise
        except Exception as error:
            raise self._damage(name, place, error) from error

    def file_of(self, name: str, place: tuple[int, ...]) -> Path:
        """Return the file that holds a chunk of an array."""
        array = self.array(name)
        size = array.shards or array.chunks
        numbers = (*place, *[0] * (array.ndim - len(place)))
        parts = [str(number // extent) for number, extent in zip(numbers, size, strict=True)]
        return self.path.joinpath(name, "c", *parts)

    def heights(self, level: int, row: int, column: int) -> Samples:
        """Return a chunk's lattice, relative to the base, as far as it has cells."""
        down, across = self.division.chunk_cells(level, row, column)
        return self.read(f"{HEIGHTS}/{level}", (row, column))[: down + 1, : across + 1]

    def nodes(self, level: int, row: int, column: int) -> Nodes:
        """Return what is known of a chunk's nodes, as far as it has cells."""
        down, across = (
            -(-cells // NODE) for cells in self.division.chunk_cells(level, row, column)
        )
        errors, ranges = (self.read(f"{name}/{level}", (row, column)) for name in (ERRORS, RANGES))
        return Nodes(errors[:down, :across], ranges[:down, :across])

    def chunk_nodes(self, level: int) -> Nodes:
        """Return what is known of all chunks of a level."""
        return Nodes(self.read(f"{CHUNK_ERRORS}/{level}"), self.read(f"{CHUNK_RANGES}/{level}"))

    def chunk_names(self) -> Iterator[tuple[str, tuple[int, ...]]]:
        """Yield the arrays of a whole store, each with the places of its chunks."""
        for level in self.division.levels:
            for place in np.ndindex(self.division.chunks(level)):
                for name in (HEIGHTS, ERRORS, RANGES):
                    yield f"{name}/{level}", place
            for name in (CHUNK_ERRORS, CHUNK_RANGES):
                yield f"{name}/{level}", ()

    def _damage(self, name: str, place: tuple[int, ...], error: Exception) -> FileError:
        chunk = f" chunk {list(place)}" if place else ""
        return FileError(
            f"expected {name}{chunk} in {self.path}, got damage ({_reason(error)}): build the "
            "store anew; its other chunks are as they were"
        )


def _layout(division: Division) -> dict[str, tuple[Any, ...]]:
    """Return shape, chunk, shard and type of each array."""
    side, nodes, regions = division.chunk + 1, division.nodes, division.regions
    layout: dict[str, tuple[Any, ...]] = {}
    for level in division.levels:
        chunks, in_region = (
            division.chunks(level),
            max(division.region // division.chunk >> level, 1),
        )
        files = (in_region, in_region)
        layout |= {
            f"{HEIGHTS}/{level}": (
                (*chunks, side, side), (1, 1, side, side),
                (*files, side, side) if in_region > 1 else None, "float32",
            ),
            f"{ERRORS}/{level}": (
                (*chunks, nodes, nodes, LADDER), (*files, nodes, nodes, LADDER), None, "uint8",
            ),
            f"{RANGES}/{level}": (
                (*chunks, nodes, nodes, 2), (*files, nodes, nodes, 2), None, "float32",
            ),
            f"{CHUNK_ERRORS}/{level}": ((*chunks, LADDER), (*chunks, LADDER), None, "uint8"),
            f"{CHUNK_RANGES}/{level}": ((*chunks, 2), (*chunks, 2), None, "float32"),
        }  # fmt: skip
    heights, known = handed_sizes(division)
    return layout | {
        HANDED_HEIGHTS: ((*regions, heights), (1, 1, heights), None, "float32"),
        HANDED_ERRORS: ((*regions, known, LADDER), (1, 1, known, LADDER), None, "uint8"),
        HANDED_RANGES: ((*regions, known, 2), (1, 1, known, 2), None, "float32"),
    }


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Say in one line what keeps a store from being written."""
    try:
        yield
    except OSError as error:
        if isinstance(error, FileError):
            raise
        raise FileError(
            f"cannot write {path}: {error.strerror or error}; what is there is whole, and the "
            "same build goes on from it"
        ) from None


def _zarr() -> Any:
    try:
        import zarr
    except ImportError:
        raise MissingExtraError(
            f"expected zarr, for pyramids on disk, got no such package: {EXTRA}"
        ) from None
    return zarr


def _codecs() -> tuple[Any, ...]:
    from zarr.codecs import Crc32cCodec, ZstdCodec

    return ZstdCodec(level=1), Crc32cCodec()


def _reason(error: Exception) -> str:
    return (str(error).splitlines() or [""])[0][:160] or type(error).__name__
