"""Pieces of an HTML page: sections, tables, figures with the picture inside."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Final

from PIL import Image

from .tables import Row, Value

# pictures in a page are at most this wide, as JPEG: a page of a few megabytes, which mail takes
_WIDTH: Final = 1920
_QUALITY: Final = 88


def section(title: str, *content: str) -> str:
    """Return a section of HTML `content` under an escaped title."""
    return "\n".join([f"<section>\n<h2>{escape(title)}</h2>", *content, "</section>"])


def paragraph(text: str, *, kind: str = "") -> str:
    """Return escaped text as a paragraph."""
    return f'<p class="{kind}">{escape(text)}</p>' if kind else f"<p>{escape(text)}</p>"


def card(number: str, text: str) -> str:
    """Return one number to see first, and what it is."""
    return f'<div class="card"><b>{escape(number)}</b><span>{escape(text)}</span></div>'


def row_of_figures(kind: str, figures: Iterable[str]) -> str:
    """Return figures side by side; `kind` is ``"two"`` or ``"three"``."""
    return "\n".join([f'<div class="{kind}">', *figures, "</div>"])


def figure(path: Path, caption: str) -> str:
    """Return a picture file, embedded, over its caption; a click shows it as large as fits."""
    if path.suffix == ".svg":
        kind, data = "image/svg+xml", path.read_bytes()
    else:
        kind, data = "image/jpeg", _jpeg(path)
    source = f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"
    text = escape(caption)
    look = ' class="plot"' if path.suffix == ".svg" else ""
    image = f'<img src="{source}" alt="{text}">'
    return (
        f'<figure{look}><button type="button" class="enlarge">{image}</button>'
        f"<figcaption>{text}</figcaption></figure>"
    )


def bars(title: str, values: Sequence[tuple[str, float, str]]) -> str:
    """Return a bar for each label, value and text; the shortest bar, the best, is set apart."""
    longest = max((value for _, value, _ in values), default=0.0) or 1.0
    best = min((value for _, value, _ in values), default=0.0)
    lines = [
        f'<div class="bar{" best" if value == best else ""}"><span>{escape(label)}</span>'
        f'<i><u style="width:{100 * value / longest:.1f}%"></u></i><b>{escape(text)}</b></div>'
        for label, value, text in values
    ]
    return "\n".join([f'<div class="card bars"><h2>{escape(title)}</h2>', *lines, "</div>"])


def _jpeg(path: Path) -> bytes:
    with Image.open(path) as picture:
        width, height = picture.size
        scale = min(1.0, _WIDTH / width)
        size = max(1, round(width * scale)), max(1, round(height * scale))
        stream = io.BytesIO()
        picture.resize(size, Image.Resampling.LANCZOS).save(
            stream, format="jpeg", quality=_QUALITY, subsampling=0
        )
    return stream.getvalue()


def table(title: str, columns: Sequence[str], rows: Iterable[Row]) -> str:
    """Return rows of quantities under the names of their trials, units at the end."""
    heads = "".join(f'<th class="n" scope="col">{escape(name)}</th>' for name in columns)
    lines = [
        _scroll(title),
        "<table>",
        f'<thead><tr><th scope="col">{escape(title)}</th>{heads}<th scope="col">Unit</th></tr>',
        "</thead><tbody>",
    ]
    for row in rows:
        unit = "ms" if row.unit == "s" else row.unit
        values = "".join(f'<td class="n">{formatted(value, row.unit)}</td>' for value in row.values)
        label = f'<th scope="row">{escape(row.label)}</th>'
        lines.append(f'<tr>{label}{values}<td class="u">{unit}</td></tr>')
    return "\n".join([*lines, "</tbody></table></div>"])


def _scroll(title: str) -> str:
    """Return the start of what a narrow screen moves sideways."""
    return f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(title)}">'


class Strong(str):
    """A text of a listing that is set in bold."""


Lines = Iterable[Sequence[str]]


def listing(
    title: str,
    heads: Sequence[str],
    lines: Lines | Mapping[str, Lines],
    *,
    words: int = 1,
    look: str = "",
) -> str:
    """Return lines of texts under their heads; all but the first `words` columns are numbers.

    Lines may come in groups, each under its title. A click on a head sorts the lines of every
    group. With `look` "matrix" heads stand upright, so that many columns fit.
    """
    groups = lines if isinstance(lines, Mapping) else {"": lines}

    def cell(tag: str, number: int, text: str, more: str = "") -> str:
        look = "" if number < words else ' class="n"'
        return f"<{tag}{look}{more}>{_set(text)}</{tag}>"

    def row(texts: Sequence[str]) -> str:
        first, *rest = texts
        head = cell("th", 0, first, ' scope="row"')
        cells = (cell("td", number, text) for number, text in enumerate(rest, start=1))
        return f"<tr>{head}{''.join(cells)}</tr>"

    def group(name: str, texts: Lines) -> str:
        across = f'<th scope="rowgroup" colspan="{len(heads)}">{escape(name)}</th>'
        first = f'<tr class="group">{across}</tr>' if name else ""
        return f"<tbody>{first}{''.join(map(row, texts))}</tbody>"

    head = "".join(cell("th", number, text, ' scope="col"') for number, text in enumerate(heads))
    return "\n".join(
        [
            _scroll(title),
            f'<table class="list sorts {look}">',
            f"<thead><tr>{head}</tr></thead>",
            *(group(name, texts) for name, texts in groups.items()),
            "</table></div>",
        ]
    )


def _set(text: str) -> str:
    return f"<b>{escape(text)}</b>" if isinstance(text, Strong) else escape(text)


def definitions(pairs: Iterable[tuple[str, str]]) -> str:
    """Return names and what they stand for."""
    lines = [f"<dt>{escape(name)}</dt><dd>{escape(text)}</dd>" for name, text in pairs]
    return "\n".join(["<dl>", *lines, "</dl>"])


def formatted(value: Value, unit: str) -> str:
    """Return a number as people read it; seconds become milliseconds."""
    if value is None:
        return "–"
    if isinstance(value, int):
        return f"{value:,}"
    if unit == "%":
        return f"{value:.1f}"
    return f"{1e3 * value:#.3g}" if unit == "s" else f"{value:#.4g}".rstrip(".")
