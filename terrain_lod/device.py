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
import weakref
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from math import prod
from typing import Any, Final

import numpy as np
import numpy.typing as npt
import pyopencl as cl

from . import layout
from .errors import DeviceError, DeviceMemoryError, InputError
from .sources import kernel_source

DEVICE_VARIABLE: Final = "TERRAIN_LOD_DEVICE"

# OpenCL C's scalar type names, as -cl-kernel-arg-info reports them
_SCALARS: Final = {
    "char": np.int8,
    "uchar": np.uint8,
    "short": np.int16,
    "ushort": np.uint16,
    "int": np.int32,
    "uint": np.uint32,
    "long": np.int64,
    "ulong": np.uint64,
    "float": np.float32,
    "double": np.float64,
}


@dataclass(frozen=True)
class DeviceInfo:
    """One OpenCL device of this machine.

    Attributes
    ----------
    name, platform : str
        As the driver reports them.
    is_gpu : bool
    memory, largest_buffer : int
        Bytes in all, and in one allocation.
    """

    name: str
    platform: str
    is_gpu: bool
    memory: int
    largest_buffer: int

    @property
    def kind(self) -> str:
        """``"GPU"`` or ``"CPU"``."""
        return "GPU" if self.is_gpu else "CPU"

    def __str__(self) -> str:
        return f"{self.name} ({self.kind}, {self.platform}, {gibibytes(self.memory)})"


def gibibytes(count: int) -> str:
    """Return a byte count as people read it: ``"1.50 GiB"``."""
    return f"{count / 2**30:.2f} GiB"


def devices() -> tuple[DeviceInfo, ...]:
    """Return every OpenCL device of this machine, GPUs first."""
    return tuple(_info(handle) for handle in _handles())


def _handles() -> list[cl.Device]:
    try:
        platforms = cl.get_platforms()
    except cl.Error:  # no driver at all
        return []
    found = []
    for platform in platforms:
        try:
            found += platform.get_devices()
        except cl.Error:  # a platform without a device
            continue
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
    """Return the device whose name or platform holds `name`; None takes a GPU, else a CPU."""
    handles = _handles()
    if not handles:
        raise DeviceError(
            "expected an OpenCL device, found none: install one with  pip install 'pyopencl[pocl]'"
        )
    if name is None:
        return handles[0]
    wanted = name.lower()
    for handle in handles:
        info = _info(handle)
        if wanted == info.kind.lower() or wanted in f"{info.name} {info.platform}".lower():
            return handle
    existing = "; ".join(str(_info(handle)) for handle in handles)
    raise DeviceError(
        f"unknown device {name!r}: expected part of a name, cpu or gpu; here: {existing}"
    )


