"""Curved meshes from many cameras: is every one closed, and does culling change a picture?

    python benchmarks/pn_cameras.py [--cameras 100] [--pictures 100]

For seven closed meshes: crack reports for every formula of factors, by the tessellator and on
semi-uniform patterns, and pictures with patches that are turned away drawn and left out, compared
pixel for pixel. Coloured by position, all pixels must be the same. Shaded, a pixel on the outline
may show either of two patches that meet there; each of its samples is then looked at in float64.
Exits with 1 if a mesh is not closed, a pixel differs that must not, or what a sample sees was left
out.
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
from terrain_lod.drawing.render import render
from terrain_lod.measure.cracks import crack_report

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from curved_meshes import CLOSED

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
        found.append(tl.Camera(*points, up=(0.1, 0.2, 1), size=(320, 240), near=0.01))
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
    """Print in how many pictures it shows what culling leaves out; return the faults."""
    whole = pn_triangles(mesh, factors)
    patch = np.searchsorted(whole.point_offsets, whole.triangles[:, 0], side="right") - 1
    plain, shaded, drawn, unseen, lost = 0, 0, 0, 0, 0
    for camera in views:
        part = pn_triangles(mesh, factors, camera=camera, back_faces=0.0, cull=False)
        kept = (np.diff(part.point_offsets) > 0)[patch]
        drawn += np.count_nonzero(kept)
        plain += _changed(_lit_alike(whole), kept, camera).any()
        pixels = np.argwhere(_changed(whole, kept, camera))
        shaded += len(pixels) > 0
        unseen += len(pixels)
        lost += left_out(whole, kept, camera, pixels)
    print(
        f"  {drawn / len(views):,.0f} of {len(whole.triangles):,} triangles drawn; of {len(views)} "
        f"pictures {plain} changed, and shaded {shaded}, in {unseen} pixels, {lost} samples of "
        "which see what was left out",
        flush=True,
    )
    return int(plain + lost)


def left_out(mesh: tl.Mesh, kept: np.ndarray, camera: tl.Camera, pixels: np.ndarray) -> int:
    """Return how many samples of `pixels`, four each, see a triangle that is not `kept`."""
    places, depths = camera.project(mesh.vertices)
    a, b, c = (places[mesh.triangles[:, corner]] for corner in range(3))
    nearness = 1 / depths[mesh.triangles]
    found = 0
    for row, column in pixels:
        for sample in ((0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)):
            at = np.array([column, row]) + sample
            parts = [_across(b - at, c - at), _across(c - at, a - at), _across(a - at, b - at)]
            weights = np.stack(parts, axis=1)
            covers = (weights >= 0).all(axis=1) | (weights <= 0).all(axis=1)
            covers &= weights.any(axis=1)
            if covers.any():
                near = (weights * nearness)[covers].sum(axis=1) / weights[covers].sum(axis=1)
                found += not kept[covers][np.argmax(near)]
    return found


def _across(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]


def _changed(mesh: tl.Mesh, kept: np.ndarray, camera: tl.Camera) -> np.ndarray:
    """Return True for the pixels that show whether only the `kept` triangles are drawn; (H, W)."""
    # all of the vertices, so that haze and clipping planes are the same
    part = replace(mesh, triangles=mesh.triangles[kept])
    return (render(mesh, camera) != render(part, camera)).any(axis=2)


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
