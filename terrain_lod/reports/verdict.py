"""What the numbers of a comparison say, in words, whichever way they fall."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from typing import Final

from ..numbered import summary_of
from ..terrain.lod import unweighted
from ..terrain.lod_formulas import CoplanarityLod, DistanceLod
from ..terrain.lod_promises import ScreenErrorLod
from .comparison import EQUAL_SHARE, Comparison, Trial

# times of meshes with as many triangles that differ by more are explained
_EXPLAINED: Final = 0.25


def verdict(comparison: Comparison) -> list[str]:
    """Return the findings as sentences; times are left out, so they are the same every time."""
    if not comparison.distance.triangles or not comparison.other.triangles:
        return ["Nothing of the ground is in view from this camera: there is nothing to compare."]
    return [
        at_equal_triangles(comparison),
        at_equal_error(comparison),
        _advice(comparison),
        as_asked_for(comparison),
    ]


def at_equal_triangles(comparison: Comparison) -> str:
    """Return how far off each is with as many triangles; the best first."""
    trials = comparison.equal_triangles
    alike = [trial for trial in trials if comparison.draws_as_many(trial)]
    unlike = [trial for trial in trials if trial not in alike]
    sentence = ""
    if len(alike) > 1:
        best, *others = sorted(alike, key=lambda trial: trial.seen.maximum)
        each = ", ".join(f"{other.called} {pixels(other)}" for other in others)
        fewer = [
            trial
            for trial in alike
            if trial.triangles < (1 - EQUAL_SHARE) * comparison.other.triangles
        ]
        sentence = (
            f"Same triangles: with about {comparison.other.triangles:,} triangles, {best.called} "
            f"is at most {pixels(best)} off in the picture, {each}."
        )
        for trial in fewer:
            sentence += f" {trial.title} needs no more than {trial.triangles:,} for it."
    for trial in unlike:
        sentence += (
            f" {trial.title} could not be made to draw as many: {trial.triangles:,} triangles "
            f"were nearest to {comparison.other.triangles:,}."
        )
    return sentence.strip()


def at_equal_error(comparison: Comparison) -> str:
    """Return how many triangles each needs for the same error; the fewest first."""
    trials = comparison.equal_error
    if not trials:
        return (
            f"{comparison.other.title} shows no error in this picture, so there is none to compare "
            "the others at."
        )
    alike = [trial for trial in trials if comparison.is_as_far_off(trial)]
    unlike = [trial for trial in trials if trial not in alike]
    sentence = ""
    if len(alike) > 1:
        best, *others = sorted(alike, key=lambda trial: trial.triangles)
        each = ", ".join(
            f"{other.called} {other.triangles:,} ({_times(other, best)})" for other in others
        )
        sentence = (
            f"Same error: to be at most {pixels(comparison.other)} off, {best.called} draws "
            f"{best.triangles:,} triangles, {each}."
        )
    for trial in unlike:
        sentence += (
            f" {trial.title} could not be made as far off as {pixels(comparison.other)}: "
            f"{pixels(trial)} was nearest, with {trial.triangles:,} triangles."
        )
    return sentence.strip()


def _advice(comparison: Comparison) -> str:
    alike = [trial for trial in comparison.equal_triangles if comparison.draws_as_many(trial)]
    same = [trial for trial in comparison.equal_error if comparison.is_as_far_off(trial)]
    if len(alike) < 2 or len(same) < 2:
        return "There is too little to tell the levels of detail apart here."
    nearest = min(alike, key=lambda trial: trial.seen.maximum).called
    cheapest = min(same, key=lambda trial: trial.triangles)
    fewest = cheapest.called
    said = f"So here {nearest} is nearer to the ground, and {fewest} draws fewer triangles."
    if nearest == fewest:
        said = f"So here {nearest} is the better choice, whichever of the two you have to hold."
    # fewer triangles that keep the largest error are farther off elsewhere
    least = min(same, key=lambda trial: trial.seen.rms)
    if least is not cheapest:
        said += (
            f" That is by the largest error: at the same one, {fewest} is {cheapest.seen.rms:.3g} "
            f"px off in the mean (RMS), {least.called} {least.seen.rms:.3g} px."
        )
    return said


def as_asked_for(comparison: Comparison) -> str:
    """Return what the other and distance LOD come to at their parameters."""
    ours, theirs = comparison.other, comparison.distance
    saved = 1 - ours.triangles / theirs.triangles
    counts = f"{ours.triangles:,} against {theirs.triangles:,}"
    if ours.triangles == theirs.triangles:
        draws = f"{ours.called} draws exactly as many triangles as distance LOD ({counts})"
    else:
        share = f"{abs(saved):.1%} {'fewer' if saved > 0 else 'more'}"
        draws = f"{ours.called} draws {share} triangles than distance LOD ({counts})"
    unit = comparison.terrain.ground.unit_symbols[1]
    return (
        f"As asked for, {draws}; its RMS vertical error is {ours.error.rms:.4g} {unit} against "
        f"{theirs.error.rms:.4g} {unit}, its largest {ours.error.maximum:.4g} {unit} against "
        f"{theirs.error.maximum:.4g} {unit}."
    )


def purpose(trial: Trial) -> str:
    """Return what a level of detail is for, with what it did here."""
    lod, drawn = unweighted(trial.lod), _drawn_factors(trial)
    if isinstance(lod, DistanceLod):
        return (
            "For ground of which nothing is known: near patches get more triangles than far ones, "
            "smooth or rough. Here a patch near the camera was cut into up to "
            f"{max(drawn, default=0):.3g} segments a side, the farthest into "
            f"{min(drawn, default=0):.3g}."
        )
    if isinstance(lod, CoplanarityLod):
        return (
            "For ground that is rough in places: patches that are near and not flat get more. "
            f"Here bumps that look {lod.pixels:g} pixels high get all the detail there is, and "
            f"half of the patches drawn make do with {median(drawn or [0]):.3g} segments a side."
        )
    if isinstance(lod, ScreenErrorLod):
        return (
            "For saying how wrong the picture may be: it finds the fewest triangles that keep it, "
            f"and measures. Here {lod.pixels:g} px were asked for, {trial.triangles:,} triangles "
            f"keep it, and {pixels(trial)} is the most that was measured."
        )
    words = summary_of(type(lod))
    return (
        f"{words[:1].upper()}{words[1:]}. Here it draws {trial.triangles:,} triangles and is at "
        f"most {pixels(trial)} off in the picture."
    )


def why_times_differ(trials: Sequence[Trial]) -> list[str]:
    """Return, of trials with as many triangles, why one takes longer than the fastest."""
    if not trials:
        return []
    fastest = min(trials, key=lambda trial: median(trial.totals))
    sentences = []
    for trial in trials:
        more = median(trial.totals) / median(fastest.totals) - 1
        if trial is fastest or more <= _EXPLAINED:
            continue
        if trial.totals[0] <= fastest.totals[-1]:
            why = "the runs overlap, so this machine cannot tell the two apart"
        else:
            more_seconds, stage = max(
                (seconds - fastest.seconds.get(stage, 0.0), stage)
                for stage, seconds in trial.seconds.items()
            )
            why = f"most of it is the stage “{stage}”, {1e3 * more_seconds:.3g} ms more"
        sentences.append(
            f"With as many triangles, {trial.called} takes {more:.0%} longer than "
            f"{fastest.called}: {why}."
        )
    return sentences


def pixels(trial: Trial) -> str:
    """Return the largest error in the picture."""
    value = trial.seen.maximum
    return "no px (nothing in view)" if value != value else f"{value:.3g} px"


def small_share(share: float) -> str:
    """Return a share as percent that is 0 only where it is none."""
    return "less than 0.01%" if 0 < share < 1e-4 else f"{share:.2%}"


def _times(trial: Trial, best: Trial) -> str:
    return f"{trial.triangles / max(best.triangles, 1):.3g} times as many"


def _drawn_factors(trial: Trial) -> list[float]:
    patches = trial.mesh.patches
    if patches is None or not patches.drawn.any():
        return []
    factors: list[float] = patches.inside_factors[patches.drawn].mean(axis=1).tolist()
    return factors
