"""Built kernels, launched by the names of their own arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pyopencl as cl

from ..errors import DeviceError
from .arrays import DeviceArray
from .drivers import named
from .parameters import Parameter

if TYPE_CHECKING:
    from .device import Device


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
        match value:
            case int() if parameter.is_local and value > 0:
                return cl.LocalMemory(value)
            case DeviceArray(device=self.device, dtype=parameter.dtype) if not parameter.is_local:
                return value.buffer
        raise parameter.refusal(value)
