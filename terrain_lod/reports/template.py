"""The page that every report fills: one file to mail, nothing loaded from elsewhere."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from importlib.metadata import version
from importlib.resources import files
from string import Template

from ..drawing.colours import LOD_STOPS
from .html import paragraph


def filled_page(
    *,
    title: str,
    subtitle: str,
    verdict: Iterable[str],
    cards: Iterable[str],
    sections: Iterable[str],
    numbers: str,
) -> str:
    """Return the text of a page.

    Parameters
    ----------
    title, subtitle : str
    verdict : iterable of str
        Sentences.
    cards, sections : iterable of str
        HTML of :mod:`~terrain_lod.reports.html`.
    numbers : str
        Names of the files that hold the same numbers.
    """
    number = version("terrain_lod")
    template = Template(files("terrain_lod.reports").joinpath("report.html").read_text("utf-8"))
    return template.substitute(
        version=escape(number),
        title=escape(title),
        subtitle=escape(subtitle),
        verdict="\n".join(map(paragraph, verdict)),
        cards="\n".join(cards),
        sections="\n".join(sections),
        footer=escape(f"Made by terrain_lod {number}. The same numbers: {numbers}."),
        ramp=css_ramp(),
    )


def css_ramp() -> str:
    """Return the colours of levels of detail as CSS has them."""
    return ", ".join(
        f"rgb({', '.join(str(round(255 * channel)) for channel in colour)}) {position:.0%}"
        for position, *colour in LOD_STOPS
    )
