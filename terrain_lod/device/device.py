"""The compute device: choose it, build kernels for it, launch them, time them.

The only module that imports pyopencl. Everything else sees four names: a :class:`Device`, its
:class:`Kernel` objects, the :class:`DeviceArray` they read and write, and a :class:`Timeline`.

>>> device = Device.open()
>>> square = device.kernel("square.cl", "square")           # doctest: +SKIP
>>> square((count,), (64,), values=values, count=count)     # doctest: +SKIP
"""

from __future__ import annotations

import os
import threading
import warnings
import weakref
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from math import prod
from operator import index
from typing import Any, Final

import numpy as np
import numpy.typing as npt
import pyopencl as cl
from pyopencl.tools import ImmediateAllocator, MemoryPool

from ..errors import DeviceError, DeviceMemoryError, InputError
from . import layout
from .info import (
    DeviceInfo,
    find_device,
    listing,
    require_memory,
)
from .linker.offer import provide_linker
from .parameters import Parameter
from .sources import kernel_source, with_true_places
from .timeline import Timeline

DEVICE_VARIABLE: Final = "TERRAIN_LOD_DEVICE"
PYOPENCL_VARIABLE: Final = "PYOPENCL_CTX"
POCL: Final = "Portable Computing Language"

# larger allocations are given back at once
_LARGEST_KEPT: Final = 2**28
_LANES: Final = 8  # of a CPU's vectors
# programs that are kept built: ground at two tile sizes and a mesh beside it want no more. PoCL
# holds 3 to 5 MB for each
_KEPT: Final = 32

_listing_process: int | None = None  # which process has listed devices
_opening = threading.Lock()


def devices() -> tuple[DeviceInfo, ...]:
    """Return every OpenCL device of this machine, GPUs first."""
    return tuple(_info(handle) for handle in _handles())


def _handles() -> list[cl.Device]:
    global _listing_process
    if _listing_process not in (None, os.getpid()):  # drivers' threads do not survive a fork
        raise DeviceError(
            "expected a process of its own for OpenCL, got a fork of one that uses it already: "
            "start workers with  multiprocessing.get_context('spawn')"
        )
    _listing_process = os.getpid()
    try:
        platforms = cl.get_platforms()
    except cl.Error:  # no driver at all
        return []
    found = []
    for platform in platforms:
        with suppress(cl.Error):  # a platform without a device
            found += platform.get_devices()
    return sorted(found, key=lambda handle: not _is_gpu(handle))


def _is_gpu(handle: cl.Device) -> bool:
    return bool(handle.type & cl.device_type.GPU)


def _info(handle: cl.Device) -> DeviceInfo:
    return DeviceInfo(
        name=handle.name.strip(),
        platform=handle.platform.name.strip(),
        is_gpu=_is_gpu(handle),
        memory=int(handle.global_mem_size),
        largest_buffer=int(handle.max_mem_alloc_size),
    )


def _choose(name: str | None) -> cl.Device:
    handles = _handles()
    infos = [_info(handle) for handle in handles]
    choice = os.environ.get(PYOPENCL_VARIABLE)
    if handles and name is None and choice:
        try:
            return cl.choose_devices(interactive=False)[0]
        except (cl.Error, RuntimeError) as error:
            what = f"unknown device, {PYOPENCL_VARIABLE}={choice!r}"
            raise DeviceError(f"{what}: {error}; here: {listing(infos)}") from None
    return handles[find_device(infos, name)]


@contextmanager
def _named(*what: object) -> Iterator[None]:
    """Turn the driver's errors inside the block into ours, which say `what` failed, as words."""
    try:
        yield
    except cl.Error as error:
        name = " ".join(map(str, what))
        if isinstance(error, cl.MemoryError):
            raise DeviceMemoryError(f"{name}: the device is out of memory ({error})") from None
        raise DeviceError(f"{name}: {error}") from None


class DeviceArray:
    """A typed array in device memory; ``host()`` brings it down.

    Attributes
    ----------
    shape : tuple of int
    dtype : numpy.dtype
    device : Device
    """

    def __init__(self, device: Device, shape: tuple[int, ...], dtype: npt.DTypeLike) -> None:
        self.device = device
        self.shape = tuple(index(extent) for extent in shape)
        self.dtype: np.dtype[Any] = np.dtype(dtype)
        # OpenCL has no empty buffers: one element stands in for none
        nbytes = max(self.nbytes, self.dtype.itemsize)
        what = f"an array of {self.shape} {self.dtype.name}"
        device.require(what, nbytes)
        with _named(what):
            self.buffer = device.allocate(nbytes)
        device.account(nbytes)
        weakref.finalize(self, device.account, -nbytes)

    @property
    def size(self) -> int:
        return prod(self.shape)

    @property
    def nbytes(self) -> int:
        return self.size * self.dtype.itemsize

    def __repr__(self) -> str:
        return f"<DeviceArray {self.shape} {self.dtype.name} on {self.device.info.name}>"

    def host(self) -> npt.NDArray[Any]:
        """Return a copy in host memory; waits for every launch before it."""
        values = np.empty(self.shape, self.dtype)
        if self.size:
            with _named("reading", self):
                cl.enqueue_copy(self.device.queue, values, self.buffer)
        return values

    def write(self, values: npt.ArrayLike, start: int = 0) -> None:
        """Overwrite elements from flat index `start` on with host `values`."""
        flat = np.ascontiguousarray(values, self.dtype).ravel()
        if start < 0 or start + flat.size > self.size:
            raise InputError(
                f"expected at most {self.size - start} values from index {start}, got {flat.size}"
            )
        if flat.size:
            offset = start * self.dtype.itemsize
            with _named("writing", self):
                cl.enqueue_copy(self.device.queue, self.buffer, flat, dst_offset=offset)

    def fill(self, value: float) -> DeviceArray:
        """Set every element to `value` and return the array."""
        if self.size:
            pattern = np.full(1, value, self.dtype)
            with _named("filling", self):
                cl.enqueue_fill_buffer(self.device.queue, self.buffer, pattern, 0, self.nbytes)
        return self


