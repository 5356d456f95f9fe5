"""Small grounds for pyramids, and stores of them as bytes."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import terrain_lod as tl

CHUNK = 16


def rugged(rows: int, columns: int, seed: int = 3) -> npt.NDArray[np.float32]:
    """Return heights of a fractal, from about -100 to 100."""
    rng = np.random.default_rng(seed)
    frequencies = np.hypot(np.fft.fftfreq(rows)[:, None], np.fft.rfftfreq(columns))
    frequencies[0, 0] = np.inf
    noise = rng.standard_normal(frequencies.shape) + 1j * rng.standard_normal(frequencies.shape)
    heights = np.fft.irfft2(noise * frequencies**-2.1, (rows, columns))
    return (100 * heights / np.abs(heights).max()).astype(np.float32)


def contents(store: Path) -> dict[str, bytes]:
    """Return every file of a store."""
    files = [path for path in store.rglob("*") if path.is_file()]
    return {str(path.relative_to(store)): path.read_bytes() for path in files}


def build(source: str, store: str, **options: Any) -> None:
    tl.build(np.load(source, mmap_mode="r"), store, chunk=CHUNK, spacing=1.0, **options)


if __name__ == "__main__":
    build(*sys.argv[1:])
