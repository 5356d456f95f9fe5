"""The device: chosen by name, built with true line numbers, launched by keyword, accounted for."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from terrain_lod.device import layout, sources
from terrain_lod.device.device import DEVICE_VARIABLE, Device
from terrain_lod.device.drivers import PYOPENCL_VARIABLE, choose, devices
from terrain_lod.device.info import DeviceInfo, find_device
from terrain_lod.errors import DeviceError, DeviceMemoryError, InputError

GPU = DeviceInfo("GeForce 1650", "NVIDIA CUDA", True, 4 << 30, 1 << 30)
CPU = DeviceInfo("pthread-Ryzen", "Portable Computing Language", False, 8 << 30, 2 << 30)


@pytest.fixture
def device() -> Device:
    """A device of the test's own: nothing built, nothing allocated."""
    return Device(Device.open().queue.device)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A kernels folder of the test's own."""
    monkeypatch.setattr(sources, "KERNELS", tmp_path)
    return tmp_path


def in_a_child(code: str, **environment: str) -> str:
    """Run `code` in a fresh interpreter, no device chosen, and return what it printed."""
    chosen = (DEVICE_VARIABLE, PYOPENCL_VARIABLE)
    own = {name: value for name, value in os.environ.items() if name not in chosen}
    child = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=120,
        env={**own, **environment},
    )
    return child.stdout + child.stderr


# choosing


@pytest.mark.parametrize(
    ("name", "number"),
    [
        (None, 0),
        ("gpu", 0),
        ("CPU", 1),
        ("1", 1),
        ("geforce", 0),
        ("portable", 1),
        (" ryzen ", 1),
    ],
)
def test_a_device_goes_by_number_kind_or_part_of_a_name(name: str | None, number: int) -> None:
    assert find_device([GPU, CPU], name) == number


@pytest.mark.parametrize("name", ["tpu", "2", "1650"])
def test_an_unknown_device_lists_those_that_exist(name: str) -> None:
    with pytest.raises(DeviceError) as refusal:
        find_device([GPU, CPU], name)
    assert str(refusal.value) == (
        f"unknown device {name!r}: expected a number, cpu, gpu or part of a name; here: "
        "0: GeForce 1650 (GPU, NVIDIA CUDA, 4.00 GiB); "
        "1: pthread-Ryzen (CPU, Portable Computing Language, 8.00 GiB)"
    )


def test_no_device_at_all_says_how_to_get_one() -> None:
    with pytest.raises(DeviceError, match=r"found none: install one with  pip install"):
        find_device([], None)


