"""Damage small mesh files at random and load them: run as a script, in a child process.

    python tests/support/mesh_damage.py FOLDER SEED COUNT [ENDING ...]

The file in work stays in the folder, so that one that kills the process can be looked at. Each
outcome but a sound mesh or a documented error is printed in a line; the last line counts them all.
"""

from __future__ import annotations

import io
import json
import logging
import random
import signal
import sys
import warnings
from collections import Counter
from contextlib import redirect_stderr
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

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
)
from terrain_lod.errors import TerrainError
from terrain_lod.files.meshes.loading import load_mesh

_SECONDS = 20  # that no small file takes
_HOSTILE = (
    b"0",
    b"-1",
    b"1e39",
    b"nan",
    b"inf",
    b"1e999",
    b"99999999999",
    b"4294967295",
    b"",
    b"\0",
)
_NOTE = "terrain_lod origin 500000.5 4000000.5 1.5 crs EPSG:32633"


def small_files() -> list[tuple[str, bytes]]:
    """Return an ending and the bytes of a file of every format that readers of ours read."""
    normals = "".join(f"vn 0 0 {i}\nvt {i} 0.5\n" for i in range(8))
    return [
        (".obj", obj(CUBE, "{0}/{0}/{0}", head=normals + f"# {_NOTE}")),
        (".obj", obj(COMB, "{1}")),
        (".off", off(COMB, "COFF\n", " 1 0 0 1")),
        (".off", off(FAR, "NOFF # drawn\n", " 0 0 1")),
        (".ply", ply(CUBE, extra=True).replace(b"drawn", _NOTE.encode())),
        (".ply", ply(HEXAGON, "binary_big_endian", "double", extra=True)),
        (".ply", ply(COMB, "ascii", "double", extra=True)),
        (".ply", ply_strips(CUBE, [0, 1, 2, 3, -1, 4, 5, 6])),
        (".stl", binary_stl(CUBE, _NOTE.encode())),
        (".stl", ascii_stl(FAR)),
        (".glb", gltf(CUBE).glb()),
        (".glb", gltf(CUBE).glb().replace(b'"version"', b'"generator": "terrain_lod", "version"')),
        (".gltf", gltf(HEXAGON).json()),
    ]


def other_files(folder: Path) -> list[tuple[str, bytes]]:
    """Return files of formats that are read in a child process."""
    import pyvista

    surface = pyvista.Sphere(theta_resolution=6, phi_resolution=6)
    volume = pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    found = []
    for data, ending in ((surface, ".vtp"), (surface, ".vtk"), (volume, ".vtu"), (volume, ".vtk")):
        data.save(folder / f"made{ending}")
        found.append((ending, (folder / f"made{ending}").read_bytes()))
    gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n"
    gmsh += "$EndNodes\n$Elements\n1\n1 2 2 0 1 1 2 3\n$EndElements\n"
    return [*found, (".msh", gmsh.encode())]


def damaged(content: bytes, chance: random.Random) -> bytes:
    """Return a file with a thing wrong, or two."""
    data = bytearray(content)
    for _ in range(chance.randint(1, 2)):
        place = chance.randrange(len(data) + 1)
        kind = chance.randrange(7)
        if kind == 0 and place < len(data):
            data[place] = chance.randrange(256)
        elif kind == 1 and place < len(data):
            data[place] ^= 1 << chance.randrange(8)
        elif kind == 2:
            del data[place : place + chance.choice((1, 2, 4, 40))]
        elif kind == 3:
            data[place:place] = data[place : place + chance.choice((1, 4, 40))]
        elif kind == 4:
            del data[place:]
        elif kind == 5:
            data[place : place + 4] = chance.choice((b"\xff" * 4, b"\0" * 4, b"\0\0\xc0\x7f"))
        else:
            data = _with_hostile_number(data, chance)
    return bytes(data)


def _with_hostile_number(data: bytearray, chance: random.Random) -> bytearray:
    """Return data with one of its words replaced."""
    starts = [i for i, byte in enumerate(data) if chr(byte) in "0123456789-"]
    if not starts:
        return data
    start = end = chance.choice(starts)
    while end < len(data) and chr(data[end]) in "0123456789.-+e":
        end += 1
    return data[:start] + chance.choice(_HOSTILE) + data[end:]


def outcome(path: Path) -> str:
    """Return "mesh" or "refused", or what went wrong."""
    said = io.StringIO()
    try:
        signal.alarm(_SECONDS)
        with redirect_stderr(said):
            mesh = load_mesh(path)
    except TerrainError as error:
        return "refused" if "\n" not in str(error) else f"a message of more lines: {error!r}"
    except BaseException as error:
        return f"{type(error).__name__}: {error}"
    finally:
        signal.alarm(0)
    arrays = (mesh.vertices, mesh.normals, mesh.origin, mesh.textures)
    if not all(np.isfinite(array).all() for array in arrays if array is not None):
        return "a mesh that is not finite"
    if not len(mesh.triangles) or mesh.triangles.min() < 0:
        return "a mesh without triangles"
    if mesh.triangles.max() >= len(mesh.vertices):
        return "a mesh whose corners are no vertices"
    return f"printed {said.getvalue()!r}" if said.getvalue() else "mesh"


def main(folder: Path, seed: int, count: int, endings: list[str]) -> None:
    logging.disable()
    warnings.simplefilter("error")
    signal.signal(signal.SIGALRM, _give_up)
    files = small_files()
    if any(ending in (".vtp", ".vtk", ".vtu", ".msh") for ending in endings):
        files = other_files(folder)
    files = [file for file in files if not endings or file[0] in endings]
    counts = Counter[str]()
    chance = random.Random(seed)
    for number in range(count):
        ending, content = files[number % len(files)]
        path = folder / f"damaged{ending}"
        path.write_bytes(damaged(content, chance))
        found = outcome(path)
        counts[found if found in ("mesh", "refused") else "wrong"] += 1
        if found not in ("mesh", "refused"):
            path.replace(folder / f"wrong_{number}{ending}")
            print(f"{number}{ending}: {found}", flush=True)
    print(json.dumps(counts))


def _give_up(*_: object) -> None:
    raise TimeoutError(f"no end in {_SECONDS} s")


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4:])
