"""A store holds the samples, bounds of all errors, and the same bytes whoever built it."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import terrain_lod as tl
from support.pyramids import CHUNK, build, contents, rugged
from terrain_lod.pyramid.codes import decode
from terrain_lod.pyramid.division import NODE, Division
from terrain_lod.pyramid.store import Store
from terrain_lod.tasks import Workers

pytest.importorskip("zarr")

# two regions by three, the last ones narrow
SHAPE = 175, 290


@pytest.fixture
def source(tmp_path: Path) -> Path:
    heights = rugged(*SHAPE)
    heights[90:120, 200:] = np.nan
    np.save(tmp_path / "heights.npy", heights)
    return tmp_path / "heights.npy"


def surface(level: int, store: Store) -> npt.NDArray[np.float64]:
    """Return the bilinear surface of a level at every sample, by other means than the builder's."""
    division, size = store.division, CHUNK << level
    rows, columns = division.chunks(level)
    found = np.full((rows * size + 1, columns * size + 1), np.nan)
    for row, column in np.ndindex(rows, columns):
        lattice = store.heights(level, row, column).astype(np.float64)
        for _ in range(2 * level):
            between = (lattice[1:] + lattice[:-1]) / 2
            lattice = np.insert(lattice, range(1, len(lattice)), between, 0)
            # first along all columns, then along all rows, and again
            lattice = lattice.T
        place = np.s_[row * size :, column * size :]
        found[place][: lattice.shape[0], : lattice.shape[1]] = lattice
    return found[: store.description.rows, : store.description.columns]


@pytest.mark.slow
def test_levels_are_every_second_sample_and_errors_hold(tmp_path: Path, source: Path) -> None:
    build(str(source), str(tmp_path / "a.tlod"))
    store, heights = Store.open(tmp_path / "a.tlod"), np.load(source)
    division = store.division
    assert (len(division.fine), len(division.coarse)) == (4, 2)
    for level in division.levels:
        stride, size = 1 << level, NODE << level
        shown = surface(level, store)
        np.testing.assert_array_equal(shown[::stride, ::stride], heights[::stride, ::stride])
        off = np.abs(shown - heights)
        off[np.isnan(shown) != np.isnan(heights)] = np.inf
        for place in np.ndindex(division.chunks(level)):
            nodes = store.nodes(level, *place)
            known = decode(nodes.errors[..., 0])
            for node in np.ndindex(known.shape):
                top, left = (place[axis] * (CHUNK << level) + node[axis] * size for axis in (0, 1))
                within = np.s_[top : top + size + 1, left : left + size + 1]
                worst = np.nanmax(off[within], initial=0.0)
                assert worst <= known[node]
                near = np.s_[
                    max(top - stride, 0) : top + size + stride + 1,
                    max(left - stride, 0) : left + size + stride + 1,
                ]
                assert known[node] <= 1.1 * worst + 3e-4 or np.isnan(heights[near]).any()
                there = heights[within][~np.isnan(heights[within])]
                low, high = nodes.ranges[node]
                if there.size:
                    assert (low, high) == (there.min(), there.max())
                else:
                    assert np.isnan(low)
            whole = store.chunk_nodes(level)
            assert (whole.errors[place] == nodes.errors.max(axis=(0, 1))).all()
        # the next rung is the next level's own, where nodes are the same
        if level < division.top:
            coarser = store.chunk_nodes(level + 1).errors[..., 0].max()
            assert store.chunk_nodes(level).errors[..., 1].max() == coarser


@pytest.mark.slow
def test_whoever_builds_it_the_bytes_are_the_same(tmp_path: Path, source: Path) -> None:
    build(str(source), str(tmp_path / "0.tlod"))
    expected = contents(tmp_path / "0.tlod")
    seen: list[tuple[int, int]] = []
    with ThreadPoolExecutor(2) as threads:
        for number, workers in enumerate((threads, 2), 1):
            store = tmp_path / f"{number}.tlod"
            build(str(source), str(store), workers=workers, progress=lambda *it: seen.append(it))
            assert contents(store) == expected
    assert seen[:6] == [(done, 6) for done in range(1, 7)]


def test_threads_write_chunks_without_data_too(tmp_path: Path, source: Path) -> None:
    import zarr

    build(str(source), str(tmp_path / "a.tlod"))
    description = Store.open(tmp_path / "a.tlod").description

    def writes_all(_: int) -> bool:
        array = Store(tmp_path / "a.tlod", description).array("heights/0")
        return bool(array.config.write_empty_chunks)

    with ThreadPoolExecutor(4) as threads:
        for _ in range(50):
            # whatever one of them sets for all is taken back by another
            zarr.config.set({"array.write_empty_chunks": False})
            assert all(threads.map(writes_all, range(4)))


@pytest.mark.slow
def test_a_cluster_that_loses_a_worker(tmp_path: Path, source: Path) -> None:
    distributed = pytest.importorskip("distributed")
    build(str(source), str(tmp_path / "0.tlod"))

    def kill(done: int, total: int) -> None:
        if done == 2:
            first = next(iter(cluster.workers.values()))
            os.kill(first.pid, signal.SIGKILL)

    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        build(str(source), str(tmp_path / "1.tlod"), workers=client, progress=kill)
    assert contents(tmp_path / "1.tlod") == contents(tmp_path / "0.tlod")


