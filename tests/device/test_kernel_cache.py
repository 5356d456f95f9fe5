"""Damaged kernels in PoCL's folder are compiled anew, and end no process."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from terrain_lod.device.device import POCL
from terrain_lod.device.drivers import devices
from terrain_lod.device.kernel_cache import KernelCache

PROGRAM = """
import os, signal, sys
import numpy as np
from terrain_lod.device.device import Device
from terrain_lod.device.scan import exclusive_scan

print(exclusive_scan(Device.open("portable").array(np.arange(5000, dtype=np.uint32)))[1])
"""
TOTAL = f"{sum(range(5000))}\n"
# what PoCL leaves of a program with two kernels
LIBRARY = Path("AB/CDEF/scan/64-1-1-goffs0/scan.so")
FILES = (LIBRARY, Path("AB/CDEF/add/8-1-1-goffs0/add.so"), Path("AB/CDEF/program.bc"))

pytestmark = pytest.mark.skipif(os.name != "posix", reason="PoCL is looked after where POSIX is")


@contextmanager
def process(folder: Path) -> Iterator[KernelCache]:
    """Use a folder as a process does, from its beginning to its end, but for the sealing."""
    kept = KernelCache(folder)
    yield kept
    kept.leave()


def write_program(folder: Path) -> None:
    for path in FILES:
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(os.urandom(5000))
    (folder / "AB/CDEF/last_accessed").touch()


@pytest.fixture
def sealed(tmp_path: Path) -> Path:
    with process(tmp_path) as kept:
        write_program(tmp_path)
        kept.seal()
    return tmp_path


def garbage(path: Path) -> None:
    path.write_bytes(b"not at all a program" * 5)


def truncated(path: Path) -> None:
    os.truncate(path, path.stat().st_size // 2)


def empty(path: Path) -> None:
    os.truncate(path, 0)


def zeroed(path: Path) -> None:
    # as a power cut leaves it: of the right size, written when it was
    found = path.stat()
    path.write_bytes(bytes(found.st_size))
    os.utime(path, ns=(found.st_atime_ns, found.st_mtime_ns))


def flipped(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def replaced_by_a_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def replaced_by_a_link_to_nowhere(path: Path) -> None:
    path.unlink()
    path.symlink_to("nowhere")


DAMAGES = [garbage, truncated, empty, zeroed, flipped, replaced_by_a_folder,
           replaced_by_a_link_to_nowhere]  # fmt: skip


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_program_is_removed(
    sealed: Path, damage: Callable[[Path], None], path: Path
) -> None:
    damage(sealed / path)
    with process(sealed):
        assert not (sealed / "AB/CDEF").exists()
        write_program(sealed)  # as PoCL does, whom nobody has told of seals
    with process(sealed):
        assert not (sealed / "AB/CDEF").exists()


def test_what_is_sound_stays(sealed: Path) -> None:
    for _ in range(2):
        with process(sealed) as kept:
            assert all((sealed / path).is_file() for path in FILES)
            kept.seal()
    # moved, and the machine started anew: nothing tells but the content
    with process(shutil.copytree(sealed, sealed / "copy")):
        assert all((sealed / "copy" / path).is_file() for path in FILES)


def test_damage_is_not_sealed(sealed: Path) -> None:
    with process(sealed) as kept:
        garbage(sealed / LIBRARY)
        kept.seal()
    with process(sealed):
        assert not (sealed / "AB/CDEF").exists()


@pytest.mark.parametrize(
    "content", ["", "{", "[]", '{"a": 1}', "null", '{"a": [null, 1]}', "[" * 9999]
)
def test_a_damaged_list_of_seals_starts_afresh(sealed: Path, content: str) -> None:
    (sealed / "seals.json").write_text(content)
    with process(sealed):
        assert not (sealed / "AB/CDEF").exists()


def test_what_another_process_writes_is_left_alone(tmp_path: Path) -> None:
    with process(tmp_path):
        write_program(tmp_path)
        with process(tmp_path):
            assert all((tmp_path / path).is_file() for path in FILES)
    # that was killed: it has sealed nothing
    with process(tmp_path):
        assert not (tmp_path / "AB/CDEF").exists()


def test_what_nobody_used_for_long_is_removed(sealed: Path) -> None:
    os.utime(sealed / "AB/CDEF/last_accessed", (0, 0))
    (sealed / "tempfile_AbCdEf").touch()
    with process(sealed):
        assert not (sealed / "AB/CDEF").exists()
        assert not (sealed / "tempfile_AbCdEf").exists()


def run(folder: Path, program: str = PROGRAM) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"POCL_CACHE_DIR": str(folder)}
    return subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=environment
    )


needs_pocl = pytest.mark.skipif(
    all(info.platform != POCL for info in devices()), reason="PoCL is not here"
)


@pytest.mark.slow
@needs_pocl
def test_pocl_compiles_anew_what_is_removed(tmp_path: Path) -> None:
    assert run(tmp_path).stdout == TOTAL
    libraries = sorted((tmp_path / "terrain_lod").rglob("*.so"))
    assert libraries
    sound = [path.stat().st_ino for path in libraries]
    assert run(tmp_path).stdout == TOTAL
    assert [path.stat().st_ino for path in libraries] == sound
    for path in libraries:
        garbage(path)
    child = run(tmp_path)
    assert (child.returncode, child.stdout, child.stderr) == (0, TOTAL, "")


@pytest.mark.slow
@needs_pocl
def test_a_folder_that_cannot_be_written_is_replaced_for_a_while_and_said() -> None:
    # not even root can make a folder there
    child = run(Path("/proc/nowhere"))
    assert (child.returncode, child.stdout) == (0, TOTAL)
    (line,) = child.stderr.splitlines()
    assert line.startswith("kernels are compiled for this run alone: cannot keep them in /proc/no")
    assert "POCL_CACHE_DIR" in line


def test_a_fork_that_ends_leaves_everything_to_its_parent(tmp_path: Path) -> None:
    fork = "import os, sys, terrain_lod.device.kernel_cache as cache\n"
    fork += "folder = cache.temporary_folder()\n"
    fork += "if os.fork() == 0: sys.exit()\n"
    fork += "os.wait(); print(folder.is_dir()); print(folder)"
    there, folder = run(tmp_path, fork).stdout.split()
    assert there == "True"
    assert not Path(folder).exists()
