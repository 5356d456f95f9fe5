"""Kernel text: files of ``kernels/`` with their includes resolved.

Include paths given to the compiler break where a path holds a space, and cannot hold a generated
header. So ``#include "name"`` is replaced here by the file's text, once a file, between ``#line``
directives that keep the line numbers of build errors true.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib.resources import files
from typing import Final

from .errors import DeviceError

_INCLUDE: Final = re.compile(r'\s*#\s*include\s+"([^"]+)"')


def kernel_source(file: str, generated: Mapping[str, str]) -> str:
    """Return the text of ``kernels/<file>`` with its includes in place.

    Parameters
    ----------
    file : str
        Name of a file in the ``kernels`` folder.
    generated : mapping of str to str
        Headers that exist as text only, by name.

    Raises
    ------
    DeviceError
        If a file or an include does not exist; names who asked for it.
    """
    return "\n".join(_resolve(file, "the engine", generated, set())) + "\n"


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
    path = files(f"{__package__}.kernels") / file
    if not path.is_file():
        raise DeviceError(f"{asker} wants kernels/{file}: there is no such file")
    return path.read_text(encoding="utf-8")
