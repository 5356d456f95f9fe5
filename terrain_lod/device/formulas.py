"""A formula for a kernel: the header that has it, and the numbers that it reads by name."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..arguments import array, file_path, finite, told
from ..errors import FileError, InputError
from .device import Device, DeviceArray
from .sources import KERNELS, Define


def formula_defines(
    word: str, header: str | Path, parameters: Mapping[str, float], *, prefix: str = ""
) -> dict[str, Define]:
    """Return what a kernel is built with: the header as `word`, and each number's index by name.

    Parameters
    ----------
    word : str
        What the kernel file includes: ``"LOD"``.
    header : str or Path
        A file of ``kernels/``, or the path of any other.
    parameters : mapping of str to float
    prefix : str, optional
        Of the numbers' names in capitals: ``LOD_NEAR``.

    Raises
    ------
    InputError
        If `header` is no file of ``kernels/``, or a name is none in C.
    FileError
        If there is no such file.
    """
    names = {f"{prefix}{name}".upper(): index for index, name in enumerate(parameters)}
    if odd := [name for name in names if not (name.isidentifier() and name.isascii())]:
        raise InputError(f"expected names of letters, digits and _ for numbers, got {odd[0]!r}")
    if isinstance(header, Path):
        header = file_path("header", header)
        if not header.is_file():
            raise FileError(f"expected a header at {header}, got no such file")
        return {word: header, **names}
    known = isinstance(header, str) and not Path(header).is_absolute()
    if not known or not os.path.isfile(str(KERNELS / header)):
        raise InputError(
            f"expected a header of kernels/ or a pathlib.Path to one, got {told(header)}"
        )
    return {word: f'"{header}"', **names}


def formula_numbers(device: Device, parameters: Mapping[str, float]) -> DeviceArray:
    """Return the numbers that a header reads, on the device; (N,) float32, at least one.

    Raises
    ------
    InputError
        If one is not a finite number.
    """
    numbers = [finite(f"{name} in parameters()", value) for name, value in parameters.items()]
    return device.array(array("parameters()", numbers or [0.0], ("N",), np.float32))
