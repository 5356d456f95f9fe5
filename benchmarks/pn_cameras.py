"""Curved meshes from many cameras: is every one closed, and does culling change a picture?

    python benchmarks/pn_cameras.py [--cameras 100] [--pictures 100]

For five closed meshes: crack reports for every formula of factors, and pictures with patches that
are turned away drawn and left out, compared pixel for pixel. Exits with 1 if one is not closed or a
pixel differs.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
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

MESHES = ("smooth cube", "bulging chamfered cube", "cone", "chamfered cube", "torus")
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


def open_meshes(name: str, mesh: tl.Mesh, views: list[tl.Camera]) -> int:
    """Print how many of the curved meshes are not closed, and return it."""
    found = 0
    for formula in FORMULAS:
        for camera in views:
            curved = pn_triangles(mesh, lod=formula, camera=camera, cull=False)
            found += bool(crack_report(curved, closed=True))
    print(f"{name}: {found} of {len(FORMULAS) * len(views)} curved meshes not closed")
    return found


def changed_pictures(name: str, mesh: tl.Mesh, views: list[tl.Camera]) -> int:
    """Print what culling leaves out and in how many pictures it shows, and return that."""
    whole = _lit_alike(pn_triangles(mesh, 5))
    corners = _rows(whole)
    found, drawn = 0, {0.0: 0, 0.2: 0}
    for camera in views:
        parts = {
            cosine: pn_triangles(mesh, 5, camera=camera, back_faces=cosine, cull=False)
            for cosine in drawn
        }
        for cosine, part in parts.items():
            drawn[cosine] += len(part.triangles)
        # all of the vertices, so that haze and clipping planes are the same
        kept = replace(whole, triangles=whole.triangles[np.isin(corners, _rows(parts[0.0]))])
        found += not np.array_equal(render(whole, camera), render(kept, camera))
    print(
        f"{name}: {found} of {len(views)} pictures changed; {len(whole.triangles):,} triangles, "
        + ", ".join(
            f"{total / len(views):,.0f} drawn at a threshold of {cosine}"
            for cosine, total in drawn.items()
        )
    )
    return found


def _lit_alike(mesh: tl.Mesh) -> tl.Mesh:
    """Return a mesh whose colours depend on the position alone.

    A sample on a silhouette may fall to either of the two patches that meet there, whichever way
    the rasteriser rounds: with their own normals that shows at sharp edges.
    """
    return replace(mesh, normals=np.tile(np.float32([0, 0, 1]), (len(mesh.normals), 1)))


def _rows(mesh: tl.Mesh) -> np.ndarray:
    return np.ascontiguousarray(mesh.vertices[mesh.triangles].reshape(-1, 9)).view("V36").ravel()


def main() -> None:
    """Run both."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cameras", type=int, default=100, help="for crack reports")
    parser.add_argument("--pictures", type=int, default=100, help="for pictures; 0 for none")
    options = parser.parse_args()
    wrong = 0
    for name in MESHES:
        mesh = CLOSED[name]()
        wrong += open_meshes(name, mesh, cameras(options.cameras, mesh))
        if options.pictures:
            wrong += changed_pictures(name, mesh, cameras(options.pictures, mesh))
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
