"""Make the bundled grounds: ``python -m terrain_lod.heightmaps.make [NAME ...]``.

Writes <name>.png, grounds.json and the table of README.md beside this file. The samples come out
the same, bit for bit, wherever it runs; some two minutes for all of them.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image
from terrain_lod.heightmaps.canyon import canyon
from terrain_lod.heightmaps.city import city
from terrain_lod.heightmaps.dunes import dunes
from terrain_lod.heightmaps.islands import islands
from terrain_lod.heightmaps.noise import Field
from terrain_lod.heightmaps.ridge import ridge
from terrain_lod.heightmaps.volcano import volcano

HERE = Path(__file__).parent
# as large as UTM coordinates are, so that whoever uses a ground meets them
ORIGIN = (500_000.0, 4_000_000.0)


@dataclass(frozen=True)
class Ground:
    """One bundled ground: `build(seed)` gives its heights, a unit of the PNG is `step` metres."""

    build: Callable[[int], Field]
    seed: int
    spacing: float
    step: float
    what: str
    how: str

    @property
    def name(self) -> str:
        return self.build.__name__


GROUNDS = {
    ground.name: ground
    for ground in (
        Ground(
            ridge, 11, 20.0, 0.05,
            "a mountain range with sharp ridges and river plains",
            "uplift, stream-power rivers, rockfall, creep",
        ),
        Ground(
            canyon, 5, 15.0, 0.05,
            "a river gorge in a level plateau, with cliffs, ledges and benches",
            "stream-power rivers, then walls as steep as each layer of rock stands",
        ),
        Ground(
            dunes, 3, 5.0, 0.01,
            "barchans and transverse dunes on a stony plain",
            "Werner's wind-blown slabs of sand, with avalanches",
        ),
        Ground(
            volcano, 7, 15.0, 0.05,
            "a gullied cone with a crater, ash cones and lava flows",
            "stream-power gullies on a concave cone, then the young forms",
        ),
        Ground(
            islands, 23, 30.0, 0.02,
            "mountainous islands, coastal plains and cliffs in a sea at exactly 0 m",
            "uplift and stream-power rivers, then wave-cut platforms",
        ),
        Ground(
            city, 9, 2.0, 0.01,
            "streets, terraced blocks, towers, a stadium and a river between quays",
            "drawn block by block",
        ),
    )
}  # fmt: skip


def samples(ground: Ground) -> tuple[npt.NDArray[np.uint16], tuple[float, float]]:
    """Build a ground; return its 16-bit samples and the heights that 0 and 65535 stand for."""
    height = ground.build(ground.seed)
    low = float(np.floor(height.min()))
    units = np.round((height - low) / ground.step)
    if units.max() > 65535:
        raise ValueError(f"{ground.name} spans more than 65536 steps of {ground.step} m")
    return units.astype(np.uint16), (low, round(low + 65535 * ground.step, 6))


def entry(ground: Ground) -> dict[str, Any]:
    """Write a ground's PNG; return what grounds.json says about it."""
    units, height_range = samples(ground)
    Image.fromarray(units).save(HERE / f"{ground.name}.png", optimize=True)
    low = height_range[0]
    return {
        "shape": units.shape,
        "spacing": ground.spacing,
        "origin": ORIGIN,
        "height_range": height_range,
        "heights": [round(low + int(n) * ground.step, 2) for n in (units.min(), units.max())],
        "seed": ground.seed,
        "what": ground.what,
        "how": ground.how,
        "sha256": digest(units),
    }


def digest(units: npt.NDArray[np.uint16]) -> str:
    """Return the SHA-256 of the samples, row by row, little-endian."""
    return hashlib.sha256(units.astype("<u2").tobytes()).hexdigest()


def table(entries: dict[str, Any]) -> str:
    """Return the provenance of every ground as Markdown."""
    lines = [
        "| name | samples | spacing (m) | heights (m) | seed | what it is | how it was made "
        "| SHA-256 of the samples |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for name, e in entries.items():
        rows, columns = e["shape"]
        low, high = e["heights"]
        lines.append(
            f"| {name} | {rows} x {columns} | {e['spacing']:g} | {low:g} to {high:g} | {e['seed']} "
            f"| {e['what']} | {e['how']} | `{e['sha256'][:16]}` |"
        )
    return "\n".join(lines)


def catalogue() -> dict[str, Any]:
    """Return what grounds.json says, by name."""
    entries: dict[str, Any] = json.loads((HERE / "grounds.json").read_text(encoding="utf-8"))
    return entries


def main(names: list[str]) -> None:
    """Make the grounds that are named, or all."""
    entries = catalogue()
    for name in names or GROUNDS:
        if name not in GROUNDS:
            sys.exit(f"unknown ground {name!r}: expected one of {', '.join(GROUNDS)}")
        print(f"making {name}", flush=True)
        entries[name] = entry(GROUNDS[name])
    entries = {name: entries[name] for name in GROUNDS if name in entries}
    (HERE / "grounds.json").write_text(json.dumps(entries, indent=2) + "\n", encoding="utf-8")
    # the table stands between its two markers
    readme = HERE / "README.md"
    before, _, rest = readme.read_text(encoding="utf-8").partition("<!-- table -->\n")
    after = rest.partition("<!-- end -->")[2]
    text = f"{before}<!-- table -->\n{table(entries)}\n<!-- end -->{after}"
    readme.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
