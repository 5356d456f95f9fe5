"""The page of levels of detail at one camera: what to learn first, pictures, the book's table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ..drawing.scales import COMPARED
from .comparison import EQUAL_ERROR_SHARE, EQUAL_SHARE, Comparison, Trial
from .html import bars, definitions, figure, paragraph, row_of_figures, section, table
from .pictures import VISIBLE_DIFFERENCE, Difference
from .tables import Row, rasterised_share
from .template import filled_page
from .verdict import (
    pixels,
    purpose,
    small_share,
    why_times_differ,
)

# what the tables of equal triangles and of equal error show
_SHORT = ("triangles", "pixels_max", "pixels_rms", "error_max", "error_rms")

# sentences of the verdict that stand first
_FIRST = 3


def page(
    comparison: Comparison,
    rows: Sequence[Row],
    verdict: Sequence[str],
    pictures: Mapping[str, Path],
    difference: Difference | None,
    *,
    no_pictures: str | None = None,
) -> str:
    """Return the page's text.

    Parameters
    ----------
    comparison : Comparison
    rows : sequence of Row
    verdict : sequence of str
        Sentences.
    pictures : mapping of str to Path
        Files by name; ``maps`` alone where no 3-D picture could be drawn.
    difference : Difference or None
        Of the two shaded pictures.
    no_pictures : str, optional
        Why there are no 3-D pictures.
    """
    if no_pictures is None:
        seen = _seen(comparison, pictures, difference)
    else:
        seen = section("What the camera sees", paragraph(f"No 3-D pictures. {no_pictures}."))
    return filled_page(
        title=f"Level of detail: {comparison.terrain.ground.name}",
        subtitle=_subtitle(comparison),
        verdict=verdict[:_FIRST],
        cards=_bars(comparison),
        sections=[
            _purposes(comparison),
            _equals(comparison, rows),
            seen,
            _result(comparison, rows, verdict),
            _from_above(comparison, pictures["maps"]),
            _stages(comparison, rows),
            _times(comparison, rows),
            _settings(comparison),
        ],
        numbers="report.json, report.csv",
    )


def _subtitle(comparison: Comparison) -> str:
    ground = comparison.terrain.ground
    (rows, columns), (low, high) = ground.shape, ground.height_range
    across, up = ground.unit_symbols
    large, scale = ("km", 1000) if across == "m" else (across, 1)
    width, depth = (extent / scale for extent in ground.extent)
    *first, last = (trial.called for trial in comparison.asked)
    names = f"{', '.join(first)} and {last}"
    return (
        f"{rows:,} × {columns:,} samples, {ground.spacing[0]:g} × {ground.spacing[1]:g} {across} "
        f"apart, {width:.4g} × {depth:.4g} {large}, {low:,.0f} to {high:,.0f} {up} high. "
        f"{names[:1].upper()}{names[1:]}, from the same camera."
    )


def _bars(comparison: Comparison) -> Iterator[str]:
    """Return what to see first: the shorter, the better."""
    alike = [trial for trial in comparison.equal_triangles if comparison.draws_as_many(trial)]
    if len(alike) > 1:
        yield bars(
            f"Same triangles, {comparison.other.triangles:,}: how far off is the picture?",
            [(trial.title, trial.seen.maximum, pixels(trial)) for trial in alike],
        )
    same = [trial for trial in comparison.equal_error if comparison.is_as_far_off(trial)]
    if len(same) > 1:
        yield bars(
            f"Same error, {pixels(comparison.other)}: how many triangles does it take?",
            [(trial.title, trial.triangles, f"{trial.triangles:,}") for trial in same],
        )


def _purposes(comparison: Comparison) -> str:
    return section(
        "What each level of detail is for",
        definitions((trial.title, purpose(trial)) for trial in comparison.asked),
    )


def _table(title: str, comparison: Comparison, trials: Sequence[Trial], rows: Sequence[Row]) -> str:
    """Return a table of some of the trials."""
    at = [comparison.trials.index(trial) for trial in trials]
    chosen = [
        Row(row.table, row.key, row.label, row.unit, tuple(row.values[index] for index in at))
        for row in rows
    ]
    # what no trial of this table has, such as a stage of another
    told = [row for row in chosen if any(value is not None for value in row.values)]
    return table(title, [trial.title for trial in trials], told)


def _equals(comparison: Comparison, rows: Sequence[Row]) -> str:
    short = [row for key in _SHORT for row in rows if row.key == key]
    other = comparison.other
    parts = [
        paragraph(
            f"{other.title} is as it was asked for. The others are tuned to it, distance LOD by "
            "its highest factor and screen-error LOD by its pixels: until triangle counts agree "
            f"to {EQUAL_SHARE:.0%}, and until the largest errors in the picture agree to "
            f"{EQUAL_ERROR_SHARE:.0%}.",
            kind="soft",
        )
    ]
    if comparison.equal_triangles:
        parts.append(_table("Same triangles", comparison, comparison.equal_triangles, short))
    if comparison.equal_error:
        parts.append(_table("Same error", comparison, comparison.equal_error, short))
    return section("Same triangles, same error", *parts)


def _seen(
    comparison: Comparison, pictures: Mapping[str, Path], difference: Difference | None
) -> str:
    """Return what the camera sees: where triangles go, single ones, and what is left of it."""
    finest, coarsest = COMPARED["lod"]
    ramp = (
        f'<div class="ramp"><span>{coarsest:g} cells a segment, or more</span><i></i>'
        f"<span>{finest:g}</span></div>"
    )
    kind = "three" if len(comparison.asked) == 3 else "two"
    close = comparison.equal_triangles or comparison.asked

    def figures(style: str, captions: Sequence[str]) -> str:
        names = [f"{style}_{trial.name}" for trial in comparison.asked]
        return row_of_figures(
            kind,
            [figure(pictures[name], text) for name, text in zip(names, captions, strict=True)],
        )

    apart = []
    if difference is not None:
        apart = [
            paragraph(_differ(comparison, difference)),
            figure(
                pictures["difference"],
                f"{comparison.distance.title} against {comparison.other.called}: black where they "
                "are the same, white where they differ completely (square root scale)",
            ),
        ]
    return "\n".join(
        [
            section(
                "Where the triangles go",
                paragraph(
                    "As asked for, each patch in the colour of its segments: yellow where one is a "
                    "cell of the raster, the most detail there is; dark violet where it spans "
                    f"{coarsest:g}. The pictures share one scale, in equal steps of doubling.",
                    kind="soft",
                ),
                ramp,
                figures("lod", [_caption(comparison, trial) for trial in comparison.asked]),
            ),
            section(
                "Single triangles, close by",
                paragraph(
                    "The same meshes with as many triangles, seen with a longer lens: where "
                    "distance LOD is farthest off in the picture.",
                    kind="soft",
                ),
                figures(
                    "close", [f"{trial.title}, {trial.triangles:,} triangles" for trial in close]
                ),
            ),
            section(
                "What is left of it on the screen",
                figures("shaded", [trial.title for trial in comparison.asked]),
                *apart,
            ),
        ]
    )


def _differ(comparison: Comparison, difference: Difference) -> str:
    return (
        f"The pictures of {comparison.distance.called} and {comparison.other.called} differ by "
        f"{small_share(difference.mean)} on average; "
        f"{small_share(difference.visible_share)} of the pixels differ by more than "
        f"{VISIBLE_DIFFERENCE:.0%}, the most by {difference.largest:.0%}; "
        f"their structural similarity is {difference.similarity:.3f}."
    )


def _caption(comparison: Comparison, trial: Trial) -> str:
    share = rasterised_share(comparison, trial)
    return (
        f"{trial.title}: {trial.triangles:,} triangles generated, {share:.0%} rasterised; at most "
        f"{pixels(trial)} off"
    )


def _result(comparison: Comparison, rows: Sequence[Row], verdict: Sequence[str]) -> str:
    return section(
        "As asked for: triangles and error",
        *map(paragraph, verdict[_FIRST:]),
        paragraph(
            "Vertical error is measured at every sample under the drawn patches, error in the "
            "picture at every sample in view; both from the triangles themselves.",
            kind="soft",
        ),
        _table("Result", comparison, comparison.asked, [r for r in rows if r.table == "result"]),
    )


def _from_above(comparison: Comparison, maps: Path) -> str:
    return section(
        "From above",
        figure(
            maps,
            "The outline on the ground is the picture's, on the level of the lowest ground. Grey: "
            "nothing drawn. The error maps are of as many triangles.",
        ),
    )


def _stages(comparison: Comparison, rows: Sequence[Row]) -> str:
    return section(
        "Stages and storage",
        paragraph(
            "What Direct3D 11 would be called for and would hold, in the formats of the book's "
            "table (section 9.1.1): 20 bytes a vertex, 12 control points a patch. Below, what the "
            "same triangles take as a plain mesh, and what this engine holds on its device.",
            kind="soft",
        ),
        _table("Stage", comparison, comparison.asked, [r for r in rows if r.table == "stages"]),
        _table("Storage", comparison, comparison.asked, [r for r in rows if r.table == "storage"]),
    )


def _times(comparison: Comparison, rows: Sequence[Row]) -> str:
    times = [row for row in rows if row.table == "time"]
    runs = len(comparison.distance.runs)
    parts = [
        paragraph(
            f"Device time by stage, warm, on {comparison.terrain.device.info}: the median of "
            f"{runs} runs. Levels of detail took turns, so that all met the same load.",
            kind="soft",
        ),
        _table("Time, as asked for", comparison, comparison.asked, times),
    ]
    if comparison.equal_triangles:
        parts.append(_table("Time, same triangles", comparison, comparison.equal_triangles, times))
        parts += map(paragraph, why_times_differ(comparison.equal_triangles))
    return section("Time", *parts)


def _settings(comparison: Comparison) -> str:
    terrain, camera = comparison.terrain, comparison.camera
    unit = terrain.ground.unit_symbols[0]
    view = f"{camera.fov:g}°" if camera.height is None else f"{camera.height:g} {unit}, parallel,"

    def point(values: Sequence[float]) -> str:
        return ", ".join(f"{value:.6g}" if abs(value) < 1e5 else f"{value:.1f}" for value in values)

    pairs = [
        ("Ground", repr(terrain.ground)),
        ("Coordinates", terrain.ground.crs or "not georeferenced"),
        ("Edge rule, partitioning", f"{comparison.edge_rule}, {comparison.partitioning}"),
        ("Camera", f"eye {point(camera.eye)}, target {point(camera.target)}"),
        ("Picture", f"{view} high, {camera.size[0]} × {camera.size[1]} pixels"),
    ]
    pairs += [(_with_how(trial), _parameters(trial)) for trial in comparison.trials]
    return section("Settings", definitions(pairs))


def _with_how(trial: Trial) -> str:
    how = trial.name.partition("_equal_")[2]
    return f"{trial.title}, same {how}" if how else trial.title


def _parameters(trial: Trial) -> str:
    grid = trial.terrain.grid
    tiles = f"{' × '.join(map(str, grid.shape))} tiles of {grid.tile} cells"
    return ", ".join([tiles, *(f"{name} {value:.4g}" for name, value in trial.parameters.items())])
