"""The page of two levels of detail at one camera: pictures, what came out, what it took."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from .comparison import EQUAL_SHARE, Comparison, Trial
from .html import card, definitions, figure, formatted, paragraph, row_of_figures, section, table
from .maps import factor_range
from .pictures import VISIBLE_DIFFERENCE, Difference
from .tables import Row, rasterised_share
from .template import filled_page
from .verdict import small_share


def _heads(comparison: Comparison) -> tuple[str, ...]:
    return "Distance", comparison.other.title.removesuffix(" LOD"), "Distance, as many triangles"


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
        seen = _seen(comparison, pictures)
    else:
        seen = section("What the camera sees", paragraph(f"No 3-D pictures. {no_pictures}."))
    return filled_page(
        title=f"Level of detail: {comparison.terrain.ground.name}",
        subtitle=_subtitle(comparison),
        verdict=verdict,
        cards=_cards(comparison, difference),
        sections=[
            seen,
            _result(comparison, rows),
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
    return (
        f"{rows:,} × {columns:,} samples, {ground.spacing[0]:g} × {ground.spacing[1]:g} {across} "
        f"apart, {width:.4g} × {depth:.4g} {large}, {low:,.0f} to {high:,.0f} {up} high. "
        f"Naive distance LOD against {comparison.other.name} LOD, from the same camera."
    )


def _cards(comparison: Comparison, difference: Difference | None) -> Iterator[str]:
    distance, other, equal = comparison.trials
    if distance.triangles:
        change = other.triangles / distance.triangles - 1
        yield card(_change(change), f"triangles: {other.name} LOD against distance LOD")
    if comparison.is_equal and equal.error.rms > 0:
        change = other.error.rms / equal.error.rms - 1
        yield card(_change(change), "RMS vertical error, with as many triangles")
    if difference is not None:
        share = small_share(difference.visible_share)
        yield card(
            share.replace("less than ", "< "),
            f"of the pixels differ by more than {VISIBLE_DIFFERENCE:.0%}",
        )
    total = formatted(sum(other.seconds.values()), "s")
    yield card(f"{total} ms", f"for all stages of {other.triangles:,} triangles")


def _change(share: float) -> str:
    return f"{share:+.1%}".replace("-", "−")


def _seen(comparison: Comparison, pictures: Mapping[str, Path]) -> str:
    """Return the book's figures: 9.22 beside 9.23, and 9.24."""
    pair = comparison.distance, comparison.other
    low, high = factor_range(comparison)
    ramp = f'<div class="ramp"><span>{low:g}</span><i></i><span>{high:g} segments</span></div>'
    detail = [figure(pictures[f"lod_{trial.name}"], _caption(comparison, trial)) for trial in pair]
    lines = [
        figure(pictures[f"wireframe_{trial.name}"], f"{trial.title}: wireframe") for trial in pair
    ]
    shaded = [
        figure(pictures["shaded_distance"], "Distance LOD"),
        figure(
            pictures["difference"],
            "Their difference: black none, white complete (square root scale)",
        ),
        figure(pictures[f"shaded_{pair[1].name}"], pair[1].title),
    ]
    return "\n".join(
        [
            section(
                "Where the triangles go",
                paragraph(
                    "Each patch in the colour of its inside factor: yellow is the most detail, "
                    "dark violet the least.",
                    kind="soft",
                ),
                ramp,
                row_of_figures("two", detail + lines),
            ),
            section("What is left of it on the screen", row_of_figures("three", shaded)),
        ]
    )


def _caption(comparison: Comparison, trial: Trial) -> str:
    share = rasterised_share(comparison, trial)
    return f"{trial.title}: {trial.triangles:,} triangles generated, {share:.0%} rasterised"


def _result(comparison: Comparison, rows: Sequence[Row]) -> str:
    return section(
        "Triangles and error",
        paragraph(
            "Vertical error is measured at every sample under the drawn patches, from the "
            "triangles themselves. The last column is the distance LOD again, its highest factor "
            f"lowered until the triangle counts agree to {EQUAL_SHARE:.0%}.",
            kind="soft",
        ),
        table(_heads(comparison), [row for row in rows if row.table == "result"]),
    )


def _from_above(comparison: Comparison, maps: Path) -> str:
    return section(
        "From above",
        figure(
            maps,
            "The outline on the ground is the picture's, on the level of the lowest ground. Grey: "
            "nothing drawn. The error maps compare equal triangle counts.",
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
        table(_heads(comparison), [row for row in rows if row.table == "stages"]),
        table(_heads(comparison), [row for row in rows if row.table == "storage"]),
    )


def _times(comparison: Comparison, rows: Sequence[Row]) -> str:
    return section(
        "Time",
        paragraph(
            f"Device time by stage, warm, median of runs, on {comparison.terrain.device.info}.",
            kind="soft",
        ),
        table(_heads(comparison), [row for row in rows if row.table == "time"]),
    )


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
    heads = zip(_heads(comparison), comparison.trials, strict=True)
    pairs += [(head, _parameters(trial)) for head, trial in heads]
    return section("Settings", definitions(pairs))


def _parameters(trial: Trial) -> str:
    grid = trial.terrain.grid
    tiles = f"{' × '.join(map(str, grid.shape))} tiles of {grid.tile} cells"
    return ", ".join([tiles, *(f"{name} {value:.4g}" for name, value in trial.parameters.items())])