def test_open_shares_one_device_among_threads() -> None:
    opened: list[Device] = []
    threads = [threading.Thread(target=lambda: opened.append(Device.open())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert {id(device) for device in opened} == {id(Device.open(devices()[0].name))}


OPEN = "from terrain_lod.device.device import Device; print('opened', Device.open().info)"


@pytest.mark.parametrize("variable", ["TERRAIN_LOD_DEVICE", "PYOPENCL_CTX"])
def test_the_environment_chooses(variable: str) -> None:
    assert "opened" in in_a_child(OPEN, **{variable: devices()[0].platform[:6]})
    refused = in_a_child(OPEN, **{variable: "abacus"})
    assert "DeviceError: unknown device" in refused
    assert "abacus" in refused
    assert f"here: 0: {devices()[0].name}" in refused


def test_ours_is_asked_before_pyopencls() -> None:
    assert "opened" in in_a_child(OPEN, TERRAIN_LOD_DEVICE="0", PYOPENCL_CTX="abacus")


def test_no_driver_is_one_line() -> None:
    said = in_a_child(OPEN, OCL_ICD_VENDORS="/nonexistent")
    assert "DeviceError: expected an OpenCL device, found none" in said


FORK = """
import os
from terrain_lod.device.device import Device
Device.open()
if os.fork() == 0:
    try:
        Device.open()
    except Exception as error:
        print(error, flush=True)
    os._exit(0)
os.wait()
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_process_is_told_to_spawn_instead_of_hanging() -> None:
    assert "start workers with  multiprocessing.get_context('spawn')" in in_a_child(FORK)


FORKED_TERRAIN = """
import os, signal, sys, threading
import numpy as np, terrain_lod as tl
from terrain_lod.device.device import Device

terrain = tl.Terrain(tl.Heightmap(np.add.outer(np.arange(40.0), np.arange(40.0) ** 2)))
mesh = terrain.mesh(lod=tl.MaxErrorLod(0.5))
device, array = Device.open(), Device.open().zeros(9, np.float32)
held, done = threading.Event(), threading.Event()

def hold():
    with device.lock:
        held.set()
        done.wait()

threading.Thread(target=hold, daemon=True).start()
held.wait()
uses = {
    "mesh": lambda: terrain.mesh(lod=tl.MaxErrorLod(0.4)),
    "height": lambda: terrain.height_at([(3.0, -3.0)]),
    "update": lambda: terrain.update(slice(0, 1), slice(0, 1), [[1.0]]),
    "error": lambda: tl.vertical_error(mesh, terrain.ground, device=device),
    "read": array.host,
    "write": lambda: array.write([1.0]),
    "fill": lambda: array.fill(1.0),
    "wait": device.finish,
}
for name, use in uses.items():
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # where it waits for ever
        try:
            use()
        except tl.DeviceError:
            os._exit(3)
        os._exit(4)
    print(name, os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
done.set()
terrain.mesh(lod=tl.MaxErrorLod(0.4))
print("and the first goes on")
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_terrain_in_a_fork_is_an_error_and_does_not_hang() -> None:
    said = in_a_child(FORKED_TERRAIN).splitlines()
    assert said[-1] == "and the first goes on", said
    assert {line.split()[1] for line in said[:-1]} == {"3"}, said
    assert len(said) == 9


PRESSED = """
import os, signal, threading, time
import numpy as np, terrain_lod as tl

pressed, built = [], threading.Event()
signal.signal(signal.SIGINT, lambda *_: pressed.append(True))

def press():
    while not built.wait(0.02):
        os.kill(os.getpid(), signal.SIGINT)

tl.Device.open()
threading.Thread(target=press).start()
try:
    tl.Terrain(tl.Heightmap(np.eye(20)))
finally:
    built.set()
print("built", bool(pressed))
"""


@pytest.mark.skipif(os.name != "posix", reason="signals are sent as POSIX has them")
def test_a_signal_does_not_reach_into_a_build(tmp_path: Path) -> None:
    # PoCL keeps what it built: here nothing
    assert in_a_child(PRESSED, POCL_CACHE_DIR=str(tmp_path)) == "built True\n"


# memory


def test_arrays_go_down_and_come_back(device: Device) -> None:
    values = np.arange(12, dtype=np.int16).reshape(3, 4)[::-1, ::2]
    array = device.array(values)
    assert (array.shape, array.dtype, array.size, array.nbytes) == ((3, 2), np.int16, 6, 12)
    np.testing.assert_array_equal(array.host(), values)
    array.write([7, 8], start=4)
    np.testing.assert_array_equal(array.host().ravel()[4:], [7, 8])
    assert device.zeros(3, np.float64).fill(2.5).host().tolist() == [2.5] * 3
    assert device.empty((0, 3), np.float32).host().shape == (0, 3)


def test_a_shape_of_numpy_integers_does_not_overflow(device: Device) -> None:
    side = np.int32(1 << 20)
    with pytest.raises(DeviceMemoryError, match=str(4 << 40)):
        device.empty((side, side), np.float32)


@pytest.mark.parametrize("start", [-1, 2])
def test_a_write_past_the_end_is_refused(device: Device, start: int) -> None:
    with pytest.raises(InputError, match=f"from index {start}, got 3"):
        device.zeros(4, np.float32).write([1, 2, 3], start=start)


def test_memory_is_refused_with_both_numbers(device: Device) -> None:
    wanted, had = device.info.memory + 1, device.info.memory
    with pytest.raises(DeviceMemoryError, match=rf"stage wants .*{wanted} bytes.*{had} bytes"):
        device.require("the stage", wanted)
    halves = device.info.memory // 2 + 1
    with pytest.raises(DeviceMemoryError, match=rf"{2 * halves} bytes.*{had} bytes\) free"):
        device.require("two halves", halves, halves)
    largest = device.info.largest_buffer
    if largest + 1 <= had:
        with pytest.raises(DeviceMemoryError, match=rf"{largest + 1} .*{largest} .* one buffer"):
            device.require("one buffer", largest + 1)
    assert device.allocated == 0


def test_the_account_goes_back_when_arrays_die(device: Device) -> None:
    kept = device.zeros(1000, np.float32)
    lost = device.zeros(500, np.float64)
    assert device.allocated == 8000
    del lost
    gc.collect()
    assert device.allocated == kept.nbytes == 4000


def test_memory_that_is_freed_serves_the_next_and_is_given_back() -> None:
    device = Device(choose(None))  # of its own: what was lately in use elsewhere counts
    before = device.memory.held
    for _ in range(20):
        device.empty(2**20, np.float32)
    # one array's worth, twenty times over
    assert before + 2**22 <= device.memory.held < before + 2 * 2**22
    # many sizes at a time are not kept for good
    sizes = [number * 2**18 for number in range(1, 60)]
    for size in sizes:
        device.empty(size, np.uint8)
    assert device.memory.held < before + sum(sizes) / 4
    device.memory.trim()
    assert device.memory.held == before


# building

ADD = "kernel void add(global float *sums, const float term, const int count) {\n\
    int i = get_global_id(0);\n    if (i < count) sums[i] += term;\n}\n"


def test_a_build_error_shows_the_true_file_and_line(device: Device, folder: Path) -> None:
    (folder / "wrong.cl").write_text('#include "good.h"\n\n#include "bad.h"\n')
    (folder / "good.h").write_text("// fine\n" * 5)
    (folder / "bad.h").write_text("// first line\nint f(void) { return nowhere; }\n")
    with pytest.raises(DeviceError, match=r"kernels/wrong.cl does not build") as refusal:
        device.kernel("wrong.cl", "wrong")
    assert "bad.h:2" in str(refusal.value)


def test_an_unknown_kernel_is_named(device: Device, folder: Path) -> None:
    (folder / "add.cl").write_text(ADD)
    with pytest.raises(DeviceError, match=r"kernel subtract of kernels/add\.cl"):
        device.kernel("add.cl", "subtract")


def test_a_kernel_is_built_once_for_its_defines(device: Device, folder: Path) -> None:
    (folder / "halve.cl").write_text(
        "kernel void halve(global float *out) { if (get_global_id(0) == 0) out[0] = ONE / 2; }"
    )
    whole, fraction = (device.kernel("halve.cl", "halve", ONE=one) for one in (1, 1.0))
    assert device.kernel("halve.cl", "halve", ONE=1) is whole
    out = device.zeros(1, np.float32)
    whole((1,), (1,), out=out)
    assert out.host() == 0
    fraction((1,), (1,), out=out)
    assert out.host() == 0.5


@pytest.mark.slow
def test_programs_lately_asked_for_are_kept_and_others_are_built_again(
    device: Device, folder: Path
) -> None:
    (folder / "many.cl").write_text("kernel void many(global int *out) { out[0] = NUMBER; }")
    first, second = (device.kernel("many.cl", "many", NUMBER=number) for number in (0, 1))
    for number in range(2, 40):
        device.kernel("many.cl", "many", NUMBER=number)
        assert device.kernel("many.cl", "many", NUMBER=0) is first  # so it is never the oldest
    again = device.kernel("many.cl", "many", NUMBER=1)
    assert again is not second
    out = device.zeros(1, np.int32)
    for kernel, number in ((first, 0), (second, 1), (again, 1)):
        kernel((1,), (1,), out=out)
        assert out.host() == number


# launching


@pytest.mark.parametrize("count", [0, 1, 63, 64, 65])
def test_the_global_size_is_padded_to_the_local_one(
    device: Device, folder: Path, count: int
) -> None:
    (folder / "add.cl").write_text(ADD)
    sums = device.zeros(128, np.float32)
    device.kernel("add.cl", "add")((count,), (64,), sums=sums, term=2, count=np.int64(count))
    assert sums.host().tolist() == [2.0] * count + [0.0] * (128 - count)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"term": None}, r"float term \(float32\), got None"),
        ({"term": 1e300}, r"float term \(float32\), got 1e\+300"),
        ({"term": 10**400}, r"float term \(float32\), got 1000"),
        ({"count": 1.5}, r"int count \(int32\), got 1.5"),
        ({"count": float("nan")}, r"int count \(int32\), got nan"),
        ({"count": 1 << 40}, r"int count \(int32\), got 1099511627776"),
        ({"count": np.int64(1 << 40)}, r"int count \(int32\), got np.int64\(1099511627776\)"),
        ({"sums": np.zeros(64, np.float32)}, r"a DeviceArray of float32\), got a host array of"),
        ({"sums": 3}, r"a DeviceArray of float32\), got 3"),
        ({"total": 1}, r"expected arguments \(sums, term, count\), got \(.*total\)"),
    ],
)
def test_a_wrong_argument_is_refused_in_one_line(
    device: Device, folder: Path, change: dict[str, object], message: str
) -> None:
    (folder / "add.cl").write_text(ADD)
    good = {"sums": device.zeros(64, np.float32), "term": 1.0, "count": 64}
    with pytest.raises(DeviceError, match=message) as refusal:
        device.kernel("add.cl", "add")((64,), (64,), **{**good, **change})
    assert "\n" not in str(refusal.value)


