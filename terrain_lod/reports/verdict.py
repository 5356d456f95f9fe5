"""What the numbers of a comparison say, in words, whichever way they fall."""

from __future__ import annotations

from .comparison import Comparison
from .pictures import VISIBLE_DIFFERENCE, Difference


def verdict(comparison: Comparison, difference: Difference | None) -> list[str]:
    """Return the findings as sentences; times are left out, so they are the same every time."""
    if not comparison.distance.triangles or not comparison.other.triangles:
        return ["Nothing of the ground is in view from this camera: there is nothing to compare."]
    sentences = [_at_defaults(comparison), _at_equal_triangles(comparison)]
    if difference is not None:
        sentences.append(
            f"The two shaded pictures differ by {small_share(difference.mean)} on average; "
            f"{small_share(difference.visible_share)} of the pixels differ by more than "
            f"{VISIBLE_DIFFERENCE:.0%}, the most by {difference.largest:.0%}; "
            f"their structural similarity is {difference.similarity:.3f}."
        )
    return sentences


def small_share(share: float) -> str:
    """Return a share as percent that is 0 only where it is none."""
    return "less than 0.01%" if 0 < share < 1e-4 else f"{share:.2%}"


def _at_defaults(comparison: Comparison) -> str:
    ours, theirs = comparison.other, comparison.distance
    saved = 1 - ours.triangles / theirs.triangles
    counts = f"{ours.triangles:,} against {theirs.triangles:,}"
    if ours.triangles == theirs.triangles:
        draws = f"{ours.title} draws exactly as many triangles as distance LOD ({counts})"
    else:
        share = f"{abs(saved):.1%} {'fewer' if saved > 0 else 'more'}"
        draws = f"{ours.title} draws {share} triangles than distance LOD ({counts})"
    unit = comparison.terrain.ground.unit_symbols[1]
    return (
        f"{draws}; its RMS vertical error is {ours.error.rms:.4g} {unit} against "
        f"{theirs.error.rms:.4g} {unit}, its largest {ours.error.maximum:.4g} {unit} against "
        f"{theirs.error.maximum:.4g} {unit}."
    )


def _at_equal_triangles(comparison: Comparison) -> str:
    ours, theirs = comparison.other, comparison.equal
    if not comparison.is_equal:
        return (
            f"Distance LOD could not be made to draw as many: {theirs.triangles:,} triangles were "
            f"nearest to {ours.triangles:,}, so errors are not compared at equal counts."
        )
    opening = f"With as many triangles ({theirs.triangles:,} and {ours.triangles:,}),"
    unit = comparison.terrain.ground.unit_symbols[1]
    numbers = (
        f"{ours.error.rms:.4g} {unit} RMS against {theirs.error.rms:.4g} {unit}, at the most "
        f"{ours.error.maximum:.4g} {unit} against {theirs.error.maximum:.4g} {unit}"
    )
    if ours.error.rms == theirs.error.rms:
        return f"{opening} both are equally far from the ground: {numbers}."
    if ours.error.rms < theirs.error.rms:
        gain = 1 - ours.error.rms / theirs.error.rms
        return f"{opening} {ours.name} LOD is {gain:.1%} closer to the ground: {numbers}."
    # distance alone may have no error at all
    loss = f"{ours.error.rms / theirs.error.rms - 1:.1%} " if theirs.error.rms else ""
    return (
        f"{opening} {ours.name} LOD is {loss}farther from the ground: {numbers}. "
        "At this camera distance alone places triangles better."
    )
