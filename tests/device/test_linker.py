"""Where there is no compiler, PoCL links with ours: the kernels are the same."""

from __future__ import annotations

import ctypes
import json
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from terrain_lod.device.device import POCL
from terrain_lod.device.drivers import devices
from terrain_lod.device.linker import elf as elf_linker

# constants in tables, calls of memset and memcpy, doubles, a barrier
KERNEL = """
constant int PRIMES[64] = {2, 3, 5, 7, 11, 13, 17, 19};
typedef struct { float values[600]; } Block;

kernel void all_sorts(global float *out, global const float *values, local float *shared)
{
    int i = get_global_id(0), l = get_local_id(0);
    int private_table[2000];
    for (int k = 0; k < 2000; k++) private_table[k] = 0;
    for (int k = 0; k < 8; k++) private_table[PRIMES[k] * 7 % 2000] = k + 1;
    Block block = *(global const Block *)values;
    block.values[i] += 0.5f;
    shared[l] = block.values[i] + private_table[PRIMES[i % 8] * 7];
    barrier(CLK_LOCAL_MEM_FENCE);
    double fine = shared[get_local_size(0) - 1 - l];
    switch (i % 5) {
    case 0: fine += exp2(1.0); break;
    case 1: fine += pow(2.0f, 3.0f); break;
    case 2: fine += fmod(7.0f, 4.0f); break;
    case 3: fine += popcount(i); break;
    case 4: fine += sin((float)i); break;
    }
    out[i] = (float)fine;
}
"""
PROGRAM = """
import os, sys
from pathlib import Path
import numpy as np
from terrain_lod.device import sources
from terrain_lod.device.device import Device

sources.KERNELS = Path(sys.argv[1])
device = Device.open("portable")
out = device.zeros(64, np.float32)
values = device.array(np.arange(600, dtype=np.float32))
kernel = device.kernel("all_sorts.cl", "all_sorts")
kernel((64,), (16,), out=out, values=values, shared=64)
print(os.environ.get("COMPILER_PATH"), file=sys.stderr)
print(out.host().tolist())
"""
needs_pocl = pytest.mark.skipif(
    not any(info.platform == POCL for info in devices()), reason="PoCL is not here"
)


def run_with(path: str, folder: Path, cache: str) -> subprocess.CompletedProcess[str]:
    (folder / "all_sorts.cl").write_text(KERNEL)
    return subprocess.run(
        [sys.executable, "-c", PROGRAM, str(folder)],
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "PATH": path, "POCL_CACHE_DIR": str(folder / cache)},
    )


@pytest.mark.slow
@needs_pocl
def test_a_machine_without_a_compiler_links_with_ours(tmp_path: Path) -> None:
    bare = run_with("/nonexistent", tmp_path, "bare")
    assert bare.returncode == 0, bare.stderr
    assert "terrain_lod-" in bare.stderr
    libraries = list((tmp_path / "bare").rglob("all_sorts.so"))
    assert len(libraries) == 1
    # ours writes no section headers, so it was ours that ran
    assert elf_linker.HEADER.unpack_from(libraries[0].read_bytes())[12] == 0
    assert len(set(json.loads(bare.stdout))) > 50


@pytest.mark.slow
@needs_pocl
def test_it_gives_what_the_systems_linker_gives(tmp_path: Path) -> None:
    whole = run_with(os.environ["PATH"], tmp_path, "whole")
    if "terrain_lod-" in whole.stderr:
        pytest.skip("this machine has no compiler")
    bare = run_with("/nonexistent", tmp_path, "bare")
    assert whole.stdout == bare.stdout != ""


C_SOURCE = """
#include <string.h>
int counter = 40;                                    // .data, through the offset table
static int zeros[1000];                              // .bss
static const char *const words[] = {"a", "bc", ""};  // pointers that the loader fills in
typedef size_t (*measure)(const char *);
measure measures[] = {strlen};                       // a pointer to another library's function
static int hidden(int i) { return (int)measures[0](words[i]) + zeros[i * 400]; }
int total(void)
{
    counter += 2;
    return counter * 10 + hidden(0) + hidden(1) + (int)strlen(words[2]);
}
"""


@pytest.mark.skipif(
    shutil.which("cc") is None or platform.machine() != "x86_64", reason="needs a compiler"
)
def test_every_kind_of_reference_is_resolved(tmp_path: Path) -> None:
    (tmp_path / "total.c").write_text(C_SOURCE)
    objects, library = tmp_path / "total.o", tmp_path / "total.so"
    compiler = ["cc", "-O1", "-fPIC", "-fno-plt", "-fno-builtin", "-c", "-o", objects]
    subprocess.run([*compiler, tmp_path / "total.c"], check=True)
    kinds = {fix.kind for fix in elf_linker.read_object(objects.read_bytes())[2]}
    assert elf_linker.ABSOLUTE_64 in kinds
    assert kinds & {*elf_linker.TABLE_32}
    assert elf_linker.main(["-shared", "-o", str(library), str(objects), "-lc"]) == 0
    linked = ctypes.CDLL(str(library))
    assert (linked.total(), linked.total()) == (423, 443)
    assert not hasattr(linked, "hidden")


def test_what_it_cannot_link_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "text.o").write_text("no object at all" * 8)
    arguments = ["-o", str(tmp_path / "out.so"), str(tmp_path / "text.o")]
    assert elf_linker.main(arguments) == 1
    assert elf_linker.main([*arguments, "second.o"]) == 1
    assert elf_linker.main(["-o", "out.so", str(tmp_path / "none.o")]) == 1
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 3
    assert "expected one 64-bit x86 object file" in said[0]
    assert "expected one object and -o" in said[1]
    assert not (tmp_path / "out.so").exists()
