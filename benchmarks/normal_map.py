"""What a normal map gives back of the detail that a coarse mesh lacks: angles, SSIM, bytes.

    python benchmarks/normal_map.py [--ground ridge] [--error 20] [--pictures FOLDER]

Three pictures are shaded pixel by pixel from rays: the fine mesh, the coarse one, and that one
with its map. Angles are to the fine mesh's normals at pixels that all three show.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from PIL import Image
from skimage.metrics import structural_similarity

import terrain_lod as tl
from terrain_lod.reference.mesh.normal_map import mapped_normals

SIZE = (640, 360)
SUN = np.array([-0.55, 0.4, 0.73])


def main() -> None:
    """Print a line for the coarse mesh, and one for it with the map."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ground", default="ridge")
    parser.add_argument("--error", type=float, default=20.0)
    parser.add_argument("--pictures", type=Path)
    options = parser.parse_args()
    ground = tl.sample(options.ground)
    flat = tl.Terrain(ground, tile=16, levels=1)
    fine = flat.mesh(lod=tl.UniformLod(16), partitioning="integer", cull=False)
    coarse = tl.Terrain(ground).mesh(lod=tl.MaxErrorLod(options.error), cull=False)
    start = time.perf_counter()
    mapped = tl.bake_normals(coarse, fine)
    seconds = time.perf_counter() - start
    camera = tl.default_camera(ground, size=SIZE)
    meshes = {"fine": fine, "coarse": coarse, "with the map": mapped}
    normals = {name: seen(mesh, camera) for name, mesh in meshes.items()}
    shown = np.all([~np.isnan(each).any(axis=-1) for each in normals.values()], axis=0)
    pictures = {
        name: np.where(shown, np.clip(np.nan_to_num(each) @ SUN, 0, 1), 1.0)
        for name, each in normals.items()
    }
    print(
        f"{options.ground}: {len(fine.triangles):,} triangles fine, {len(coarse.triangles):,} "
        f"coarse; {mapped.normal_map} baked in {seconds:.1f} s"
    )
    for name in ("coarse", "with the map"):
        cosines = (normals[name][shown] * normals["fine"][shown]).sum(axis=-1)
        angles = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
        alike = structural_similarity(pictures[name], pictures["fine"], data_range=1.0)
        print(f"{name}: normals {angles.mean():.2f} degrees off in the mean, SSIM {alike:.3f}")
    if options.pictures is not None:
        row = np.concatenate(list(pictures.values()))
        Image.fromarray((255 * row).astype(np.uint8)).save(options.pictures / "normal_map.png")


def seen(mesh: tl.Mesh, camera: tl.Camera) -> np.ndarray:
    """Return the normals that each pixel is shaded with, NaN where it shows nothing; (H, W, 3)."""
    width, height = camera.size
    right, up, forward = camera.axes
    half_x, half_y = camera.half_extents
    x = half_x * ((2 * np.arange(width) + 1) / width - 1)
    y = half_y * (1 - (2 * np.arange(height) + 1) / height)
    ways = (forward + x[None, :, None] * right + y[:, None, None] * up).reshape(-1, 3)
    hits = tl.MeshQueries(mesh).cast(camera.eye, ways)
    normals = np.full(ways.shape, np.nan)
    triangles = hits.triangle[hits.hit]
    corners = mesh.vertices[mesh.triangles[triangles]].astype(np.float64)
    weights = of_corners(corners, hits.position[hits.hit] - mesh.origin)
    if mesh.normal_map is not None:
        normals[hits.hit] = mapped_normals(mesh, triangles, weights)
    else:
        blend = np.einsum("nc,ncd->nd", weights, mesh.normals[mesh.triangles[triangles]])
        normals[hits.hit] = blend / np.linalg.norm(blend, axis=1, keepdims=True)
    return normals.reshape(height, width, 3)


def of_corners(corners: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the weights of triangles' corners (N, 3, 3) at points in their planes."""
    a, b, c = np.moveaxis(corners, 1, 0)
    across = np.cross(b - a, c - a)
    squared = (across * across).sum(axis=1)
    of_b = (np.cross(at - a, c - a) * across).sum(axis=1) / squared
    of_c = (np.cross(b - a, at - a) * across).sum(axis=1) / squared
    return np.stack([1 - of_b - of_c, of_b, of_c], axis=1)


if __name__ == "__main__":
    main()
