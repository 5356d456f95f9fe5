"""Arrays in device memory."""

from __future__ import annotations

import weakref
from math import prod
from operator import index
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import pyopencl as cl

from ..errors import InputError
from .drivers import named

if TYPE_CHECKING:
    from .device import Device


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
        with named(what):
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
            with named("reading", self):
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
            with named("writing", self):
                cl.enqueue_copy(self.device.queue, self.buffer, flat, dst_offset=offset)

    def fill(self, value: float) -> DeviceArray:
        """Set every element to `value` and return the array."""
        if self.size:
            pattern = np.full(1, value, self.dtype)
            with named("filling", self):
                cl.enqueue_fill_buffer(self.device.queue, self.buffer, pattern, 0, self.nbytes)
        return self
