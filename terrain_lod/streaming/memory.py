"""How much may be held, as people say it."""

from __future__ import annotations

import re
from typing import Final

from ..arguments import finite, told
from ..errors import InputError
from ..files.rasters.limits import free_memory

# where nothing is said, the part of what is free
_PART: Final = 0.25

_SIZE: Final = re.compile(r"\s*([0-9.]+)\s*([kMGT]?)B?\s*", re.IGNORECASE)


def bytes_of(memory: int | str | None) -> int:
    """Return bytes of ``"512MB"``, ``"2 GB"`` or a number."""
    if memory is None:
        return int(_PART * (free_memory() or 2_000_000_000))
    if isinstance(memory, str):
        found = _SIZE.fullmatch(memory)
        try:
            assert found is not None
            powers = {"": 0, "k": 1, "m": 2, "g": 3, "t": 4}
            return int(float(found[1]) * 1000 ** powers[found[2].lower()])
        except (AssertionError, ValueError, OverflowError):
            raise InputError(f'expected memory such as "512MB", got {told(memory)}') from None
    return int(finite("memory", memory))