class Kernel:
    """One built kernel, launched by keyword.

    ``kernel(global_size, local_size, name=value, ...)``: the names are the kernel's own argument
    names. A pointer takes a :class:`DeviceArray` of its element type, a struct the matching
    ``layout`` record, a scalar a Python number, a ``__local`` pointer its number of bytes. The
    global size is rounded up to a multiple of the local one: kernels guard their stores.
    """

    def __init__(self, device: Device, handle: cl.Kernel, stage: str) -> None:
        self.device = device
        self.name: str = handle.function_name
        self.stage = stage
        self._handle = handle
        parameters = map(self._parameter, range(handle.num_args))
        self._parameters = {parameter.name: parameter for parameter in parameters}

    def _parameter(self, index: int) -> Parameter:
        info, qualifiers = cl.kernel_arg_info, cl.kernel_arg_address_qualifier
        return Parameter(
            kernel=self.name,
            name=self._handle.get_arg_info(index, info.NAME),
            type_name=self._handle.get_arg_info(index, info.TYPE_NAME),
            is_local=self._handle.get_arg_info(index, info.ADDRESS_QUALIFIER) == qualifiers.LOCAL,
        )

    def __call__(
        self, global_size: tuple[int, ...], local_size: tuple[int, ...], **arguments: object
    ) -> None:
        if arguments.keys() != self._parameters.keys():
            expected, got = ", ".join(self._parameters), ", ".join(arguments)
            raise DeviceError(f"kernel {self.name} expected arguments ({expected}), got ({got})")
        values = [
            self._convert(parameter, arguments[name])
            for name, parameter in self._parameters.items()
        ]
        extents = zip(global_size, local_size, strict=True)
        padded = tuple(-(-extent // local) * local for extent, local in extents)
        if 0 in padded:
            return
        # kernel objects hold their arguments: one launch at a time
        work = "on", padded, "work-items in groups of", local_size
        with self.device.lock, _named("kernel", self.name, *work):
            self._handle.set_args(*values)
            event = cl.enqueue_nd_range_kernel(self.device.queue, self._handle, padded, local_size)
            self.device.record(self.stage, event)

    def _convert(self, parameter: Parameter, value: object) -> object:
        """Return what OpenCL takes for `value`, or say what was expected."""
        if not parameter.is_pointer:
            return parameter.scalar(value)
        match value:
            case int() if parameter.is_local and value > 0:
                return cl.LocalMemory(value)
            case DeviceArray(device=self.device, dtype=parameter.dtype) if not parameter.is_local:
                return value.buffer
        raise parameter.refusal(value)


class Device:
    """An OpenCL device with its queue, its built kernels and its memory account.

    Open one with :meth:`open`; opened devices are kept and shared.
    """

    def __init__(self, handle: cl.Device) -> None:
        self.info = _info(handle)
        if self.info.platform == POCL:
            provide_linker()
        with _named(f"opening {self.info}"):
            self.context = cl.Context([handle])
            self.queue = cl.CommandQueue(
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
            return _open(_choose(name or os.environ.get(DEVICE_VARIABLE) or None))

    def __repr__(self) -> str:
        return f"<Device {self.info}>"

    @property
    def is_gpu(self) -> bool:
        return self.info.is_gpu

    def group_size(self, wanted: int = 64) -> int:
        """Work-items that share one tile or patch: `wanted` on a GPU, one on a CPU."""
        return wanted if self.is_gpu else 1

    @property
    def lanes(self) -> int:
        """Things that one work-item computes side by side; ``kernels/lanes.h``."""
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
        key = (file, repr(sorted(defines.items())))  # 1, 1.0 and True differ
        with self.lock:
            if key not in self._programs:
                self._programs[key] = self._build(file, defines), {}
            program, kernels = self._programs[key] = self._programs.pop(key)
            if len(self._programs) > _KEPT:
                del self._programs[next(iter(self._programs))]
            if name not in kernels:
                with _named(f"kernel {name} of kernels/{file}"):
                    handle = cl.Kernel(program, name)
                kernels[name] = Kernel(self, handle, stage=file.removesuffix(".cl"))
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
