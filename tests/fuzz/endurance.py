"""What holds for long: files whole though writers are killed, threads apart, memory steady."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np

from fuzz.kind import require
from support.grounds import holed, rough
from terrain_lod.camera.viewpoint import default_camera
from terrain_lod.files.meshes.loading import load_mesh
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.mesh.mesh import Mesh
from terrain_lod.terrain.lod_promises import MaxErrorLod, ScreenErrorLod
from terrain_lod.terrain.terrain import Terrain

_ROUNDS: Final = 50
_BYTES_A_ROUND: Final = 100_000  # of growth that is no leak: allocators keep some
_SAVES: Final = """
import sys
from terrain_lod.files.meshes.loading import load_mesh
mesh = load_mesh(sys.argv[1])
print(flush=True)
while True:
    mesh.save(sys.argv[2])
"""


def trial_kills(chance: random.Random, folder: Path) -> None:
    """Kill a process that saves a mesh again and again: the file is whole, or not there."""
    whole = _mesh(_ground()).save(folder / "whole.ply")
    saved = folder / f"saved{chance.choice(('.ply', '.stl', '.obj', '.glb'))}"
    child = subprocess.Popen(
        [sys.executable, "-c", _SAVES, str(whole), str(saved)], stdout=subprocess.PIPE
    )
    assert child.stdout is not None
    child.stdout.readline()
    time.sleep(chance.uniform(0, 0.1))
    child.send_signal(chance.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM)))
    child.communicate()
    if saved.exists():
        found, expected = load_mesh(saved), load_mesh(whole)
        require(len(found.triangles) == len(expected.triangles), "a half-written file")


def trial_threads(chance: random.Random, folder: Path) -> None:
    """Ask two threads for meshes at once: they get what one gets alone."""
    terrain, other = Terrain(_ground()), Terrain(holed(50, 60))
    asked = [(chance.choice((terrain, other)), 10.0 ** chance.uniform(-1, 1)) for _ in range(8)]

    def mesh(told: tuple[Terrain, float]) -> Mesh:
        camera = default_camera(told[0].ground, size=(320, 200))
        return told[0].mesh(camera, lod=ScreenErrorLod(told[1]))

    with ThreadPoolExecutor(2) as threads:
        together = list(threads.map(mesh, asked))
    for found, expected in zip(together, map(mesh, asked), strict=True):
        require(np.array_equal(found.vertices, expected.vertices), "other vertices in threads")
        require(np.array_equal(found.triangles, expected.triangles), "other triangles in threads")


def trial_rounds(chance: random.Random, folder: Path) -> None:
    """Make and save meshes of changing ground: memory does not grow with the rounds."""
    ground = _ground()
    for counted in (False, True):  # the first rounds fill caches
        before = _bytes_in_use()
        for _ in range(_ROUNDS):
            terrain = Terrain(ground)
            rows = slice(3, 20)
            terrain.update(rows, rows, ground.elevation[rows, rows] + chance.uniform(-5, 5))
            mesh = terrain.mesh(lod=MaxErrorLod(chance.uniform(0.5, 5)))
            load_mesh(mesh.save(folder / "mesh.ply"))
        grown = _bytes_in_use() - before
        require(not counted or grown < _ROUNDS * _BYTES_A_ROUND, f"grew by {grown / 1e6:.1f} MB")
    require(terrain.device.allocated < 1e9, "device memory that is kept")


@cache
def _ground() -> Heightmap:
    return rough(60, 50)


def _mesh(ground: Heightmap) -> Mesh:
    return Terrain(ground).mesh()


def _bytes_in_use() -> int:
    """Return what this process has in memory; 0 where nobody knows."""
    status = Path("/proc/self/statm")
    return int(status.read_text().split()[1]) * 4096 if status.exists() else 0
