"""The drivers of this machine: which devices there are, which is meant, what their errors say."""

from __future__ import annotations

import os
import signal
import threading
from contextlib import suppress
from types import TracebackType
from typing import Final

import pyopencl as cl

from ..errors import DeviceError, DeviceMemoryError
from .info import DeviceInfo, find_device, listing
from .kernel_cache import provide_kernel_cache

PYOPENCL_VARIABLE: Final = "PYOPENCL_CTX"

# a database in the user's home, which saves nothing that can be measured: where it is damaged or
# cannot be written, no kernel launches
cl._PYOPENCL_NO_CACHE = True

_listing_process: int | None = None  # which process has listed devices


def devices() -> tuple[DeviceInfo, ...]:
    """Return every OpenCL device of this machine, GPUs first."""
    return tuple(info_of(handle) for handle in handles())


def require_own_process() -> None:
    """Refuse to use a driver in a fork: its threads have stayed behind, and waits would not end."""
    if _listing_process not in (None, os.getpid()):
        raise DeviceError(
            "expected a process of its own for OpenCL, got a fork of one that uses it already: "
            "start workers with  multiprocessing.get_context('spawn')"
        )


def handles() -> list[cl.Device]:
    global _listing_process
    require_own_process()
    provide_kernel_cache()
    _listing_process = os.getpid()
    try:
        platforms = cl.get_platforms()
    except cl.Error:  # no driver at all
        return []
    found = []
    for platform in platforms:
        with suppress(cl.Error):  # a platform without a device
            found += platform.get_devices()
    _take_signals_back()
    return sorted(found, key=lambda handle: not is_gpu(handle))


def _take_signals_back() -> None:
    """Handle signals as before: PoCL's compiler, LLVM, takes them as its devices are listed.

    At Ctrl-C it would remove the files that it is working on, under itself, before Python hears of
    it: a build that fails, or the end of the process.
    """
    if threading.current_thread() is threading.main_thread():
        for number in signal.valid_signals():
            handler = signal.getsignal(number)
            if callable(handler):
                signal.signal(number, handler)


def is_gpu(handle: cl.Device) -> bool:
    return bool(handle.type & cl.device_type.GPU)


def info_of(handle: cl.Device) -> DeviceInfo:
    return DeviceInfo(
        name=handle.name.strip(),
        platform=handle.platform.name.strip(),
        is_gpu=is_gpu(handle),
        memory=int(handle.global_mem_size),
        largest_buffer=int(handle.max_mem_alloc_size),
    )


def choose(name: str | None) -> cl.Device:
    found = handles()
    infos = [info_of(handle) for handle in found]
    choice = os.environ.get(PYOPENCL_VARIABLE)
    if found and name is None and choice:
        try:
            return cl.choose_devices(interactive=False)[0]
        except (cl.Error, RuntimeError) as error:
            what = f"unknown device, {PYOPENCL_VARIABLE}={choice!r}"
            raise DeviceError(f"{what}: {error}; here: {listing(infos)}") from None
    return found[find_device(infos, name)]


class named:
    """Turn the driver's errors inside the block into ours, which say `what` failed, as words."""

    __slots__ = ("_what",)

    def __init__(self, *what: object) -> None:
        self._what = what

    def __enter__(self) -> None:
        pass

    def __exit__(
        self, kind: object, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if isinstance(error, cl.Error):
            name = " ".join(map(str, self._what))
            if isinstance(error, cl.MemoryError):
                raise DeviceMemoryError(f"{name}: the device is out of memory ({error})") from None
            raise DeviceError(f"{name}: {error}") from None
