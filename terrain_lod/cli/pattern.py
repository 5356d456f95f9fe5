"""``terrain-lod pattern``: pictures of what the tessellator makes of factors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Final, Literal

import numpy as np
import numpy.typing as npt

from ..arguments import one_of, whole
from ..errors import InputError
from ..paths import require_folder
from ..tessellation.factors import DOMAINS
from ..tessellation.pattern import Pattern
from .options import AnyPartitioning, Output, numbers
from .output import progress_bar, say

_Factors = Annotated[tuple[float, ...] | None, numbers("FACTOR[,FACTOR...]", 1, 2, 3, 4)]
_Sweep = Annotated[tuple[float, float] | None, numbers("LOW,HIGH", 2)]

_SEMI_UNIFORM: Final = "semi_uniform"
_ANIMATION: Final = ".gif"


def pattern(
    *,
    output: Output,
    domain: Literal["quad", "triangle", "isoline"] = "quad",
    partitioning: AnyPartitioning = "fractional_odd",
    edge_factors: _Factors = None,
    inside_factors: _Factors = None,
    sweep: _Sweep = None,
    frames: int = 36,
) -> None:
    """Draw a tessellation pattern with its rings and control points, or animate a range of factors.

    Parameters
    ----------
    output
        .svg, .png or .pdf; with --sweep .gif
    domain
        quad: four edges and two factors inside. triangle: three and one. isoline: lines, segments.
    partitioning
        How factors divide edges. semi_uniform: triangles or quads by whole levels of powers of two.
    edge_factors
        Of u = 0, v = 0, u = 1, v = 1, of u = 0, v = 0, w = 0, or lines and segments; one
        for all. Default: 5.
    inside_factors
        Along u and v, or of the triangle's inside; one for all. Default: the mean of the
        edges'.
    sweep
        Animate: all factors from the first to the second and back.
    frames
        Of the animation, one way.
    """
    from ..drawing.pattern_pictures import PICTURES, save_animation, save_pattern

    ending = output.suffix.lower()
    semi_uniform = partitioning == _SEMI_UNIFORM
    if semi_uniform and domain == "isoline":
        raise InputError("expected --domain triangle or quad with semi_uniform, got isoline")
    require_folder(output)
    edge_count, inside_count, _ = DOMAINS[domain]
    if semi_uniform:
        inside_count = 0
    if inside_factors is not None and inside_count == 0:
        raise InputError(f"expected no --inside-factors for {domain}, {partitioning}: leave it out")
    if sweep is None:
        if ending == _ANIMATION:
            raise InputError("expected --sweep LOW,HIGH with a .gif, got none")
        one_of("picture format", ending, PICTURES)
        outer = _row("--edge-factors", domain, edge_factors or (5.0,), edge_count)
        inner = _row(
            "--inside-factors", domain, inside_factors or (float(np.mean(outer)),), inside_count
        )
        made = _tessellated(domain, partitioning, outer, inner)
        save_pattern(made, output, edge_factors=outer, inside_factors=inner)
    else:
        one_of("animation format", ending, (_ANIMATION,))
        if edge_factors is not None or inside_factors is not None:
            raise InputError(
                "expected --sweep, or --edge-factors and --inside-factors, got both: leave one out"
            )
        steps = np.linspace(*sweep, whole("--frames", frames, 2, 1000))[:, None]
        outer, inner = (np.tile(steps, (1, count)) for count in (edge_count, inside_count))
        made = _tessellated(domain, partitioning, outer, inner)
        with progress_bar("drawing") as progress:
            save_animation(
                made, output, edge_factors=outer, inside_factors=inner, progress=progress
            )
    say(f"{output}: {made!r}")


def _row(option: str, domain: str, given: Sequence[float], count: int) -> npt.NDArray[np.float64]:
    """Return the factors of one patch, (1, count); one number stands for all."""
    if len(given) not in (1, count):
        raise InputError(f"expected 1 or {count} numbers for {option} of a {domain}, got {given}")
    row: npt.NDArray[np.float64] = np.broadcast_to(np.array(given), (1, count))
    return row


def _tessellated(
    domain: str,
    partitioning: str,
    edges: npt.NDArray[np.float64],
    insides: npt.NDArray[np.float64],
) -> Pattern:
    """Return the pattern of all patches, in one launch."""
    from ..tessellation.semi_uniform import LARGEST_LEVEL, semi_uniform
    from ..tessellation.tessellator import tessellate

    if partitioning == _SEMI_UNIFORM:
        return semi_uniform(edges, maximum=LARGEST_LEVEL)
    inside_factors = insides if DOMAINS[domain].insides else None
    return tessellate(domain, edges, inside_factors, partitioning=partitioning)
