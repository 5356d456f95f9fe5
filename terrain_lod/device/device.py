"""The compute device: its queue, its built kernels, its memory and its clock.

This room alone imports pyopencl. Everything else sees four names: a :class:`Device`, its
:class:`Kernel` objects, the :class:`DeviceArray` they read and write, and a :class:`Timeline`.

>>> device = Device.open()
>>> square = device.kernel("square.cl", "square")           # doctest: +SKIP
>>> square((count,), (64,), values=values, count=count)     # doctest: +SKIP
"""

from __future__ import annotations

import os
import threading
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import PurePosixPath
from typing import Any, Final

import numpy.typing as npt
import pyopencl as cl
from pyopencl.tools import ImmediateAllocator, MemoryPool

from ..errors import DeviceError
from . import layout
from .arrays import DeviceArray
from .drivers import choose, info_of, named, require_own_process
from .info import require_memory
from .kernels import Kernel
from .linker.offer import provide_linker
from .sources import kernel_source, with_true_places
from .timeline import Timeline

DEVICE_VARIABLE: Final = "TERRAIN_LOD_DEVICE"
POCL: Final = "Portable Computing Language"

# larger allocations are given back at once
_LARGEST_KEPT: Final = 2**28
_LANES: Final = 8  # of a CPU's vectors
# programs that are kept built: ground at two tile sizes and a mesh beside it want no more. PoCL
# holds 3 to 5 MB for each
_KEPT: Final = 32

_opening = threading.Lock()


