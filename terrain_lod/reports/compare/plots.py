"""Pareto plots of a comparison: triangles against error, time against error."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from ...paths import replacing
from ..maps import STYLE
from .trials import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Pair = Callable[[Result], tuple[float, float]]

# ours are discs and lines, peers open marks and dashes; colours tell apart in print too
_LOOKS: Final[dict[str, tuple[str, str]]] = {
    "UniformLod": ("#9aa1ad", "o"),
    "DistanceLod": ("#56b4e9", "o"),
    "CoplanarityLod": ("#009e73", "o"),
    "BookCoplanarityLod": ("#7fcfb9", "o"),
    "ScreenAreaLod": ("#8ab66f", "o"),
    "MaxErrorLod": ("#0b3d91", "o"),
    "ScreenErrorLod": ("#d55e00", "o"),
    "BudgetLod": ("#e69f00", "o"),
    "Weighted": ("#b2182b", "o"),
    "uniform grid": ("#9aa1ad", "s"),
    "pydelatin": ("#000000", "^"),
    "pymartini": ("#cc79a7", "v"),
    "VTK greedy": ("#8c564b", "D"),
    "pyvista decimate": ("#6a3d9a", "P"),
}
_OWN: Final = ("#17becf", "#bcbd22", "#e377c2", "#7f7f7f")  # of classes from elsewhere, in turn


def save_plots(results: Sequence[Result], folder: Path) -> dict[str, Path]:
    """Write ``triangles.svg`` and ``time.svg``: error in metres at the left, in pixels right.

    The edge rule of each level of detail is its default, and every view-dependent one counts the
    triangles of one view.
    """
    return {
        "triangles": _save(
            folder / "triangles.svg", results, "triangles", lambda result: result.triangles
        ),
        "time": _save(
            folder / "time.svg",
            results,
            "seconds from raster to mesh",
            lambda result: result.times.whole,
        ),
    }


def _save(
    path: Path, results: Sequence[Result], label: str, cost: Callable[[Result], float]
) -> Path:
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with mpl.rc_context({**STYLE, "axes.facecolor": "white"}):
        figure = Figure(figsize=(11.0, 4.8), layout="constrained")
        FigureCanvasSVG(figure)
        left, right = figure.subplots(1, 2)
        unit = results[0].contender.symbol if results else "m"
        _draw(left, results, lambda result: (cost(result), result.metres))
        _draw(right, results, lambda result: (cost(result), result.pixels))
        left.set(xlabel=label, ylabel=f"largest vertical error ({unit})", title="In the world")
        right.set(xlabel=label, ylabel="largest error (pixels)", title="In the picture")
        figure.legend(*left.get_legend_handles_labels(), loc="outside right upper", frameon=False)
        with replacing(path) as temporary:
            figure.savefig(temporary, format="svg", metadata={"Date": None, "Creator": None})
    return path


def _draw(ax: Axes, results: Sequence[Result], pair: Pair) -> None:
    """Draw a line a family, on scales of powers; what is exact has no place on them."""
    own = dict.fromkeys(result.contender.family for result in results).keys() - _LOOKS.keys()
    looks = _LOOKS | dict(zip(sorted(own), ((each, "o") for each in cycle(_OWN)), strict=False))
    for family, (colour, mark) in looks.items():
        points = [pair(result) for result in results if _is_drawn(result, family)]
        points = sorted((pair for pair in points if pair[1] > 0), key=lambda pair: pair[1])
        if not points:
            continue
        is_peer = mark != "o"
        look: dict[str, Any] = {"markerfacecolor": "white"} if is_peer else {}
        ax.plot(
            *zip(*points, strict=True),
            *(mark + ("--" if is_peer else "-"),),
            color=colour,
            label=next(r.contender.name for r in results if r.contender.family == family),
            linewidth=1.2,
            markersize=5,
            **look,
        )
    ax.set(xscale="log", yscale="log")
    ax.grid(color="0.9", linewidth=0.6)


def _is_drawn(result: Result, family: str) -> bool:
    contender = result.contender
    return contender.family == family and contender.edge_rule in ("", "min")