@dataclass
class Timeline:
    """Seconds of device time by stage, of the launches inside ``with device.timed()``.

    A stage is a kernel file's stem: ``"hull"``, ``"tessellator"``.
    """

    _events: list[tuple[str, cl.Event]] = field(default_factory=list)

    def add(self, stage: str, event: cl.Event) -> None:
        """Count a launch."""
        self._events.append((stage, event))

    @property
    def seconds(self) -> dict[str, float]:
        """Sum of kernel times a stage, in order of first launch; waits for them to end."""
        total: dict[str, float] = {}
        for stage, event in self._events:
            event.wait()
            elapsed = (event.profile.end - event.profile.start) * 1e-9
            total[stage] = total.get(stage, 0.0) + elapsed
        return total


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
        self.shape = shape
        self.dtype: np.dtype[Any] = np.dtype(dtype)
        # OpenCL has no empty buffers: one element stands in for none
        nbytes = max(self.nbytes, self.dtype.itemsize)
        device.require(f"an array of {shape} {self.dtype.name}", nbytes)
        self.buffer = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, nbytes)
        device.allocated += nbytes
        weakref.finalize(self, device.release, nbytes)

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
            cl.enqueue_copy(self.device.queue, self.buffer, flat, dst_offset=offset)

    def fill(self, value: float) -> DeviceArray:
        """Set every element to `value` and return the array."""
        if self.size:
            pattern = np.full(1, value, self.dtype)
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
        self._parameters = {
            handle.get_arg_info(index, cl.kernel_arg_info.NAME): _Parameter.of(handle, index)
            for index in range(handle.num_args)
        }

    def __call__(
        self, global_size: tuple[int, ...], local_size: tuple[int, ...], **arguments: object
    ) -> None:
        if arguments.keys() != self._parameters.keys():
            expected, got = ", ".join(self._parameters), ", ".join(arguments)
            raise DeviceError(f"kernel {self.name} expected arguments ({expected}), got ({got})")
        values = [
            parameter.convert(self.name, name, arguments[name])
            for name, parameter in self._parameters.items()
        ]
        padded = tuple(
            -(-extent // local) * local
            for extent, local in zip(global_size, local_size, strict=True)
        )
        if 0 in padded:
            return
        with self.device.lock:  # kernel objects hold their arguments: one launch at a time
            self._handle.set_args(*values)
            event = cl.enqueue_nd_range_kernel(self.device.queue, self._handle, padded, local_size)
            self.device.record(self.stage, event)


@dataclass(frozen=True)
class _Parameter:
    """What a kernel wants for one argument: its C type, and the dtype that fits it."""

    type_name: str
    is_local: bool
    dtype: np.dtype[Any]

    @classmethod
    def of(cls, handle: cl.Kernel, index: int) -> _Parameter:
        info = cl.kernel_arg_info
        type_name = handle.get_arg_info(index, info.TYPE_NAME)
        qualifier = handle.get_arg_info(index, info.ADDRESS_QUALIFIER)
        element = type_name.removesuffix("*").strip()
        is_local = qualifier == cl.kernel_arg_address_qualifier.LOCAL
        if element in layout.STRUCTS:
            return cls(type_name, is_local, layout.STRUCTS[element])
        # a float4 pointer takes float32 elements, four to a value
        return cls(type_name, is_local, np.dtype(_SCALARS[element.rstrip("0123456789")]))

    def convert(self, kernel: str, name: str, value: object) -> object:
        """Return what ``set_args`` takes for `value`, or say what was expected."""
        if self.is_local:
            if isinstance(value, int):
                return cl.LocalMemory(value)
        elif self.type_name.endswith("*"):
            if isinstance(value, DeviceArray) and value.dtype == self.dtype:
                return value.buffer
        elif self.dtype.names:
            if getattr(value, "dtype", None) == self.dtype:
                return value
        elif isinstance(value, int | float | np.generic):
            scalar = self.dtype.type(value)
            if self.dtype.kind == "f" or scalar == value:
                return scalar
        raise DeviceError(
            f"kernel {kernel} expected {self.type_name} {name} ({self.dtype.name}), got {value!r}"
        )


class Device:
    """An OpenCL device with its queue, its built kernels and its memory account.

    Open one with :meth:`open`; opened devices are kept and shared.
    """

    def __init__(self, handle: cl.Device) -> None:
        self.info = _info(handle)
        self.context = cl.Context([handle])
        self.queue = cl.CommandQueue(
            self.context, properties=cl.command_queue_properties.PROFILING_ENABLE
        )
        self.lock = threading.RLock()
        self.allocated = 0
        self._exact_division = bool(
            handle.single_fp_config & cl.device_fp_config.CORRECTLY_ROUNDED_DIVIDE_SQRT
        )
        self._kernels: dict[tuple[object, ...], Kernel] = {}
        self._programs: dict[tuple[object, ...], cl.Program] = {}
        self._timelines: list[Timeline] = []

    @classmethod
    def open(cls, name: str | None = None) -> Device:
        """Return the device called `name`.

        Parameters
        ----------
        name : str, optional
            Part of a device's or platform's name in any case, ``"cpu"`` or ``"gpu"``. Default:
            the environment's ``TERRAIN_LOD_DEVICE``, else a GPU if there is one, else the CPU.

        Raises
        ------
        DeviceError
            If there is no such device; the message lists those that exist.
        """
        return _open(_choose(name or os.environ.get(DEVICE_VARIABLE) or None))

    def __repr__(self) -> str:
        return f"<Device {self.info}>"

    @property
    def is_gpu(self) -> bool:
        return self.info.is_gpu

    def group_size(self, wanted: int = 64) -> int:
        """Work-items that share one tile or patch: `wanted` on a GPU, one on a CPU."""
        return wanted if self.is_gpu else 1

    # memory

    def require(self, what: str, *nbytes: int) -> None:
        """Refuse allocations of `nbytes` each for `what` where the device cannot hold them.

        Raises
        ------
        DeviceMemoryError
            With the bytes wanted and had.
        """
        for wanted, had, where in (
            (sum(nbytes), self.info.memory - self.allocated, "free"),
            (max(nbytes), self.info.largest_buffer, "in one buffer"),
        ):
            if wanted > had:
                raise DeviceMemoryError(
                    f"{what} wants {gibibytes(wanted)} ({wanted} bytes), {self.info.name} has "
                    f"{gibibytes(had)} ({had} bytes) {where}: use a smaller raster or larger device"
                )

    def release(self, nbytes: int) -> None:
        """Take `nbytes` off the account; arrays call it when they go."""
        self.allocated -= nbytes

    def empty(self, shape: int | tuple[int, ...], dtype: npt.DTypeLike) -> DeviceArray:
        """Return an array of device memory, not initialised."""
        return DeviceArray(self, (shape,) if isinstance(shape, int) else tuple(shape), dtype)

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
        """Return kernel `name` of ``kernels/<file>``, built once a set of `defines` and kept.

        Raises
        ------
        DeviceError
            With the compiler's log, if it does not build.
        """
        key = (file, name, *sorted(defines.items()))
        with self.lock:
            if key not in self._kernels:
                handle = cl.Kernel(self._program(file, defines), name)
                self._kernels[key] = Kernel(self, handle, stage=file.removesuffix(".cl"))
            return self._kernels[key]

    def _program(self, file: str, defines: Mapping[str, int | float | str]) -> cl.Program:
        key = (file, *sorted(defines.items()))
        if key not in self._programs:
            includes = {"layout.h": layout.header()}
            options = ["-cl-std=CL1.2", "-cl-kernel-arg-info"]
            if self._exact_division:
                options.append("-cl-fp32-correctly-rounded-divide-sqrt")
            heading = "".join(f"#define {name} {value}\n" for name, value in defines.items())
            source = heading + kernel_source(file, includes)
            try:
                self._programs[key] = cl.Program(self.context, source).build(options)
            except cl.RuntimeError as error:
                message = f"kernels/{file} does not build on {self.info}:\n{error}"
                raise DeviceError(message) from None
        return self._programs[key]

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
        """Add a launch to every open timeline ."""
        for timeline in self._timelines:
            timeline.add(stage, event)


@cache
def _open(handle: cl.Device) -> Device:
    return Device(handle)
