"""The compute device, the arrays in its memory and the kernels that it runs.

This room alone imports pyopencl. Everything else sees four names: a :class:`Device`, its
:class:`Kernel` objects, the :class:`DeviceArray` they read and write, and a :class:`Timeline`. The
first three know each other, and stand here side by side.

>>> device = Device.open()
>>> square = device.kernel("square.cl", "square")           # doctest: +SKIP
>>> square((count,), (64,), values=values, count=count)     # doctest: +SKIP
"""

from __future__ import annotations

import os
import threading
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache, cached_property
from math import prod
from operator import index
from pathlib import Path, PurePosixPath
from typing import Any, Final

import numpy as np
import numpy.typing as npt
import pyopencl as cl

from ..arguments import instance, text, told, whole
from ..errors import DeviceError, InputError
from . import layout
from .drivers import choose, info_of, named, require_own_process
from .info import require_memory
from .linker.offer import provide_linker
from .memory import Memory
from .parameters import Parameter
from .sources import Define, kernel_source, with_true_places
from .timeline import Timeline

DEVICE_VARIABLE: Final = "TERRAIN_LOD_DEVICE"
POCL: Final = "Portable Computing Language"

_LANES: Final = 8  # of a CPU's vectors
_MOST: Final = 2**31  # tiles, or work-items of a group
_RUNS: Final = 1024  # launching a group costs a CPU as much as a tile
# programs that are kept built: ground at two tile sizes and a mesh beside it want no more. PoCL
# holds 3 to 5 MB for each
_KEPT: Final = 32

_opening = threading.Lock()


class Device:
    """An OpenCL device with its queue, its built kernels and its memory account.

    Open one with :meth:`open`; opened devices are kept and shared.
    """

    def __init__(self, handle: cl.Device) -> None:
        instance("a device of pyopencl (Device.open() finds one)", handle, cl.Device)
        self.info = info_of(handle)
        if self.info.platform == POCL:
            provide_linker()
        with named(f"opening {self.info}"):
            self.context = cl.Context([handle])
            self._queue = cl.CommandQueue(
                self.context, properties=cl.command_queue_properties.PROFILING_ENABLE
            )
        self.memory = Memory(self.info.memory, self.queue)
        self.lock = threading.RLock()  # of the built kernels
        self.has_doubles = "cl_khr_fp64" in handle.extensions.split()
        self._exact_division = bool(
            handle.single_fp_config & cl.device_fp_config.CORRECTLY_ROUNDED_DIVIDE_SQRT
        )
        # by file and defines, or by the text with a header from elsewhere; used last at the end
        self._programs: dict[tuple[str, str], tuple[cl.Program, dict[str, Kernel]]] = {}
        self._of_thread = threading.local()

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
        if name is not None:
            text("a device", name)
        with _opening:  # threads share one
            return _open(choose(name or os.environ.get(DEVICE_VARIABLE) or None))

    @classmethod
    def of(cls, device: Device | None) -> Device:
        """Return the device that a caller gave, or the default one."""
        return cls.open() if device is None else instance("a Device for device", device, cls)

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
        wanted = whole("wanted", wanted, 1, _MOST)
        return wanted if self.is_gpu else 1

    def runs(self, count: int) -> int:
        """Work-groups for `count` tiles or patches: one each on a GPU, runs of them on a CPU."""
        count = whole("count", count, 0, _MOST)
        return count if self.is_gpu else min(count, _RUNS)

    @property
    def lanes(self) -> int:
        """Things that one work-item computes side by side; ``kernels/common/lanes.h``."""
        return 1 if self.is_gpu else _LANES

    # memory

    @property
    def allocated(self) -> int:
        """Bytes that arrays have in use."""
        return self.memory.allocated

    def require(self, what: object, *nbytes: int) -> None:
        """Refuse allocations of `nbytes` each for `what` where the device cannot hold them.

        Raises
        ------
        DeviceMemoryError
            With the bytes wanted and had.
        """
        require_memory(self.info, self.allocated, what, _counts("nbytes", nbytes))

    def require_doubles(self, what: str) -> None:
        """Refuse `what` where the device has no 64-bit floats."""
        if not self.has_doubles:
            raise DeviceError(
                f"{what} want a device with 64-bit floats, {self.info.name} has none: "
                "choose another, a CPU for one"
            )

    def empty(self, shape: int | tuple[int, ...], dtype: npt.DTypeLike) -> DeviceArray:
        """Return an array of device memory, not initialised."""
        return DeviceArray(self, shape if isinstance(shape, tuple) else (shape,), dtype)

    def zeros(self, shape: int | tuple[int, ...], dtype: npt.DTypeLike) -> DeviceArray:
        """Return an array of device memory, all zero."""
        return self.empty(shape, dtype).fill(0)

    def array(self, values: npt.NDArray[Any]) -> DeviceArray:
        """Return a copy of host `values` in device memory."""
        values = np.asarray(instance("an array for values", values, np.ndarray))
        target = self.empty(values.shape, values.dtype)
        target.write(values)
        return target

    def finish(self) -> None:
        """Wait until everything launched has ended."""
        with named("what was launched on", self.info.name):
            self.queue.finish()

    # kernels

    def kernel(self, file: str, name: str, **defines: Define) -> Kernel:
        """Return kernel `name` of ``kernels/<file>``, built for a set of `defines`.

        Programs that were lately asked for are kept. A header from elsewhere is read every time, so
        that one that was edited is built again.

        Raises
        ------
        DeviceError
            With the compiler's log, if it does not build.
        FileError
            If a header from elsewhere cannot be read.
        """
        require_own_process()
        text("file", file), text("name", name)
        source, content = None, repr(sorted(defines.items()))  # 1, 1.0 and True differ
        if any(isinstance(value, Path) for value in defines.values()):
            source = content = self._source(file, defines)
        key = (file, content)
        with self.lock:
            if key not in self._programs:
                source = source or self._source(file, defines)
                self._programs[key] = self._build(file, source), {}
            program, kernels = self._programs[key] = self._programs.pop(key)
            if len(self._programs) > _KEPT:
                del self._programs[next(iter(self._programs))]
            if name not in kernels:
                with named(f"kernel {name} of kernels/{file}"):
                    handle = cl.Kernel(program, name)
                kernels[name] = Kernel(self, handle, stage=PurePosixPath(file).stem)
            return kernels[name]

    def _source(self, file: str, defines: Mapping[str, Define]) -> str:
        return kernel_source(file, {"layout.h": layout.header()}, defines)

    def _build(self, file: str, source: str) -> cl.Program:
        options = ["-cl-std=CL1.2", "-cl-kernel-arg-info"]
        if self._exact_division:
            options.append("-cl-fp32-correctly-rounded-divide-sqrt")
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
        """Collect the times of the launches that this thread makes inside the block."""
        timeline = Timeline()
        self._open_timelines.append(timeline)
        try:
            yield timeline
        finally:
            self._open_timelines.pop()

    def record(self, stage: str, event: cl.Event) -> None:
        """Add a launch to every timeline that this thread has open."""
        for timeline in self._open_timelines:
            timeline.add(stage, event)

    @property
    def _open_timelines(self) -> list[Timeline]:
        mine: list[Timeline] = self._of_thread.__dict__.setdefault("timelines", [])
        return mine


