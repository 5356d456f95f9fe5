"""Pieces of an HTML page: sections, tables, figures with the picture inside."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Final

from PIL import Image

from .tables import Row, Value

# pictures in a page are at most this wide, as JPEG: a page of a few megabytes, which mail takes
_WIDTH: Final = 1280
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
    """Return a picture file, embedded, over its caption."""
    if path.suffix == ".svg":
        kind, data = "image/svg+xml", path.read_bytes()
    else:
        kind, data = "image/jpeg", _jpeg(path)
    source = f"data:{kind};base64,{base64.b64encode(data).decode('ascii')}"
    text = escape(caption)
    look = ' class="plot"' if path.suffix == ".svg" else ""
    image = f'<img src="{source}" alt="{text}">'
    return f"<figure{look}>{image}<figcaption>{text}</figcaption></figure>"


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


def table(columns: Sequence[str], rows: Iterable[Row]) -> str:
    """Return rows of quantities under the names of their trials, units at the end."""
    heads = "".join(f'<th class="n" scope="col">{escape(name)}</th>' for name in columns)
    lines = [
        '<div class="scroll"><table>',
        f'<thead><tr><th scope="col"></th>{heads}<th scope="col"></th></tr></thead>',
        "<tbody>",
    ]
    for row in rows:
        unit = "ms" if row.unit == "s" else row.unit
        values = "".join(f'<td class="n">{formatted(value, row.unit)}</td>' for value in row.values)
        lines.append(f'<tr><td>{escape(row.label)}</td>{values}<td class="u">{unit}</td></tr>')
    return "\n".join([*lines, "</tbody></table></div>"])


class Strong(str):
    """A text of a listing that is set in bold."""


def listing(heads: Sequence[str], lines: Iterable[Sequence[str]], *, words: int = 1) -> str:
    """Return lines of texts under their heads; all but the first `words` columns are numbers."""

    def cells(tag: str, texts: Sequence[str], more: str = "") -> str:
        looks = [""] * words + [' class="n"'] * (len(texts) - words)
        return "".join(
            f"<{tag}{look}{more}>{_set(text)}</{tag}>"
            for look, text in zip(looks, texts, strict=True)
        )

    head = cells("th", heads, ' scope="col"')
    rows = (f"<tr>{cells('td', line)}</tr>" for line in lines)
    return "\n".join(
        [
            '<div class="scroll"><table class="list">',
            f"<thead><tr>{head}</tr></thead>",
            *("<tbody>", *rows, "</tbody></table></div>"),
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
