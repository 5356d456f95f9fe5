"""Kernel text: files of ``kernels/``, and headers from elsewhere, with their includes resolved.

Include paths given to the compiler break where a path holds a space, and cannot hold a generated
header. So ``#include "name"`` is replaced here by the file's text, once a file, between ``#line``
directives that keep the line numbers of build errors true. A file is taken in where it is named
first, so a header that several files name stands above any ``#if``.

A header from elsewhere comes as the path that a define holds. It finds what it includes beside
itself, then in ``kernels/``; the files of ``kernels/`` never find theirs.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from importlib.resources import files
from numbers import Integral
from pathlib import Path
from typing import Final

from ..errors import DeviceError, FileError

KERNELS: Final = files("terrain_lod.kernels")

Define = int | float | str | Path
"""What a name is defined as: a number, a word, or the path of a header."""

_LINE: Final = re.compile(r'#line (\d+) "(.*)"')
_PLACE: Final = re.compile(r"<kernel>:(\d+)")
_INCLUDE: Final = re.compile(r'\s*#\s*include\s+(?:"([^"]+)"|(\w+))')


def kernel_source(
    file: str,
    generated: Mapping[str, str] | None = None,
    defines: Mapping[str, Define] | None = None,
) -> str:
    """Return the text of ``kernels/<file>`` with its includes in place.

    Parameters
    ----------
    file : str
        Name of a file in the ``kernels`` folder.
    generated : mapping of str to str, optional
        Headers that exist as text only, by name.
    defines : mapping of str to int, float, str or Path, optional
        Becomes ``#define`` lines above the text: a bool 0 or 1, a float a ``float`` literal, a path
        the name of a header from elsewhere.

    Raises
    ------
    DeviceError
        If a file or an include does not exist; names who asked for it.
    FileError
        If a header from elsewhere cannot be read.
    """
    literals = {name: _literal(value) for name, value in (defines or {}).items()}
    heading = [f"#define {name} {literal}" for name, literal in literals.items()]
    headers = _Headers(generated or {}, literals)
    return "\n".join(heading + headers.resolve(file, "the engine")) + "\n"


def with_true_places(log: str, source: str) -> str:
    """Return a compiler's log of `source` with files and their lines for ``<kernel>:12``.

    NVIDIA's compiler knows no ``#line``: it counts the lines of the whole text.
    """
    return _PLACE.sub(lambda place: _place(source, int(place[1])), log)


def _place(source: str, number: int) -> str:
    file, line = "<defines>", 0
    for text in source.splitlines()[:number]:
        directive = _LINE.match(text)
        line = int(directive[1]) - 1 if directive else line + 1
        file = directive[2] if directive else file
    return f"{file}:{line}"


def _literal(value: Define) -> str:
    if isinstance(value, Path):
        return f'"{value.absolute().as_posix()}"'
    if isinstance(value, str):
        return value
    if isinstance(value, Integral):
        return str(int(value))
    # without its f, 0.1 is a double and drags the arithmetic around it along
    return f"{float(value)!r}f"


class _Headers:
    """The files of one kernel text, each taken in once.

    Files of ``kernels/`` go by their names in it, others by their absolute paths.
    """

    def __init__(self, generated: Mapping[str, str], defines: Mapping[str, str]) -> None:
        self._generated = generated
        self._defines = defines
        self._seen: set[str] = set()

    def resolve(self, file: str, asker: str) -> list[str]:
        """Return the lines of `file` with its includes in place; none if it is in already."""
        if file in self._seen:
            return []
        self._seen.add(file)
        lines = [f'#line 1 "{file}"']
        for number, line in enumerate(self._read(file, asker).splitlines(), start=1):
            include = _INCLUDE.match(line)
            if include is None:
                lines.append(line)
                continue
            # #include NAME takes in the file that the define NAME stands for
            name = include[1] or self._defines.get(include[2], include[2]).strip('"')
            lines += self.resolve(_beside(file, name), f"{file}:{number}")
            lines.append(f'#line {number + 1} "{file}"')
        return lines

    def _read(self, file: str, asker: str) -> str:
        if file in self._generated:
            return self._generated[file]
        if Path(file).is_absolute():
            return _read_from_elsewhere(file)
        path = KERNELS / file
        if not os.path.isfile(str(path)):  # a name may be too long
            beside = "" if not Path(asker).is_absolute() else ", nor one beside it"
            raise DeviceError(f"{asker} wants kernels/{file}: there is no such file{beside}")
        return path.read_text(encoding="utf-8")


def _beside(asker: str, name: str) -> str:
    """Return the path of what a header from elsewhere includes, where that is beside it."""
    if not Path(asker).is_absolute():
        return name
    path = Path(asker).parent / name
    return path.as_posix() if path.is_file() else name


def _read_from_elsewhere(file: str) -> str:
    try:
        return Path(file).read_text(encoding="utf-8")
    except OSError as error:
        raise FileError(f"cannot read the header {file}: {error.strerror}") from None
    except UnicodeDecodeError:
        raise FileError(f"expected a header in UTF-8, got {file}") from None
