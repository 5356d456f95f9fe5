"""Damaged mesh files: what is read is sound."""

from __future__ import annotations

import random
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from fuzz.damage import damaged
from fuzz.kind import require
from support.mesh_files import (
    COMB,
    CUBE,
    FAR,
    HEXAGON,
    ascii_stl,
    binary_stl,
    gltf,
    obj,
    off,
    ply,
    ply_strips,
    with_lines,
)
from terrain_lod.files.meshes.loading import load_mesh

_NOTE: Final = "terrain_lod origin 500000.5 4000000.5 1.5 crs EPSG:32633"


def trial(chance: random.Random, folder: Path) -> None:
    """Damage a file of a format that readers of ours read."""
    _load(chance, folder, _files())


def trial_in_child(chance: random.Random, folder: Path) -> None:
    """Damage a file of a format that is read in a child process."""
    _load(chance, folder, _files_of_others())


def _load(chance: random.Random, folder: Path, files: tuple[tuple[str, bytes], ...]) -> None:
    ending, content = chance.choice(files)
    path = folder / f"damaged{ending}"
    path.write_bytes(damaged(content, chance))
    mesh = load_mesh(path)
    arrays = (mesh.vertices, mesh.normals, mesh.origin, mesh.textures)
    require(all(np.isfinite(array).all() for array in arrays if array is not None), "not finite")
    require(len(mesh.triangles) > 0, "no triangles")
    require(mesh.triangles.min() >= 0, "corners below zero")
    require(mesh.triangles.max() < len(mesh.vertices), "corners that are no vertices")
    require(len(np.unique(mesh.triangles)) == len(mesh.vertices), "vertices of no triangle")


@cache
def _files() -> tuple[tuple[str, bytes], ...]:
    """Return an ending and the bytes of a file of every format that readers of ours read."""
    corners = "".join(f"vn 0 0 {i}\nvt {i} 0.5\n" for i in range(8))
    document = gltf(CUBE).glb()
    return (
        (".obj", obj(CUBE, "{0}/{0}/{0}", head=corners + f"# {_NOTE}")),
        (".obj", with_lines(obj(COMB, "{1}"), "l 1 2", "usemtl", "g comb")),
        (".obj", obj(FAR, "{0}//", end="\r\n")),
        (".off", off(COMB, "COFF\n", " 1 0 0 1")),
        (".off", off(FAR, "NOFF # drawn\n", " 0 0 1")),
        (".ply", ply(CUBE, extra=True).replace(b"drawn", _NOTE.encode())),
        (".ply", ply(HEXAGON, "binary_big_endian", "double", extra=True)),
        (".ply", ply(CUBE, coordinate="short", count="int", index="uint")),
        (".ply", ply(COMB, "ascii", "double", extra=True)),
        (".ply", ply_strips(CUBE, [0, 1, 2, 3, -1, 4, 5, 6])),
        (".stl", binary_stl(CUBE, _NOTE.encode())),
        (".stl", ascii_stl(FAR)),
        (".glb", document),
        (".glb", document.replace(b'"version"', b'"generator": "terrain_lod", "version"')),
        (".gltf", gltf(HEXAGON).json()),
    )


@cache
def _files_of_others() -> tuple[tuple[str, bytes], ...]:
    """Return an ending and the bytes of files of formats that are read in a child process."""
    import pyvista

    surface = pyvista.Sphere(theta_resolution=6, phi_resolution=6)
    volume = pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    found = []
    with TemporaryDirectory() as folder:
        for data, ending in (
            (surface, ".vtp"), (surface, ".vtk"), (volume, ".vtu"), (volume, ".vtk"),
        ):  # fmt: skip
            path = Path(folder) / f"made{ending}"
            data.save(path)
            found.append((ending, path.read_bytes()))
    gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"
    gmsh += "$EndNodes\n$Elements\n1\n1 2 2 0 1 1 2 3\n$EndElements\n"
    return (*found, (".msh", gmsh.encode()))
