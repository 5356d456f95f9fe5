"""A class in a file of the user's, named as ``my_lod.py:SlopeLod``."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Final

from ..errors import FileError, InputError
from ..numbered import Numbered, numbers_of, refuse_names

# options of commands, and settings of viewers
_TAKEN: Final = (
    "lod",
    "edge_rule",
    "partitioning",
    "tile",
    "levels",
    "plane",
    "device",
    "mode",
    "horizon",
    "silhouette",
)


def is_own(name: str) -> bool:
    """Return whether a name says where a class is: FILE.py:CLASS."""
    return ".py:" in name


def own_class(name: str) -> type[Numbered]:
    """Run the file that `name` says, and return its class.

    Raises
    ------
    FileError
        If there is no such file.
    InputError
        If the file cannot be run, or has no such class.
    """
    file, _, word = name.rpartition(":")
    path = Path(file)
    if not path.is_file():
        raise FileError(f"expected a Python file in {name}, got none at {path}")
    path = path.resolve()
    spec = importlib.util.spec_from_file_location(str(path), path)
    assert spec is not None  # it ends in .py
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look
    sys.path.insert(0, str(path.parent))  # what stands beside the file is imported as usual
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        raise InputError(f"cannot run {path}: {type(error).__name__}: {error}") from error
    finally:
        sys.path.remove(str(path.parent))
    kinds = {
        each: value
        for each, value in vars(module).items()
        if isinstance(value, type) and issubclass(value, Numbered)
    }
    if word not in kinds:
        known = ", ".join(each for each in kinds if kinds[each].__module__ == spec.name)
        raise InputError(
            f"expected a level of detail or a formula for edges in {path} "
            f"({known or 'it has none'}), got {word!r}"
        )
    refuse_names(numbers_of(kinds[word]), _TAKEN)
    return kinds[word]
