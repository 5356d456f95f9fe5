"""The levels of detail, in one table.

The command line with its help, the viewer's menu and sliders and the comparisons are made from it:
a new level of detail is its class and a row here.
"""

from __future__ import annotations

from typing import Final

from .lod import AnyLod, Lod, PromiseLod, Weighted, unweighted
from .lod_formulas import (
    BookCoplanarityLod,
    CoplanarityLod,
    DistanceLod,
    ScreenAreaLod,
    UniformLod,
)
from .lod_promises import BudgetLod, MaxErrorLod, ScreenErrorLod

LODS: Final[dict[str, type[Lod | PromiseLod]]] = {
    "screen-error": ScreenErrorLod,
    "max-error": MaxErrorLod,
    "budget": BudgetLod,
    "coplanarity": CoplanarityLod,
    "book-coplanarity": BookCoplanarityLod,
    "distance": DistanceLod,
    "area": ScreenAreaLod,
    "uniform": UniformLod,
}
"""Every level of detail, by its name on the command line, in viewers and in comparisons."""


def name_of(lod: AnyLod) -> str:
    """Return what a level of detail is called: by its name in :data:`LODS`, or by its class."""
    kind = type(unweighted(lod))
    # a file that a row was found in is no name
    named = (name for name, each in LODS.items() if each is kind and ":" not in name)
    name = next(named, kind.__name__.removesuffix("Lod"))
    return f"weighted-{name}" if isinstance(lod, Weighted) else name
