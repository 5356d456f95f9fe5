"""Speed of curved PN-triangles: positions and normals a second, and against a bare copy.

    python benchmarks/pn.py [--triangles 50000] [--factors 3 5 9 15]

Prints device times, medians of interleaved rounds. The copy moves as many bytes as the positions
and normals have.
"""

from __future__ import annotations

import argparse
from statistics import median

import numpy as np
import rings

import terrain_lod as tl
from measure import bare_copy, interleaved, ratio
from terrain_lod.curved.adjacency import Adjacency
from terrain_lod.curved.patch_factors import UniformFactor
from terrain_lod.curved.pn import (
    DevicePatchMesh,
    edge_factors_on_device,
    evaluate_on_device,
    nets_on_device,
    patch_factors_on_device,
)
from terrain_lod.device import layout
from terrain_lod.tessellation.tessellator import tessellate_device


def wavy_torus(triangles: int) -> tl.Mesh:
    """Return a closed mesh of about so many triangles, with the normals of the surface."""
    columns = int(np.sqrt(triangles))
    return rings.wavy_torus(columns, max(3, triangles // (2 * columns)))


def speed(mesh: tl.Mesh, factor: float, device: tl.Device) -> None:
    """Print what each stage costs at one factor."""
    patches = DevicePatchMesh.upload(mesh.vertices, mesh.normals, Adjacency.of(mesh), device)
    view = np.zeros((), layout.VIEW)
    nets = nets_on_device(patches)

    def factors() -> object:
        edges = edge_factors_on_device(patches, UniformFactor(factor), 1.0, view)
        return patch_factors_on_device(patches, nets, edges, view, cull=False, back_cosine=None)

    made = factors()
    tessellate = lambda: tessellate_device(  # noqa: E731
        "triangle", made.edge, made.inside, "fractional_odd", clockwise=True
    )
    pattern = tessellate()
    points, triangles = pattern.points.shape[0], pattern.primitives.shape[0]
    stages = {
        "hull": lambda: nets_on_device(patches),
        "factors": factors,
        "tessellate": tessellate,
        "evaluate": lambda: evaluate_on_device(nets, pattern),
    }
    times = interleaved(device, {**stages, "bare copy": bare_copy(device, points * 24)})
    times["hull + evaluate"] = _sums(times, ("hull", "evaluate"))
    times["in all"] = _sums(times, stages)
    print(
        f"factor {factor:g}: {len(mesh.triangles):,} patches, {triangles:,} triangles, "
        f"{points:,} vertices, {points * 24 / 2**20:.0f} MiB"
    )
    for name, seconds in times.items():
        print(
            f"  {name:16} {median(seconds) * 1e3:9.2f} ms "
            f"{triangles / median(seconds) / 1e6:9.1f} million triangles/s "
            f"{ratio(times, name, 'bare copy'):7.2f} x bare copy"
        )


def _sums(times: dict[str, list[float]], names: object) -> list[float]:
    return [sum(round_) for round_ in zip(*(times[name] for name in names), strict=True)]


def main() -> None:
    """Run all factors."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--triangles", type=int, default=50_000, help="of the base mesh")
    parser.add_argument("--factors", type=float, nargs="+", default=[3, 5, 9, 15])
    parser.add_argument("--device", help="part of a device's name, cpu or gpu")
    options = parser.parse_args()
    device = tl.Device.open(options.device)
    print(device.info)
    mesh = wavy_torus(options.triangles)
    for factor in options.factors:
        speed(mesh, factor, device)


if __name__ == "__main__":
    main()
