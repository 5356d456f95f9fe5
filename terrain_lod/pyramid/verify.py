"""Is every chunk of a store there, and as it was written?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..errors import FileError
from ..tasks import Progress
from .codes import decode
from .division import NODE
from .store import Store


def damages(store: Store, progress: Progress | None = None) -> Iterator[str]:
    """Read all of a store, its checksums too, and yield a line for each chunk that cannot be used.

    Parameters
    ----------
    store : Store
    progress : callable, optional
        Called with the chunks read and those in all.
    """
    names = list(store.chunk_names())
    for done, (name, place) in enumerate(names, 1):
        try:
            store.read(name, place)
        except FileError as error:
            yield str(error)
        if progress is not None:
            progress(done, len(names))


def rows_of(store: Store) -> list[tuple[str, str]]:
    """Return what there is to know of a store, as a table of names and values."""
    own, division = store.description, store.division
    low, high = store.chunk_nodes(division.top).ranges.reshape(2) + own.base
    unit = own.units[1]
    held = sum(file.stat().st_size for file in store.path.rglob("*") if file.is_file())
    rows = [
        ("ground", own.name),
        ("samples", f"{own.rows:,} × {own.columns:,}"),
        ("spacing", " × ".join(f"{step:.10g}" for step in own.spacing) + f" {own.units[0]}"),
        ("origin", ", ".join(f"{number:,.10g}" for number in own.origin)),
        ("CRS", own.crs or "none"),
        ("heights", f"{low:,.6g} to {high:,.6g} {unit}, relative to {own.base:g}"),
        ("chunks", f"{division.chunk} cells, nodes of {NODE}"),
        ("bytes", f"{held:,}, {held / (own.rows * own.columns):.3g} a sample"),
    ]
    for level in division.levels:
        rows_, columns = division.chunks(level)
        worst = float(decode(store.chunk_nodes(level).errors[..., 0]).max())
        within = f"within {worst:.3g} {unit}" if np.isfinite(worst) else "not where data ends"
        rows.append((f"level {level}", f"{rows_:,} × {columns:,} chunks, {within}"))
    return rows
