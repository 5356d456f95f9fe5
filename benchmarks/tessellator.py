"""Speed of the tessellator: triangles a second, and time against copying as many bytes.

    python benchmarks/tessellator.py [--patches 30000] [--device cpu]

Points and triangles of patches with random factors from 1 to 15, counted, scanned and filled into
new memory, as every call does; no displacement. One copy goes into new memory too, where a CPU
spends much of its time on the first touch of each page; the other into memory in use. Prints
medians of interleaved rounds.
"""

from __future__ import annotations

import argparse
from statistics import median

import numpy as np

import terrain_lod as tl
from measure import bare_copy, interleaved, ratio
from terrain_lod.tessellation.factors import DOMAINS, counts
from terrain_lod.tessellation.tessellator import tessellate_device

CASES = [
    ("quad", "fractional_odd"),
    ("quad", "fractional_even"),
    ("quad", "integer"),
    ("triangle", "fractional_odd"),
    ("isoline", "fractional_odd"),
]


def measure(device: tl.Device, domain: str, partitioning: str, patches: int) -> None:
    """Print one line: what came out, how fast, and against the copy."""
    rng = np.random.default_rng(0)
    edges, insides, corners = DOMAINS[domain]
    edge_factors = rng.uniform(1, 15, (patches, edges)).astype(np.float32)
    inside_factors = rng.uniform(1, 15, (patches, insides)).astype(np.float32) if insides else None
    points, primitives = (
        int(count.sum()) for count in counts(domain, edge_factors, inside_factors, partitioning)
    )
    nbytes = 8 * points + 4 * corners * primitives
    on_device = [
        None if factors is None else device.array(factors)
        for factors in (edge_factors, inside_factors)
    ]
    times = interleaved(
        device,
        {
            "tessellate": lambda: tessellate_device(
                domain, *on_device, partitioning, clockwise=True
            ),
            "copy": bare_copy(device, nbytes, anew=True),
            "copy in place": bare_copy(device, nbytes),
        },
    )
    seconds = median(times["tessellate"])
    print(
        f"  {domain:8} {partitioning:15} {primitives / 1e6:6.2f} M {nbytes / 2**20:6.0f} MiB "
        f"{seconds * 1e3:8.2f} ms {primitives / seconds / 1e6:8.1f} M/s "
        f"{ratio(times, 'tessellate', 'copy'):6.2f} x copy "
        f"{ratio(times, 'tessellate', 'copy in place'):6.2f} x copy into memory in use"
    )


def main() -> None:
    """Measure every case."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--patches", type=int, default=30_000)
    parser.add_argument("--device", help="part of a device's name, cpu or gpu")
    options = parser.parse_args()
    device = tl.Device.open(options.device)
    print(f"{device.info}\n{options.patches:,} patches, primitives a second")
    for domain, partitioning in CASES:
        measure(device, domain, partitioning, options.patches)


if __name__ == "__main__":
    main()
