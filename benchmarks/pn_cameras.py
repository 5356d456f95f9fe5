"""Curved meshes from many cameras: is every one closed, and does culling change a picture?

    python benchmarks/pn_cameras.py [--cameras 100] [--pictures 100]

For seven closed meshes: crack reports for every formula of factors, by the tessellator and on
semi-uniform patterns, and pictures with patches that are turned away drawn and left out, compared
pixel for pixel: coloured by position with every triangle drawn, and shaded with those drawn that
face the eye, as closed meshes are. Exits with 1 if a mesh is not closed or a pixel differs.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

import terrain_lod as tl
from terrain_lod.curved.patch_factors import (
    CurvatureFactor,
    DistanceFactor,
    EdgeFactor,
    LengthFactor,
    OrientationFactor,
    SilhouetteFactor,
    UniformFactor,
)
from terrain_lod.curved.smooth import pn_triangles
from terrain_lod.drawing.picture import draw
from terrain_lod.measure.cracks import crack_report

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from support.curved_meshes import CLOSED

PARTITIONINGS = ("fractional_odd", "semi_uniform")
FORMULAS: tuple[EdgeFactor, ...] = (
    UniformFactor(4.3),
    DistanceFactor(near=2.0, far=9.0),
    LengthFactor(pixels=12.0),
    OrientationFactor(maximum=9),
    SilhouetteFactor(maximum=9),
    CurvatureFactor(pixels=0.2),
)


def cameras(count: int, mesh: tl.Mesh) -> list[tl.Camera]:
    """Return cameras all around a mesh, near and far."""
    rng = np.random.default_rng(11)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle, size = (low + high) / 2, float(np.linalg.norm(high - low))
    found = []
    for _ in range(count):
        direction = rng.normal(size=3)
        eye = middle + direction / np.linalg.norm(direction) * size * rng.uniform(0.7, 2.0)
        target = middle + rng.normal(size=3) * 0.05 * size
        points = tuple(eye.tolist()), tuple(target.tolist())
        found.append(tl.Camera(*points, up=(0.1, 0.2, 1), fov=60, size=(320, 240), near=0.01))
    return found


def open_meshes(mesh: tl.Mesh, views: list[tl.Camera]) -> int:
    """Print how many of the curved meshes are not closed, and return it."""
    found, cases = 0, list(product(FORMULAS, PARTITIONINGS, views))
    for formula, partitioning, camera in cases:
        curved = pn_triangles(
            mesh, lod=formula, camera=camera, cull=False, partitioning=partitioning
        )
        found += bool(crack_report(curved, closed=True))
    print(f"  {found} of {len(cases)} curved meshes not closed", flush=True)
    return found


def changed_pictures(mesh: tl.Mesh, factors: object, views: list[tl.Camera]) -> int:
    """Print how many pictures show what culling leaves out, and return it."""
    whole = pn_triangles(mesh, factors)
    patch = np.searchsorted(whole.point_offsets, whole.triangles[:, 0], side="right") - 1
    everything = np.ones(len(patch), bool)
    drawn = plain = shaded = facing_left_out = 0
    for camera in views:
        part = pn_triangles(mesh, factors, camera=camera, back_faces=0.0, cull=False)
        kept = (np.diff(part.point_offsets) > 0)[patch]
        facing = _facing(whole, camera)
        drawn += np.count_nonzero(kept)
        facing_left_out += np.count_nonzero(facing & ~kept)
        plain += _differ(_lit_alike(whole), everything, kept, camera)
        shaded += _differ(whole, facing, facing & kept, camera)
    print(
        f"  {drawn / len(views):,.0f} of {len(whole.triangles):,} triangles drawn; of {len(views)} "
        f"pictures {plain} changed by position, {shaded} shaded; {facing_left_out} triangles that "
        "face the eye left out",
        flush=True,
    )
    return plain + shaded


def _facing(mesh: tl.Mesh, camera: tl.Camera) -> np.ndarray:
    """Return True for the triangles that are counter-clockwise in the picture; (M,)."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    eye = np.subtract(camera.eye, mesh.origin)
    facing: np.ndarray = (np.cross(b - a, c - a) * (eye - a)).sum(axis=1) > 0
    return facing


def _differ(mesh: tl.Mesh, some: np.ndarray, fewer: np.ndarray, camera: tl.Camera) -> bool:
    """Return whether a pixel shows that only `fewer` of the triangles are drawn."""
    if np.array_equal(some, fewer):
        return False
    # all of the vertices, so that haze and clipping planes are the same
    pictures = (
        draw(replace(mesh, triangles=mesh.triangles[drawn]), camera) for drawn in (some, fewer)
    )
    return not np.array_equal(*pictures)


def _lit_alike(mesh: tl.Mesh) -> tl.Mesh:
    """Return a mesh whose colours depend on the position alone."""
    return replace(mesh, normals=np.tile(np.float32([0, 0, 1]), (len(mesh.normals), 1)))


def main() -> None:
    """Run both."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cameras", type=int, default=100, help="for crack reports")
    parser.add_argument("--pictures", type=int, default=100, help="for pictures; 0 for none")
    options = parser.parse_args()
    wrong = 0
    for name, make in CLOSED.items():
        mesh = make()
        print(name)
        wrong += open_meshes(mesh, cameras(options.cameras, mesh))
        uneven = np.random.default_rng(7).uniform(1, 9, mesh.triangles.shape)
        for factors in (5, uneven) if options.pictures else ():
            wrong += changed_pictures(mesh, factors, cameras(options.pictures, mesh))
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
