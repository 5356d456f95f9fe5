"""What kernels take: an argument's C type, the dtype that fits it, and the check of a value.

A float64 buffer handed to a ``float *``, or an index that does not fit an ``int``, is accepted in
silence by OpenCL and gives garbage; here it is refused in one line.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import Any, Final

import numpy as np

from ..errors import DeviceError
from . import layout

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
class Parameter:
    """One argument of a kernel, as its source declares it.

    Attributes
    ----------
    kernel, name : str
    type_name : str
        ``"float*"``, ``"int"``, ``"Grid"``.
    is_local : bool
        A ``__local`` pointer, which takes a number of bytes.
    """

    kernel: str
    name: str
    type_name: str
    is_local: bool

    @cached_property
    def is_pointer(self) -> bool:
        return self.type_name.endswith("*")

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        """Of the value, or of a pointer's elements: a ``float4*`` takes float32, four to each."""
        element = self.type_name.removesuffix("*").strip()
        if element in layout.STRUCTS:
            return layout.STRUCTS[element]
        scalar = _SCALARS.get(element.rstrip("0123456789"))
        if scalar is None:
            raise DeviceError(
                f"kernel {self.kernel} declares {self.type_name} {self.name}: "
                f"expected a struct of layout.py or one of {', '.join(_SCALARS)}"
            )
        return np.dtype(scalar)

    @cached_property
    def _whole(self) -> range:
        """The whole numbers that fit it as they are."""
        if self.dtype.kind not in "iu":
            return range(-(2**24), 2**24 + 1)
        limits = np.iinfo(self.dtype)
        return range(int(limits.min), int(limits.max) + 1)

    def scalar(self, value: object) -> np.generic | np.ndarray[Any, Any]:
        """Return `value` as the kernel's own scalar or struct.

        Raises
        ------
        DeviceError
            If it is no such thing, or would not fit: nothing wraps, nothing is cut off.
        """
        if type(value) is int and not self.dtype.names and value in self._whole:
            whole: np.generic = self.dtype.type(value)
            return whole
        if self.dtype.names:
            if not isinstance(value, np.void | np.ndarray):
                raise self.refusal(value)
            if value.dtype == self.dtype and value.shape == ():
                return value
        elif isinstance(value, int | float | np.integer | np.floating | np.bool_):
            try:
                with np.errstate(all="ignore"):
                    scalar: np.generic = self.dtype.type(value)
            except (OverflowError, ValueError):  # 2**40 as int, NaN as int
                raise self.refusal(value) from None
            # rounding to float32 is meant; overflow, or a fraction cut off, never is
            is_float = self.dtype.kind == "f"
            if isfinite(scalar) == isfinite(value) if is_float else scalar == value:
                return scalar
        raise self.refusal(value)

    def refusal(self, value: object) -> DeviceError:
        """Return the error that says what was expected and what came."""
        wanted = self.dtype.name
        if self.is_local:
            wanted = "a number of bytes"
        elif self.is_pointer:
            wanted = f"a DeviceArray of {wanted}"
        return DeviceError(
            f"kernel {self.kernel} expected {self.type_name} {self.name} ({wanted}), "
            f"got {_described(value)}"
        )


def _described(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"a host array of {value.shape} {value.dtype.name}"
    return repr(value)