class Device:
    """An OpenCL device with its queue, its built kernels and its memory account.

    Open one with :meth:`open`; opened devices are kept and shared.
    """

    def __init__(self, handle: cl.Device) -> None:
        self.info = info_of(handle)
        if self.info.platform == POCL:
            provide_linker()
        with named(f"opening {self.info}"):
            self.context = cl.Context([handle])
            self._queue = cl.CommandQueue(
                self.context, properties=cl.command_queue_properties.PROFILING_ENABLE
            )
        self.lock = threading.RLock()
        self.allocated = 0
        self._pool = MemoryPool(ImmediateAllocator(self.queue))
        self._lately = 0.0  # bytes in use at a time
        self.has_doubles = "cl_khr_fp64" in handle.extensions.split()
        self._exact_division = bool(
            handle.single_fp_config & cl.device_fp_config.CORRECTLY_ROUNDED_DIVIDE_SQRT
        )
        # by file and defines, the one used last at the end
        self._programs: dict[tuple[str, str], tuple[cl.Program, dict[str, Kernel]]] = {}
        self._timelines: list[Timeline] = []

    @classmethod
    def open(cls, name: str | None = None) -> Device:
        """Return the device called `name`.

        Parameters
        ----------
        name : str, optional
            Part of a device's or platform's name in any case, ``"cpu"``, ``"gpu"``, or its
            number in :func:`devices`. Default: the environment's ``TERRAIN_LOD_DEVICE``, else its
            ``PYOPENCL_CTX``, else a GPU if there is one, else the CPU.

        Raises
        ------
        DeviceError
            If there is no such device; the message lists those that exist.
        """
        with _opening:  # threads share one
            return _open(choose(name or os.environ.get(DEVICE_VARIABLE) or None))

    def __repr__(self) -> str:
        return f"<Device {self.info}>"

    @property
    def queue(self) -> cl.CommandQueue:
        """What every launch and transfer passes through."""
        require_own_process()
        return self._queue

    @property
    def is_gpu(self) -> bool:
        return self.info.is_gpu

    def group_size(self, wanted: int = 64) -> int:
        """Work-items that share one tile or patch: `wanted` on a GPU, one on a CPU."""
        return wanted if self.is_gpu else 1

    @property
    def lanes(self) -> int:
        """Things that one work-item computes side by side; ``kernels/common/lanes.h``."""
        return 1 if self.is_gpu else _LANES

    # memory

    def require(self, what: str, *nbytes: int) -> None:
        """Refuse allocations of `nbytes` each for `what` where the device cannot hold them.

        Raises
        ------
        DeviceMemoryError
            With the bytes wanted and had.
        """
        require_memory(self.info, self.allocated, what, nbytes)

    def require_doubles(self, what: str) -> None:
        """Refuse `what` where the device has no 64-bit floats."""
        if not self.has_doubles:
            raise DeviceError(
                f"{what} want a device with 64-bit floats, {self.info.name} has none: "
                "choose another, a CPU for one"
            )

    def allocate(self, nbytes: int) -> cl.MemoryObject:
        """Return memory, used before where there is some: pages new to a CPU cost most of all.

        What arrays have freed is kept for the next, which the queue's order makes safe: about as
        much as was lately in use at a time, and none where the device would run short.
        """
        require_own_process()  # before a lock that a thread may have held at the fork
        with self.lock:
            held = self._pool.managed_bytes - self._pool.active_bytes
            # half of it is forgotten in ten meshes, of some thirty arrays each
            self._lately = max(0.998 * self._lately, self._pool.active_bytes + nbytes)
            short = self._pool.managed_bytes + nbytes > self.info.memory // 2
            if nbytes > _LARGEST_KEPT or held > 1.5 * self._lately or short:
                self._pool.free_held()
            if nbytes > _LARGEST_KEPT:
                return cl.Buffer(self.context, cl.mem_flags.READ_WRITE, nbytes)
            return self._pool.allocate(nbytes)

    def trim(self) -> None:
        """Give back the memory that freed arrays have left for the next."""
        with self.lock:
            self._pool.free_held()

    def account(self, nbytes: int) -> None:
        """Count `nbytes` more in use, or fewer; arrays call it as they come and go."""
        with self.lock:
            self.allocated += nbytes

    def empty(self, shape: int | tuple[int, ...], dtype: npt.DTypeLike) -> DeviceArray:
        """Return an array of device memory, not initialised."""
        return DeviceArray(self, shape if isinstance(shape, tuple) else (shape,), dtype)

    def zeros(self, shape: int | tuple[int, ...], dtype: npt.DTypeLike) -> DeviceArray:
        """Return an array of device memory, all zero."""
        return self.empty(shape, dtype).fill(0)

    def array(self, values: npt.NDArray[Any]) -> DeviceArray:
        """Return a copy of host `values` in device memory."""
        target = self.empty(values.shape, values.dtype)
        target.write(values)
        return target

    def finish(self) -> None:
        """Wait until everything launched has ended."""
        self.queue.finish()

    # kernels

    def kernel(self, file: str, name: str, **defines: int | float | str) -> Kernel:
        """Return kernel `name` of ``kernels/<file>``, built for a set of `defines`.

        Programs that were lately asked for are kept.

        Raises
        ------
        DeviceError
            With the compiler's log, if it does not build.
        """
        require_own_process()
        key = (file, repr(sorted(defines.items())))  # 1, 1.0 and True differ
        with self.lock:
            if key not in self._programs:
                self._programs[key] = self._build(file, defines), {}
            program, kernels = self._programs[key] = self._programs.pop(key)
            if len(self._programs) > _KEPT:
                del self._programs[next(iter(self._programs))]
            if name not in kernels:
                with named(f"kernel {name} of kernels/{file}"):
                    handle = cl.Kernel(program, name)
                kernels[name] = Kernel(self, handle, stage=PurePosixPath(file).stem)
            return kernels[name]

    def _build(self, file: str, defines: Mapping[str, int | float | str]) -> cl.Program:
        options = ["-cl-std=CL1.2", "-cl-kernel-arg-info"]
        if self._exact_division:
            options.append("-cl-fp32-correctly-rounded-divide-sqrt")
        source = kernel_source(file, {"layout.h": layout.header()}, defines)
        try:
            with warnings.catch_warnings():
                # pyopencl warns of any remark that a compiler makes
                warnings.simplefilter("ignore", cl.CompilerWarning)
                return cl.Program(self.context, source).build(options)
        except cl.RuntimeError as error:
            log = with_true_places(str(error), source)
            raise DeviceError(f"kernels/{file} does not build on {self.info}:\n{log}") from None

    # time

    @contextmanager
    def timed(self) -> Iterator[Timeline]:
        """Collect the times of the launches inside the block."""
        timeline = Timeline()
        self._timelines.append(timeline)
        try:
            yield timeline
        finally:
            self._timelines.remove(timeline)

    def record(self, stage: str, event: cl.Event) -> None:
        """Add a launch to every open timeline."""
        for timeline in self._timelines:
            timeline.add(stage, event)


@cache
def _open(handle: cl.Device) -> Device:
    return Device(handle)
