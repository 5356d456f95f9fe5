"""Does a curved mesh jump as a camera moves? Levels between whole numbers against whole ones.

    python benchmarks/semi_uniform_path.py [--steps 0.02 0.002] [--cameras 12]

A camera flies around a torus in even steps, so many radians each, and semi-uniform patterns
follow it. Between two cameras, prints how far the surface moves, in pixels: the largest and the
root mean square, over the vertices and the middles of the triangles of either mesh, measured to the
nearest point of the other. What moves without a jump moves a tenth as far in a tenth of a step.

Before that, both ways to snap points of level 5 onto an edge of a lower one: how far the farthest
is from its own place, how far one jumps when the edge has one level more, and of how many places
the points come from several places of the lower level, so that none of them can slide.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from itertools import pairwise
from statistics import median

import numpy as np
from pn import wavy_torus

import terrain_lod as tl
from terrain_lod.curved.patch_factors import (
    CurvatureFactor,
    DistanceFactor,
    EdgeFactor,
    LengthFactor,
    SilhouetteFactor,
)
from terrain_lod.curved.patched_mesh import PatchedMesh
from terrain_lod.curved.pn import edge_factors_on_device
from terrain_lod.curved.smooth import pn_triangles

FORMULAS: tuple[EdgeFactor, ...] = (
    DistanceFactor(near=2.0, far=9.0, maximum=8),
    LengthFactor(pixels=24.0),
    SilhouetteFactor(maximum=8),
    CurvatureFactor(pixels=0.5),
)


def flight(count: int, step: float) -> list[tl.Camera]:
    """Return cameras around the torus, climbing."""
    angles = step * np.arange(count)
    eyes = np.stack([6 * np.cos(angles), 6 * np.sin(angles), 3 + angles], axis=1)
    return [tl.Camera(tuple(eye.tolist()), (0, 0, 0), fov=60) for eye in eyes]


def between(base: PatchedMesh, formula: EdgeFactor, camera: tl.Camera) -> tl.Mesh:
    """Return the mesh of levels between whole numbers."""
    return pn_triangles(
        base.mesh, lod=formula, camera=camera, cull=False, partitioning="semi_uniform"
    )


def whole(base: PatchedMesh, formula: EdgeFactor, camera: tl.Camera) -> tl.Mesh:
    """Return the mesh of those levels rounded up."""
    factors = edge_factors_on_device(base.patches, formula, 1.0, camera.view(base.mesh.origin))
    rounded = np.exp2(np.ceil(np.log2(factors.host())))[base.adjacency.edges]
    return pn_triangles(base.mesh, rounded, partitioning="semi_uniform")


def moved(before: tl.Mesh, after: tl.Mesh, camera: tl.Camera) -> np.ndarray:
    """Return how far points of either mesh are from the other, in pixels."""
    pixels = []
    for one, other in ((before, after), (after, before)):
        points = np.concatenate([one.vertices, one.vertices[one.triangles].mean(axis=1)])
        found = replace(one, vertices=points, normals=points, textures=None).to_pyvista()
        found = found.compute_implicit_distance(other.to_pyvista())["implicit_distance"]
        pixels.append(np.abs(found) * camera.focal / camera.project(points)[1])
    return np.concatenate(pixels)


def snaps(level: int = 5) -> None:
    """Print how both ways to snap move points along an edge, in steps of `level`."""
    steps = 2**level
    for snap in ("nested", "nearest"):
        edges = [(level, level, lower) for lower in range(level + 1)]
        pattern = tl.semi_uniform(edges, maximum=level, snap=snap)
        walk = pattern.point_offsets[:-1, None] + 2 * steps + np.arange(steps)
        along = pattern.points[walk, 1].astype(int) * steps // 2**16
        off, jump = np.abs(along - np.arange(steps)).max(), np.abs(np.diff(along, axis=0)).max()
        torn = sum(
            len(np.unique(lower[upper == place])) > 1
            for lower, upper in pairwise(along)
            for place in np.unique(upper)
        )
        print(f"{snap}: {off} of {steps} steps off, jumps {jump}; {torn} places torn")


def main() -> None:
    """Print the snaps, and a row a formula and step."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=float, nargs="+", default=[0.02, 0.002])
    parser.add_argument("--cameras", type=int, default=12)
    options = parser.parse_args()
    snaps()
    base = PatchedMesh.upload(wavy_torus(600), tl.Device.open())
    print("                                    levels between whole ones      whole levels")
    print("formula            step  triangles   largest   median     RMS   largest     RMS  pixels")
    for formula in FORMULAS:
        for step in options.steps:
            cameras = flight(options.cameras, step)
            cells = []
            for make in (between, whole):
                meshes = [make(base, formula, camera) for camera in cameras]
                steps = [
                    moved(*pair) for pair in zip(meshes, meshes[1:], cameras[1:], strict=False)
                ]
                largest = [one.max() for one in steps]
                middle = [median(largest)] if make is between else []
                cells += [max(largest), *middle, np.sqrt(np.mean(np.concatenate(steps) ** 2))]
            print(
                f"{formula.header[7:-2]:16} {step:6g} {len(meshes[-1].triangles):10,} "
                + " ".join(f"{cell:{8 if k % 2 else 9}.4f}" for k, cell in enumerate(cells)),
                flush=True,
            )


if __name__ == "__main__":
    main()
