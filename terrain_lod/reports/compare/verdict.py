"""What the numbers of a sweep say, in words, whichever way they fall."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from .trials import Result


def findings(
    sweep: Sequence[Result], tiles: Sequence[Result], partitionings: Sequence[Result]
) -> list[str]:
    """Return sentences that hold for every run with the same seed; times are in `speeds`."""
    return [
        *_promises(sweep),
        *_counts(sweep),
        *_in_view(sweep),
        *_tile_sizes(tiles),
        *_pops(partitionings),
    ]


def speeds(sweep: Sequence[Result]) -> list[str]:
    """Return sentences about time, which differ from run to run."""
    sentences = []
    pairs = list(_same_tolerance(sweep, "pydelatin"))
    if pairs:
        each = "; ".join(
            f"{_number(ours.contender.parameter)} {ours.contender.symbol}: "
            f"{_milliseconds(ours.times.whole)} against {_milliseconds(theirs.times.whole)}, "
            f"{_times_as(theirs.times.whole / ours.times.whole, 'as fast', 'as slow')}"
            for ours, theirs in pairs
        )
        sentences.append(f"From raster to mesh, max-error LOD against pydelatin: {each}.")
    seen = _find(sweep, "ScreenErrorLod", 1.0)
    if seen is not None and seen.times.view:
        sentences.append(
            f"One more view within a pixel takes {_milliseconds(seen.times.view)}: "
            f"{1 / seen.times.view:.3g} a second, mesh in host memory."
        )
    return sentences


def _promises(sweep: Sequence[Result]) -> Iterator[str]:
    asked = [r for r in sweep if r.contender.asked_metres or r.contender.asked_pixels]
    names = dict.fromkeys(result.contender.name for result in asked)
    kept = [name for name in names if not any(r.broken for r in _called(asked, name))]
    if kept:
        yield f"Error asked for is error measured, in every case tried: {', '.join(kept)}."
    for name in names:
        broken = [r for r in _called(asked, name) if r.broken]
        if broken:
            worst = max(broken, key=lambda result: result.broken or 0.0)
            measured = worst.metres if worst.contender.asked_metres else worst.pixels
            yield (
                f"{name} broke its own target in {len(broken)} of {len(_called(asked, name))} "
                f"cases: asked for {worst.contender.setting}, it is off by {measured:.4g}, "
                f"{worst.broken:.3g} times that."
            )


def _counts(sweep: Sequence[Result]) -> Iterator[str]:
    pairs = list(_same_tolerance(sweep, "pydelatin"))
    if not pairs:
        return
    each = "; ".join(
        f"{_number(ours.contender.parameter)} {ours.contender.symbol}: {ours.triangles:,} against "
        f"{theirs.triangles:,}, {ours.triangles / theirs.triangles:.3g} times"
        for ours, theirs in pairs
    )
    yield f"Triangles within an error everywhere, max-error LOD against pydelatin: {each}."
    if any(ours.triangles > theirs.triangles for ours, theirs in pairs):
        yield (
            "A greedy Delaunay triangulation is a near-optimal static mesh: where triangles count "
            "most and one mesh serves every view, it is the better choice."
        )


def _in_view(sweep: Sequence[Result]) -> Iterator[str]:
    ours = _find(sweep, "ScreenErrorLod", 1.0)
    if ours is None:
        return
    static = [r for r in sweep if r.contender.peer is not None and r.pixels <= 1.0]
    what = f"Within one pixel, screen-error LOD draws {ours.triangles:,} triangles in a view"
    if not static:
        yield f"{what}; no static mesh tried by a peer stays within a pixel over the path."
        return
    best = min(static, key=lambda result: result.triangles)
    ratio = ours.triangles / best.triangles
    yield (
        f"{what}; the smallest of the peers' static meshes that stays within a pixel over the path "
        f"is {best.contender.label} with {best.triangles:,}: ours has {ratio:.0%} of that."
    )


def _tile_sizes(tiles: Sequence[Result]) -> Iterator[str]:
    for family in dict.fromkeys(result.contender.family for result in tiles):
        best = min(_of(tiles, family), key=lambda result: result.triangles)
        contender = best.contender
        yield (
            f"{contender.name} at {contender.setting} needs the fewest "
            f"triangles in tiles of {contender.tile} cells: {best.triangles:,}."
        )


def _pops(partitionings: Sequence[Result]) -> Iterator[str]:
    if len(partitionings) > 1:
        each = ", ".join(
            f"{r.contender.partitioning} {r.pop:.3g} (RMS {r.pop_rms:.2g})"
            for r in sorted(partitionings, key=lambda result: result.pop)
        )
        yield f"The surface jumps at most, in pixels from one picture to the next: {each}."


def _same_tolerance(sweep: Sequence[Result], peer: str) -> Iterator[tuple[Result, Result]]:
    """Yield our result and a peer's, for each tolerance of both."""
    for theirs in _of(sweep, peer):
        ours = _find(sweep, "MaxErrorLod", theirs.contender.parameter)
        if ours is not None:
            yield ours, theirs


def _of(results: Sequence[Result], family: str) -> list[Result]:
    return [result for result in results if result.contender.family == family]


def _called(results: Sequence[Result], name: str) -> list[Result]:
    return [result for result in results if result.contender.name == name]


def _find(results: Sequence[Result], family: str, parameter: float) -> Result | None:
    for result in _of(results, family):
        if result.contender.parameter == parameter:
            return result
    return None


def _times_as(ratio: float, more: str, less: str) -> str:
    return f"{ratio:.3g} times {more}" if ratio >= 1 else f"{1 / ratio:.3g} times {less}"


def _number(value: float) -> str:
    return f"{value:g}"


def _milliseconds(seconds: float) -> str:
    return f"{1e3 * seconds:,.0f} ms" if seconds >= 1 else f"{1e3 * seconds:.3g} ms"
