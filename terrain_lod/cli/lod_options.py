"""The options of levels of detail and of formulas for edges, made from their tables.

``--lod`` takes a name of the table, or a class in a file of the user's: ``my_lod.py:SlopeLod``. The
class's own numbers are then options like any others, in the help as well.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from inspect import Parameter as Argument
from inspect import Signature
from typing import Annotated, Any, ClassVar, Final, TypeVar

from cyclopts import Parameter

from ..arguments import whole
from ..curved.patch_factors import EDGE_FACTORS, EdgeFactor
from ..device.layout import FLAT_TILE, MAX_TILE
from ..errors import InputError
from ..numbered import TILE, Number, Numbered, numbers_of, summary_of
from ..terrain.lod import WEIGHTS, AnyLod, Lod, PromiseLod, Weighted
from ..terrain.lod_formulas import DistanceLod
from ..terrain.lods import LODS
from .options import DETAIL
from .own import is_own, own_class

_Kind = TypeVar("_Kind", bound=Numbered)
_LODS: Final = ("--lod", "--beside")


class FormulaOptions:
    """Which formula, and what it is made with.

    Attributes
    ----------
    lod : str or None
        Its name; None where none was given.
    given : dict of str to float
        Those numbers that were given.
    """

    extra: ClassVar[Mapping[str, Number]] = {}
    lod: str | None
    given: dict[str, float]

    @classmethod
    def tables(cls) -> Iterable[Mapping[str, type[Numbered]]]:
        """Return where names are looked up."""
        raise NotImplementedError

    @classmethod
    def kinds(cls) -> dict[str, list[type[Numbered]]]:
        """Return the classes that go by each name."""
        named: dict[str, list[type[Numbered]]] = {}
        for table in cls.tables():
            for name, kind in table.items():
                named.setdefault(name, []).append(kind)
        return named

    @classmethod
    def offer(cls) -> None:
        """Make options of what the tables hold now: cyclopts reads them off the signature."""

        def take(self: FormulaOptions, **options: Any) -> None:
            self.lod = options.pop("lod", None)
            self.given = {name: value for name, value in options.items() if value is not None}

        arguments = [Argument("self", Argument.POSITIONAL_OR_KEYWORD)]
        arguments += [_option(name, *said) for name, said in _described(cls).items()]
        take.__signature__ = Signature(arguments)  # type: ignore[attr-defined]
        cls.__init__ = take  # type: ignore[assignment, method-assign]

    def called(self, name: str, *also: str) -> dict[str, Any]:
        """Return the numbers given for the class called `name`.

        Raises
        ------
        InputError
            If a number is neither its, nor of those that `also` take some.
        """
        kinds = self.kinds()
        for each in (name, *also):
            if each not in kinds:
                known = ", ".join(kinds)
                raise InputError(
                    f"unknown level of detail {each!r}: expected one of {known}, or FILE.py:CLASS"
                )
        own = {number for kind in kinds[name] for number in numbers_of(kind)}
        others = {number for each in also for kind in kinds[each] for number in numbers_of(kind)}
        for number in self.given:
            if number not in own | others | self.extra.keys():
                takers = (
                    each
                    for each, made in kinds.items()
                    if any(number in numbers_of(kind) for kind in made)
                )
                raise InputError(
                    f"expected --lod {' or '.join(takers)} with {_flag(number)}, got {name}"
                )
        return {number: value for number, value in self.given.items() if number in own}

    def _made(
        self, table: Mapping[str, type[_Kind]], name: str, *also: str, tile: int | None = None
    ) -> _Kind:
        """Return one of a table with the numbers given, or say which is missing."""
        given, kind = self.called(name, *also), table[name]
        for number, what in numbers_of(kind).items():
            if what.required and number not in given:
                if what.start != TILE or tile is None:
                    raise InputError(f"expected {_flag(number)} with --lod {name}, got none")
                given[number] = tile
        return kind(**given)


@Parameter(name="*", group=DETAIL)
class LodOptions(FormulaOptions):
    """Which level of detail, and what it is made with."""

    extra = WEIGHTS

    @classmethod
    def tables(cls) -> Iterable[Mapping[str, type[Numbered]]]:
        return (LODS,)

    def make(self, tile: int | None, *also: str, default: str = "screen-error") -> AnyLod:
        """Return the level of detail that was asked for, in tiles of `tile` cells if that is said.

        Numbers of those that `also` take some are left to them.
        """
        name = self.lod or default
        tile = FLAT_TILE if tile is None else whole("tile", tile, 1, MAX_TILE)
        made = self._made(LODS, name, *also, tile=tile)
        if not self.given.keys() & WEIGHTS.keys():
            return made
        # a weight that was not asked for weighs nothing
        return Weighted(made, **{weight: self.given.get(weight, 1.0) for weight in WEIGHTS})

    def distance(self) -> DistanceLod:
        """Return distance LOD, with those options that it takes."""
        return self._made({"distance": DistanceLod}, "distance", *LODS)

    def beside(self, name: str, tile: int | None) -> Lod | PromiseLod:
        """Return the level of detail called `name`, with those options that it takes."""
        return self._made(LODS, name, *LODS, tile=tile or FLAT_TILE)


@Parameter(name="*", group=DETAIL)
class EdgeOptions(FormulaOptions):
    """Which formula for the segments of an edge, and what it is made with."""

    @classmethod
    def tables(cls) -> Iterable[Mapping[str, type[Numbered]]]:
        return (EDGE_FACTORS,)

    def make(self) -> EdgeFactor:
        """Return the formula that was asked for."""
        name = self.lod or "uniform"
        return self._made(EDGE_FACTORS, name)


@Parameter(name="*", group=DETAIL)
class ViewedOptions(FormulaOptions):
    """What a viewer begins with: a level of detail, or a formula for edges."""

    extra = WEIGHTS

    @classmethod
    def tables(cls) -> Iterable[Mapping[str, type[Numbered]]]:
        return LODS, EDGE_FACTORS


_OFFERED: Final[tuple[type[FormulaOptions], ...]] = (LodOptions, EdgeOptions, ViewedOptions)


@contextmanager
def own_formulas(tokens: Sequence[str]) -> Iterator[None]:
    """Within the block, the classes of files that `tokens` name stand in the tables.

    Raises
    ------
    FileError, InputError
        If there is no such file or class, or it is neither a level of detail nor for edges.
    """
    with ExitStack() as stack:
        stack.callback(_offer)
        for name in filter(is_own, _named(tokens)):
            kind = own_class(name)
            for table, base in _BASES:
                if issubclass(kind, base) and name not in table:
                    table[name] = kind
                    stack.callback(table.pop, name)
        _offer()
        yield


_BASES: Final[tuple[tuple[dict[str, Any], Any], ...]] = (
    (LODS, Lod | PromiseLod),
    (EDGE_FACTORS, EdgeFactor),
)


def _offer() -> None:
    for options in _OFFERED:
        options.offer()


def _named(tokens: Sequence[str]) -> Iterator[str]:
    """Yield what options and the environment name."""
    for token in tokens:
        yield os.environ.get(f"TERRAIN_LOD_{token.upper()}_LOD", "")
    for token, after in zip(tokens, (*tokens[1:], ""), strict=True):
        option, _, value = token.partition("=")
        if option in _LODS:
            yield value or after


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")


def _described(options: type[FormulaOptions]) -> dict[str, tuple[type, str]]:
    """Return the type and the help of every option, by name."""
    kinds = options.kinds()
    lines = [f"{name}: {' / '.join(map(summary_of, made))}." for name, made in kinds.items()]
    own = "Or FILE.py:CLASS, a class of your own: see docs/own_lod.md."
    found: dict[str, tuple[type, str]] = {"lod": (str, " ".join([*lines, own]))}
    numbers: dict[str, dict[str, list[str]]] = {}
    for name, made in kinds.items():
        for kind in made:
            for number, what in numbers_of(kind).items():
                found[number] = (int if what.step == 1 else float, "")
                takers = numbers.setdefault(number, {}).setdefault(_said(what), [])
                takers += [name] * (name not in takers)
    for number, said in numbers.items():
        text = " ".join(f"Of {', '.join(takers)}: {each}." for each, takers in said.items())
        found[number] = (found[number][0], text)
    for number, what in options.extra.items():
        found[number] = (float, f"{what.help[:1].upper()}{what.help[1:]}.")
    return found


def _said(what: Number) -> str:
    words = what.help or "a number"
    unit = f", {what.unit}" if what.unit not in ("", "m") and what.unit not in words else ""
    default = f"; default {what.default:g}" if what.default else ""
    return f"{words}{unit}{default}"


def _option(name: str, kind: type, text: str) -> Argument:
    told = Parameter(help=text, metavar="NAME" if kind is str else None)
    annotation = Annotated[kind | None, told]  # type: ignore[valid-type]
    return Argument(name, Argument.KEYWORD_ONLY, default=None, annotation=annotation)


_offer()
