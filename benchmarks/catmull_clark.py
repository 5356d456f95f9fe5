"""Catmull-Clark and B-spline surfaces by bicubic patches: how near, how smooth and how fast.

    python benchmarks/catmull_clark.py [--steps 4]

Distances are those of points of the surface, found by subdividing `--steps` times, from the tangent
planes of the patches there, in mean edges of the control mesh; normals are compared in degrees.
"""

from __future__ import annotations

import argparse
from statistics import median

import numpy as np

import terrain_lod as tl
from terrain_lod.checks.curved import _prism
from terrain_lod.curved.catmull_clark import catmull_clark_patches
from terrain_lod.curved.continuity import patch_continuity
from terrain_lod.curved.control_mesh import Array, ControlMesh, Rings
from terrain_lod.reference.curved.bezier import field

_SQUARE = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)


def box() -> ControlMesh:
    """Return a cube, whose corners have three neighbours each."""
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return ControlMesh(corners, sides)


def limit(mesh: ControlMesh, steps: int) -> tuple[Array, Array, Array, Array]:
    """Return points and normals of the surface of a mesh of quads, and their faces and (u, v)."""
    face, corners = np.arange(len(mesh.faces)), np.tile(_SQUARE, (len(mesh.faces), 1, 1))
    for _ in range(steps):
        mesh, face = mesh.refined(), np.repeat(face, 4)
        middle = corners.mean(axis=1)
        ahead, behind = ((corners + np.roll(corners, way, axis=1)) / 2 for way in (-1, 1))
        around = ((corners[:, c], ahead[:, c], middle, behind[:, c]) for c in range(4))
        corners = np.stack([np.stack(quad, axis=1) for quad in around], axis=1).reshape(-1, 4, 2)
    fine = catmull_clark_patches(mesh)
    return (
        fine.nets[:, 0, 0],
        np.cross(fine.along_u[:, 0, 0], fine.along_v[:, 0, 0]),
        face,
        corners[:, 0],
    )


def distances(mesh: ControlMesh, steps: int) -> tuple[float, float]:
    """Return the largest distance in world units, and the largest angle between normals."""
    mesh = mesh if mesh.is_quads else mesh.refined()
    patches = catmull_clark_patches(mesh)
    places, normals, face, at = limit(mesh, steps)
    u, v = at.T
    near = field(patches.nets[face], u, v)
    across = np.cross(field(patches.along_u[face], u, v), field(patches.along_v[face], u, v))
    normals, across = (
        each / np.linalg.norm(each, axis=1, keepdims=True) for each in (normals, across)
    )
    angles = np.degrees(np.arccos(np.clip((normals * across).sum(axis=1), -1, 1)))
    return float(abs(((places - near) * across).sum(axis=1)).max()), float(np.nanmax(angles))


def main() -> None:
    """Run all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=4)
    options = parser.parse_args()
    meshes = {"cube": box(), **{f"prism of {n}": _prism(n) for n in (3, 5, 6, 7, 8, 12, 30)}}
    for name, mesh in meshes.items():
        ends = Rings.of(mesh).edge_ends
        edge = np.linalg.norm(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]], axis=1).mean()
        told = []
        for _ in range(3):
            far, angle = distances(mesh, options.steps)
            told.append(f"{far / edge:.3%} of an edge, {angle:.1f} degrees")
            mesh = mesh.refined()
        print(
            f"  {name:12} as it is {told[0]}; refined once {told[1]}; twice {told[2]}", flush=True
        )
    for name in ("prism of 5", "prism of 8"):
        print(f"  {name:12} {patch_continuity(catmull_clark_patches(meshes[name]).nets)}")
    control = box()
    for _ in range(4):
        control = control.refined()
    i, j = np.meshgrid(np.arange(60), np.arange(60), indexing="ij")
    wave = tl.curved.b_spline(np.stack([i, j, np.sin(i) * np.cos(j)], axis=-1))
    for name, make in {
        "Catmull-Clark": lambda: tl.curved.catmull_clark(control, factor=15),
        "B-spline": lambda: tl.curved.bezier(wave, factor=15),
    }.items():
        runs = [make() for _ in range(7)][1:]
        seconds = median(sum(run.timings.values()) for run in runs)
        count = len(runs[0].triangles)
        print(f"  {name}: {count:,} triangles, {count / seconds / 1e6:.0f} million a second")


if __name__ == "__main__":
    main()
