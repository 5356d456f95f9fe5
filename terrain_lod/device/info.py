"""What is known of a device before it is opened, and which one a name means."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..errors import DeviceError, DeviceMemoryError


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


def find_device(infos: Sequence[DeviceInfo], name: str | None) -> int:
    """Return the number of the first device that `name` means; 0 where it is None.

    Parameters
    ----------
    infos : sequence of DeviceInfo
    name : str or None
        A number, ``"cpu"``, ``"gpu"`` or part of a device's or platform's name, in any case.

    Raises
    ------
    DeviceError
        If there is none; lists those that exist.
    """
    if not infos:
        raise DeviceError(
            "expected an OpenCL device, found none: install one with  pip install 'pyopencl[pocl]'"
        )
    if name is None:
        return 0
    wanted = name.strip().lower()
    for number, info in enumerate(infos):
        in_words = wanted in f"{info.name} {info.platform}".lower() and not wanted.isdigit()
        if wanted in (str(number), info.kind.lower()) or in_words:
            return number
    raise DeviceError(
        f"unknown device {name!r}: expected a number, cpu, gpu or part of a name; "
        f"here: {listing(infos)}"
    )


def listing(infos: Sequence[DeviceInfo]) -> str:
    """Return the devices with their numbers, on one line."""
    return "; ".join(f"{number}: {info}" for number, info in enumerate(infos))


def require_memory(info: DeviceInfo, allocated: int, what: object, nbytes: Sequence[int]) -> None:
    """Refuse allocations of `nbytes` each where `allocated` bytes are taken already.

    Raises
    ------
    DeviceMemoryError
        With the bytes wanted and had.
    """
    for wanted, had, where in (
        (sum(nbytes), info.memory - allocated, "free"),
        (max(nbytes), info.largest_buffer, "in one buffer"),
    ):
        if wanted > had:
            raise DeviceMemoryError(
                f"{what} wants {gibibytes(wanted)} ({wanted} bytes), {info.name} has "
                f"{gibibytes(had)} ({had} bytes) {where}: use a smaller raster or larger device"
            )