def test_a_missing_argument_is_refused(device: Device, folder: Path) -> None:
    (folder / "add.cl").write_text(ADD)
    with pytest.raises(DeviceError, match=r"expected arguments \(sums, term, count\), got \(term"):
        device.kernel("add.cl", "add")((64,), (64,), term=1.0, count=64)


@pytest.mark.parametrize("dtype", [np.float64, np.int32])
def test_a_buffer_of_another_dtype_is_refused(
    device: Device, folder: Path, dtype: type[np.generic]
) -> None:
    (folder / "add.cl").write_text(ADD)
    sums = device.zeros(64, dtype)
    with pytest.raises(DeviceError, match=rf"float32\), got <DeviceArray \(64,\) {sums.dtype}"):
        device.kernel("add.cl", "add")((64,), (64,), sums=sums, term=1.0, count=64)


def test_a_buffer_of_another_device_is_refused(device: Device, folder: Path) -> None:
    (folder / "add.cl").write_text(ADD)
    sums = Device.open().zeros(64, np.float32)
    with pytest.raises(DeviceError, match=r"expected float\* sums"):
        device.kernel("add.cl", "add")((64,), (64,), sums=sums, term=1.0, count=64)


def test_structs_vectors_and_local_memory_are_checked(device: Device, folder: Path) -> None:
    (folder / "mix.cl").write_text(
        '#include "layout.h"\n'
        "kernel void mix_up(Grid grid, global uint2 *pairs, local float *scratch) {\n"
        "if (get_global_id(0) == 0) { scratch[1] = grid.dx; pairs[0] = (uint2)(grid.rows, 4); } }"
    )
    grid = np.zeros((), layout.GRID)
    grid["rows"] = 3
    good = {"grid": grid, "pairs": device.zeros((1, 2), np.uint32), "scratch": 8}
    kernel = device.kernel("mix.cl", "mix_up")
    kernel((1,), (1,), **good)
    assert good["pairs"].host().tolist() == [[3, 4]]
    for wrong in (
        {"grid": np.zeros((), layout.VIEW)},
        {"grid": np.zeros(2, layout.GRID)},
        {"grid": 5},
        {"pairs": device.zeros(2, np.int32)},
        {"scratch": 0},
        {"scratch": device.zeros(2, np.float32)},
    ):
        with pytest.raises(DeviceError, match=f"expected .* {next(iter(wrong))} "):
            kernel((1,), (1,), **{**good, **wrong})