class DeviceArray:
    """A typed array in device memory; ``host()`` brings it down.

    On a CPU its memory is this machine's: ``view()``, ``np.asarray``, and ``from_dlpack`` of any
    library that knows DLPack, take it without a copy.

    Attributes
    ----------
    shape : tuple of int
    dtype : numpy.dtype
    device : Device
    buffer : pyopencl.MemoryObject
        Of ``device.context``: what kernels of others take. It is given back with the array.
    """

    def __init__(self, device: Device, shape: tuple[int, ...], dtype: npt.DTypeLike) -> None:
        self.device = device
        self.shape = _counts("shape", shape)
        self.dtype: np.dtype[Any] = _number_type(dtype)
        # OpenCL has no empty buffers: one element stands in for none
        nbytes = max(self.nbytes, self.dtype.itemsize)
        device.require(self, nbytes)
        with named(self):
            self.buffer = device.memory.allocate(nbytes)
        device.memory.account(nbytes)
        self._accounted = nbytes
        self._whole: DeviceArray | None = None

    def __del__(self) -> None:
        if (mapped := self.__dict__.get("_mapped")) is not None and self.size:
            mapped.base.release()
        # those that no memory was found for have none to give back
        if accounted := self.__dict__.get("_accounted"):
            self.device.memory.account(-accounted)

    @property
    def size(self) -> int:
        return prod(self.shape)

    @property
    def nbytes(self) -> int:
        return self.size * self.dtype.itemsize

    def __str__(self) -> str:
        return f"an array of {self.shape} {self.dtype.name}"

    def __repr__(self) -> str:
        return f"<DeviceArray {self.shape} {self.dtype.name} on {self.device.info.name}>"

    def host(self) -> npt.NDArray[Any]:
        """Return a copy in host memory; waits for every launch before it."""
        values = np.empty(self.shape, self.dtype)
        if self.size:
            with named("reading", self):
                cl.enqueue_copy(self.device.queue, values, self.buffer)
        return values

    def view(self) -> npt.NDArray[Any]:
        """Return its memory as an array of NumPy, without a copy; waits for every launch before.

        The view keeps the array alive, and every view of an array is of the same memory.

        Raises
        ------
        DeviceError
            If the device has memory of its own, as GPUs have: ``host()`` copies.
        """
        if self.device.is_gpu:
            raise DeviceError(
                f"expected memory that this machine's CPU sees, got {self} on "
                f"{self.device.info.name}: copy it with host()"
            )
        self.device.finish()
        return np.asarray(self)

    @cached_property
    def _mapped(self) -> npt.NDArray[Any]:
        if not self.size:
            return np.empty(self.shape, self.dtype)
        flags = cl.map_flags.READ | cl.map_flags.WRITE
        with named("mapping", self):
            mapped: npt.NDArray[Any] = cl.enqueue_map_buffer(
                self.device.queue, self.buffer, flags, 0, self.shape, self.dtype
            )[0]
        return mapped

    @property
    def __array_interface__(self) -> dict[str, Any]:
        """What NumPy makes a view of; there is none on devices with memory of their own."""
        if self.device.is_gpu:
            raise AttributeError(f"{self} has no __array_interface__: copy it with host()")
        return self._mapped.__array_interface__

    def __dlpack__(self, **options: Any) -> Any:
        """Return a capsule of DLPack for the same memory as :meth:`view`, which it keeps alive."""
        return self.view().__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        """Return DLPack's number of this machine's CPU."""
        kind, number = self.view().__dlpack_device__()
        return int(kind), int(number)

    def write(self, values: npt.ArrayLike, start: int = 0) -> None:
        """Overwrite elements from flat index `start` on with host `values`."""
        flat = np.ascontiguousarray(values, self.dtype).ravel()
        if start < 0 or start + flat.size > self.size:
            raise InputError(
                f"expected at most {self.size - start} values from index {start}, got {flat.size}"
            )
        if flat.size:
            offset = start * self.dtype.itemsize
            with named("writing", self):
                cl.enqueue_copy(self.device.queue, self.buffer, flat, dst_offset=offset)

    def head(self, rows: int) -> DeviceArray:
        """Return its first rows, in the same memory."""
        part = object.__new__(DeviceArray)
        part.device, part.dtype, part.buffer = self.device, self.dtype, self.buffer
        part.shape = (min(rows, self.shape[0]), *self.shape[1:])
        part._whole = self  # which is counted as long as there are parts of it
        return part

    def copy(self, first: int, end: int) -> DeviceArray:
        """Return another array of the rows from `first` to before `end`."""
        other = self.device.empty((end - first, *self.shape[1:]), self.dtype)
        other._take(self, other.nbytes, src_offset=first * self._row)
        return other

    def paste(self, other: DeviceArray, first: int) -> None:
        """Overwrite the rows from `first` on with those of another array on the device."""
        self._take(other, other.nbytes, dst_offset=first * self._row)

    @property
    def _row(self) -> int:
        """Bytes of a row."""
        return prod(self.shape[1:]) * self.dtype.itemsize

    def _take(self, other: DeviceArray, count: int, **offset: int) -> None:
        if count:
            with named("copying", other):
                queue = self.device.queue
                cl.enqueue_copy(queue, self.buffer, other.buffer, byte_count=count, **offset)

    def fill(self, value: float) -> DeviceArray:
        """Set every element to `value` and return the array."""
        if self.size:
            pattern = np.full(1, value, self.dtype)
            with named("filling", self):
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
        with self.device.lock, named("kernel", self.name, *work):
            self._handle.set_args(*values)
            event = cl.enqueue_nd_range_kernel(self.device.queue, self._handle, padded, local_size)
            self.device.record(self.stage, event)

    def _convert(self, parameter: Parameter, value: object) -> object:
        """Return what OpenCL takes for `value`, or say what was expected."""
        if not parameter.is_pointer:
            return parameter.scalar(value)
        if isinstance(value, DeviceArray):
            if (
                value.device is self.device
                and value.dtype == parameter.dtype
                and not parameter.is_local
            ):
                return value.buffer
        elif isinstance(value, int) and parameter.is_local and value > 0:
            return cl.LocalMemory(value)
        raise parameter.refusal(value)


def _counts(name: str, values: Iterable[object]) -> tuple[int, ...]:
    """Return whole numbers as they are; arrays are made too often for more than this."""
    try:
        counts = tuple(map(index, values))  # type: ignore[arg-type]
    except TypeError:
        counts = (-1,)
    if counts and min(counts) < 0:
        raise InputError(f"expected whole numbers >= 0 for {name}, got {told(values)}")
    return counts


def _number_type(dtype: npt.DTypeLike) -> np.dtype[Any]:
    """Return a dtype of numbers, or of records of them."""
    try:
        made = np.dtype(dtype)
    except (TypeError, ValueError):
        raise InputError(f"expected a dtype, got {told(dtype)}") from None
    if made.hasobject or made.kind not in "biufV":
        raise InputError(f"expected a dtype of numbers, got {made}")
    return made


@cache
def _open(handle: cl.Device) -> Device:
    return Device(handle)
