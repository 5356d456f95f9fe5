"""Kernel text: files of ``kernels/`` with their includes resolved.

Include paths given to the compiler break where a path holds a space, and cannot hold a generated
header. So ``#include "name"`` is replaced here by the file's text, once a file, between ``#line``
directives that keep the line numbers of build errors true.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib.resources import files
from numbers import Integral
from typing import Final

from .errors import DeviceError

KERNELS: Final = files(f"{__package__}.kernels")

_INCLUDE: Final = re.compile(r'\s*#\s*include\s+"([^"]+)"')


def kernel_source(
    file: str,
    generated: Mapping[str, str] | None = None,
    defines: Mapping[str, int | float | str] | None = None,
) -> str:
    """Return the text of ``kernels/<file>`` with its includes in place.

    Parameters
    ----------
    file : str
        Name of a file in the ``kernels`` folder.
    generated : mapping of str to str, optional
        Headers that exist as text only, by name.
    defines : mapping of str to int, float or str, optional
        Becomes ``#define`` lines above the text: a bool 0 or 1, a float a ``float`` literal.

    Raises
    ------
    DeviceError
        If a file or an include does not exist; names who asked for it.
    """
    heading = [f"#define {name} {_literal(value)}" for name, value in (defines or {}).items()]
    return "\n".join(heading + _resolve(file, "the engine", generated or {}, set())) + "\n"


def _literal(value: int | float | str) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Integral):
        return str(int(value))
    # without its f, 0.1 is a double and drags the arithmetic around it along
    return f"{float(value)!r}f"


def _resolve(file: str, asker: str, generated: Mapping[str, str], seen: set[str]) -> list[str]:
    if file in seen:
        return []
    seen.add(file)
    lines = [f'#line 1 "{file}"']
    for number, line in enumerate(_read(file, asker, generated).splitlines(), start=1):
        include = _INCLUDE.match(line)
        if include is None:
            lines.append(line)
            continue
        lines += _resolve(include[1], f"{file}:{number}", generated, seen)
        lines.append(f'#line {number + 1} "{file}"')
    return lines


def _read(file: str, asker: str, generated: Mapping[str, str]) -> str:
    if file in generated:
        return generated[file]
    path = KERNELS / file
    if not path.is_file():
        raise DeviceError(f"{asker} wants kernels/{file}: there is no such file")
    return path.read_text(encoding="utf-8")