@pytest.mark.slow
def test_a_killed_build_goes_on_to_the_same_bytes(tmp_path: Path, source: Path) -> None:
    build(str(source), str(tmp_path / "0.tlod"))
    expected, moments = contents(tmp_path / "0.tlod"), random.Random(4)
    store = tmp_path / "1.tlod"
    command = [sys.executable, "-m", "support.pyramids", str(source), str(store)]
    folder = Path(__file__).parents[1]
    deaths = 0
    for _ in range(6):
        child = subprocess.Popen(command, cwd=folder)
        began = time.monotonic()
        # its imports aside, let it write for a moment
        while not store.exists() and child.poll() is None:
            time.sleep(0.005)
        time.sleep(moments.uniform(0, 0.8 * (time.monotonic() - began)))
        child.send_signal(signal.SIGKILL)
        deaths += child.wait() == -signal.SIGKILL
        there = contents(store) if store.exists() else {}
        for name, content in there.items():
            # whole, or left under another name; the description says last that all is there
            assert name.endswith(".partial") or content == expected[name] or name == "zarr.json"
    assert deaths
    build(str(source), str(store))
    assert contents(store) == expected


def test_a_store_in_use_names_who_uses_it(tmp_path: Path, source: Path) -> None:
    store = tmp_path / "a.tlod"

    def again(done: int, total: int) -> None:
        with pytest.raises(tl.FileError, match=f"which process {os.getpid()} of .* is at work on"):
            build(str(source), str(store))

    build(str(source), str(store), progress=again)
    assert not (tmp_path / "a.tlod.lock").exists()


def test_a_store_of_another_source_is_left_alone(tmp_path: Path, source: Path) -> None:
    store = tmp_path / "a.tlod"
    build(str(source), str(store))
    before = contents(store)
    build(str(source), str(store))
    with pytest.raises(tl.InputError, match="begun with, got another one"):
        build(str(source), str(store), base=7.0)
    np.save(source, rugged(*SHAPE, seed=9))
    with pytest.raises(tl.InputError, match="begun with, got another one"):
        build(str(source), str(store))
    assert contents(store) == before


def test_a_source_that_changes_meanwhile(tmp_path: Path, source: Path) -> None:
    def change(done: int, total: int) -> None:
        os.utime(source, (1, done))

    with pytest.raises(tl.InputError, match="to stay as it is while it is read"):
        tl.build(source, tmp_path / "a.tlod", chunk=CHUNK, spacing=1.0, progress=change)
    with pytest.raises(tl.FileError, match="whose build ended early"):
        Store.open(tmp_path / "a.tlod")


def test_foreign_folders_are_not_touched(tmp_path: Path, source: Path) -> None:
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "a.txt").write_text("mine")
    for path, said in (
        (tmp_path / "photos", "got another folder at"),
        (source, "got a file at"),
        (tmp_path / "none" / "a.tlod", "expected a folder to make a.tlod in"),
    ):
        with pytest.raises(tl.FileError, match=said):
            build(str(source), str(path))
    assert contents(tmp_path / "photos") == {"a.txt": b"mine"}


def test_two_halves_meet_without_a_difference(tmp_path: Path) -> None:
    heights = rugged(129, 257).astype(np.float64) + 1 / 3
    middle = 128
    for name, part in (("west", heights[:, : middle + 1]), ("east", heights[:, middle:])):
        tl.build(part, tmp_path / name, chunk=CHUNK, spacing=1.0, base=5.0)
    west, east = (Store.open(tmp_path / name) for name in ("west", "east"))
    for level in west.division.levels:
        last = west.division.chunks(level)[1] - 1
        for row in range(west.division.chunks(level)[0]):
            one, other = west.heights(level, row, last), east.heights(level, row, 0)
            np.testing.assert_array_equal(one[:, -1], other[:, 0])


@pytest.mark.slow
def test_a_build_that_was_killed_at_once_goes_on(tmp_path: Path, source: Path) -> None:
    build(str(source), str(tmp_path / "0.tlod"))
    (tmp_path / "1.tlod").mkdir()
    (tmp_path / "1.tlod" / "zarr.0123.partial").write_text("{")
    build(str(source), str(tmp_path / "1.tlod"))
    assert contents(tmp_path / "1.tlod") == contents(tmp_path / "0.tlod")


def test_no_data_at_all_is_said(tmp_path: Path) -> None:
    with pytest.raises(tl.InputError, match="got no data at all"):
        tl.build(np.full((40, 40), np.nan), tmp_path / "a.tlod", chunk=CHUNK, spacing=1.0)


@pytest.mark.parametrize("chunk", [15, 8, 8192, 16.5])
def test_chunks_are_powers_of_two(chunk: int) -> None:
    with pytest.raises(tl.InputError, match="power of two from 16 to 4096"):
        Division(100, 100, chunk)


def test_rasters_that_want_larger_chunks() -> None:
    assert Division(2049, 5, 16).top == 7
    with pytest.raises(tl.InputError, match="use larger chunks"):
        Division(2050, 5, 16)


def test_workers_are_none_a_number_or_an_executor(tmp_path: Path, source: Path) -> None:
    wrong: Workers = 0
    with pytest.raises(tl.InputError, match="at least 1 worker"):
        build(str(source), str(tmp_path / "a.tlod"), workers=wrong)


@pytest.mark.slow
def test_a_full_disk_is_one_line_and_the_build_goes_on(tmp_path: Path, source: Path) -> None:
    build(str(source), str(tmp_path / "0.tlod"))
    store = tmp_path / "1.tlod"
    program = (
        "import resource, signal, sys\n"
        "from support.pyramids import build\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        # as if nothing larger had room
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))\n"
        "build(*sys.argv[1:])\n"
    )
    child = subprocess.run(
        [sys.executable, "-c", program, str(source), str(store)],
        cwd=Path(__file__).parents[1], capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert f"cannot write {store}: File too large; what is there is whole" in child.stderr
    build(str(source), str(store))
    assert contents(store) == contents(tmp_path / "0.tlod")
