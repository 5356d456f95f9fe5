"""Formulas of parametric curves and surfaces: the header, and the numbers that shape it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, TypeVar

from ..arguments import instance, one_of, text
from ..numbered import Number, checked_numbers, refuse_names

_Kind = TypeVar("_Kind", bound="Parametric")


@dataclass(frozen=True)
class Parametric:
    """A formula, and what the host must know of it.

    Attributes
    ----------
    header : str or pathlib.Path
        What defines it: a file of ``kernels/``, or the path of any other.
    numbers : dict of str to Number
        What shapes it: the header reads a number ``radius`` as ``shape[RADIUS]``.
    """

    header: str | Path
    numbers: Mapping[str, Number]
    taken: ClassVar[tuple[str, ...]] = ()  # names of arguments

    def __post_init__(self) -> None:
        if not isinstance(self.header, Path):
            header = instance("a header's name or path", self.header, str)
            object.__setattr__(self, "header", str(header))
        for name, number in instance("a dict of Number for numbers", self.numbers, Mapping).items():
            instance(f"a Number for {text('a name of numbers', name)}", number, Number)
        refuse_names(self.numbers, self.taken)


def shape_numbers(kind: Parametric, given: Mapping[str, object]) -> dict[str, float]:
    """Return all numbers of a formula by name, defaults where they are not given."""
    return checked_numbers(Path(kind.header).stem, kind.numbers, given)


def named(word: str, shape: object, table: Mapping[str, _Kind], kind: type[_Kind]) -> _Kind:
    """Return a formula by its name in a table, or one of the caller's own."""
    if isinstance(shape, str):
        return table[one_of(word, shape, table)]
    return instance(f"a {word}'s name or a {kind.__name__}", shape, kind)