def test_an_argument_type_without_a_dtype_is_refused(device: Device, folder: Path) -> None:
    (folder / "odd.cl").write_text(
        "typedef struct { int a; } Odd;\nkernel void odd(global Odd *o) {}"
    )
    with pytest.raises(DeviceError, match=r"kernel odd declares Odd\* o: expected a struct of"):
        device.kernel("odd.cl", "odd")((1,), (1,), o=device.zeros(1, np.int32))


def test_a_launch_the_driver_refuses_is_one_line(device: Device, folder: Path) -> None:
    (folder / "add.cl").write_text(ADD)
    sums, group = device.zeros(64, np.float32), 1 << 20
    with pytest.raises(DeviceError, match=rf"kernel add on \({group},\) work-items in groups of"):
        device.kernel("add.cl", "add")((64,), (group,), sums=sums, term=1.0, count=64)


# time


def test_timelines_add_up_by_stage_and_nest(device: Device, folder: Path) -> None:
    (folder / "add.cl").write_text(ADD)
    (folder / "also.cl").write_text(ADD)
    sums = device.zeros(1 << 16, np.float32)

    def launch(file: str) -> None:
        kernel = device.kernel(file, "add")
        kernel(sums.shape, (64,), sums=sums, term=1.0, count=sums.size)

    with device.timed() as outer:
        with device.timed() as inner:
            launch("add.cl")
        launch("add.cl")
        launch("also.cl")
    launch("also.cl")
    assert list(outer.seconds) == ["add", "also"]
    assert list(inner.seconds) == ["add"]
    assert outer.seconds["add"] > inner.seconds["add"] > 0
    assert outer.seconds["also"] < 60


def test_a_timeline_sees_the_launches_of_its_own_thread(device: Device, folder: Path) -> None:
    (folder / "add.cl").write_text(ADD)
    sums = device.zeros(1 << 16, np.float32)

    def launch() -> dict[str, float]:
        with device.timed() as own:
            kernel = device.kernel("add.cl", "add")
            kernel(sums.shape, (64,), sums=sums, term=1.0, count=sums.size)
        return own.seconds

    with device.timed() as mine:
        with ThreadPoolExecutor(1) as other:
            theirs = other.submit(launch).result()
        assert mine.seconds == {}
        launch()
    assert list(theirs) == list(mine.seconds) == ["add"]
    assert (sums.host() == 2).all()


def test_rows_are_copied_and_pasted_on_the_device(device: Device) -> None:
    one = device.array(np.arange(12, dtype=np.int16).reshape(4, 3))
    rows = one.copy(1, 3)
    one.fill(9)
    assert rows.host().tolist() == [[3, 4, 5], [6, 7, 8]]
    one.paste(rows, 2)
    assert one.host().tolist() == [[9, 9, 9], [9, 9, 9], [3, 4, 5], [6, 7, 8]]
    one.paste(one.copy(2, 2), 0)
    assert one.host()[0].tolist() == [9, 9, 9]
