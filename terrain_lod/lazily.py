"""Public names of a package, each imported when it is first asked for.

A name that is not used costs nothing: importing the package takes milliseconds, and a program
imports the rooms that it works with. The names, and the modules they come from, are written once,
as the imports of the package's stub (``__init__.pyi``), which is what type checkers and editors
read as well.

After PEP 562, and Scientific Python's SPEC 1, lazy loading of submodules and functions.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path


def lazily(
    package: str, file: str
) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package with a stub.

    Parameters
    ----------
    package, file : str
        Its ``__name__`` and its ``__file__``.
    """
    statements = ast.parse(Path(file).with_suffix(".pyi").read_text(encoding="utf-8")).body
    homes = _homes(statements)

    def get(name: str) -> object:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module, own_name = homes[name]
        home = import_module(f".{module}" if module else f".{own_name}", package)
        value: object = getattr(home, own_name) if module else home
        setattr(sys.modules[package], name, value)
        return value

    return get, lambda: sorted(homes), _starred(statements)


def _homes(statements: list[ast.stmt]) -> dict[str, tuple[str, str]]:
    """Return the module that each name is imported from, and its name there."""
    return {
        alias.asname or alias.name: (statement.module or "", alias.name)
        for statement in statements
        if isinstance(statement, ast.ImportFrom)
        for alias in statement.names
    }


def _starred(statements: list[ast.stmt]) -> list[str]:
    """Return the names that a star imports."""
    (names,) = (
        ast.literal_eval(statement.value)
        for statement in statements
        if isinstance(statement, ast.Assign)
    )
    return list(names)
