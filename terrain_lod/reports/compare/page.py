"""The comparison as one HTML page that can be mailed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

from ..html import card, definitions, figure, listing, paragraph, row_of_figures, section
from ..template import filled_page
from .outcome import SweepReport
from .peers import PEERS
from .trials import Result

_COST_HEADS: Final = (
    "Asked for",
    "Edges",
    "Triangles",
    "Whole, ms",
    "least – most",
    "First, ms",
    "View, ms",
    "least – most",
    "Mesh, MB",
    "Device, MB",
    "Peak, MB",
)


def comparison_page(made: SweepReport) -> str:
    """Return the page's text."""
    ground = made.course.ground
    (rows, columns), (low, high) = ground.shape, ground.height_range
    across, up = ground.unit_symbols
    return filled_page(
        title=f"Speed against error: {ground.name}",
        subtitle=(
            f"{rows:,} × {columns:,} samples, {ground.spacing[0]:g} × {ground.spacing[1]:g} "
            f"{across} apart, {low:,.0f} to {high:,.0f} {up} high; "
            f"{len(made.course.pairs)} views of a low flight, "
            f"{made.course.cameras[0].size[0]} × {made.course.cameras[0].size[1]} pixels; "
            f"on {made.course.device.info}."
        ),
        verdict=[*made.findings, *made.speeds],
        cards=_cards(made),
        sections=_sections(made),
        numbers="compare.json, compare.csv and, for what differs from run to run, times.csv",
    )


def _cards(made: SweepReport) -> Iterator[str]:
    promised = [r for r in made.results if r.contender.peer is None and _asks(r)]
    broken = sum(result.broken is not None for result in promised)
    yield card(f"{broken} of {len(promised)}", "promises of an error broken, measured outside")
    peers = [r for r in made.sweep if r.contender.peer is not None and _asks(r)]
    if peers:
        count = sum(result.broken is not None for result in peers)
        yield card(f"{count} of {len(peers)}", "broken by peers that state an error")
    yield card(f"{len(made.results)}", "meshes made, timed and measured at every sample")


def _asks(result: Result) -> bool:
    return bool(result.contender.asked_metres or result.contender.asked_pixels)


def _sections(made: SweepReport) -> Iterator[str]:
    yield section(
        "Triangles and time against error",
        paragraph(
            "Lower and further left is better. Lines join one maker at several settings; dashes "
            "are peers. View-dependent levels of detail count the triangles of one view: they are "
            "meant for the plot in pixels. What has no error at all is off the scale and in the "
            "table.",
            kind="soft",
        ),
        figure(made.files["triangles"], "Triangles against the largest error"),
        figure(made.files["time"], "Time from raster to mesh against the largest error, warm"),
    )
    yield _broken(made)
    yield _tried(made)
    yield _seen(made)
    yield section(
        "Time and memory",
        paragraph(
            "Whole: from raster in host memory to mesh in host memory, terrain and error ladder "
            "included, warm; median, and least to most of up to three. First: the first call, in "
            "which kernels may have been built. View: one more camera, the terrain being there. "
            "Mesh: its positions, normals and corners. Device: held there for terrain and mesh. "
            "Peak: host memory that the first call took on top, where the system tells.",
            kind="soft",
        ),
        listing("Time and memory", _COST_HEADS, _grouped(made.sweep, _cost_line), words=2),
    )
    yield section(
        "Tile sizes",
        paragraph("The two promises at one tolerance, in tiles of every size.", kind="soft"),
        listing(
            "Tile sizes",
            ("Asked for", "Tile", *_heads(made)[1:]),
            _grouped(made.tiles, _tile_line),
            words=3,
        ),
    )
    yield _popping(made)


def _heads(made: SweepReport) -> tuple[str, ...]:
    """Return the titles of the columns."""
    up = made.course.ground.unit_symbols[1]
    return (
        "Asked for", "Edges", "Triangles", f"Largest, {up}", f"RMS, {up}", "Largest, px", "RMS, px",
        "Kept", "Pop, px", "Whole, ms",
    )  # fmt: skip


def _tried(made: SweepReport) -> str:
    return section(
        "Everything tried",
        paragraph(
            "Errors are measured at every sample, from the triangles, by the same code for all; "
            "in pixels at every sample in view. Kept: whether the error asked for is the error "
            "measured, and by which factor it was missed if not; a peer is forgiven a thousandth, "
            "which rounding may add, ours nothing. Pop: how far the surface jumps to "
            "the next of 240 pictures of the flight.",
            kind="soft",
        ),
        listing("Everything tried", _heads(made), _grouped(made.sweep, _line), words=2),
        *_absent(made.missing),
    )


def _popping(made: SweepReport) -> str:
    return section(
        "Popping",
        paragraph(
            "Distance LOD in every partitioning: between whole numbers of segments the surface "
            "jumps, fractional ones let it move.",
            kind="soft",
        ),
        listing(
            "Popping",
            ("Partitioning", "Triangles", "Largest pop, px", "RMS, px"),
            (
                (
                    r.contender.partitioning,
                    f"{r.triangles:,}",
                    _short(r.pop),
                    _short(r.pop_rms),
                )
                for r in made.partitionings
            ),
        ),
    )


def _absent(missing: Sequence[str]) -> Iterator[str]:
    """Return which peers are not there, and the commands that install them."""
    commands = [(peer.name, peer.command) for peer in PEERS if peer.name in missing]
    if commands:
        yield paragraph("Not installed and so not compared, with the command that installs each:")
        yield definitions(commands)


def _broken(made: SweepReport) -> str:
    """Return every error that was asked for and not kept; the worst first."""
    broken = [result for result in made.results if result.broken is not None]
    title = "What was broken, and by how much"
    if not broken:
        return section(title, paragraph("Nothing: every error asked for is the error measured."))
    lines = [
        (
            r.contender.name,
            r.contender.setting,
            _short(r.metres if r.contender.asked_metres else r.pixels),
            f"× {r.broken:.3g}",
        )
        for r in sorted(broken, key=lambda result: -(result.broken or 0.0))
    ]
    heads = ("Maker", "Asked for", "Measured, same unit", "Times as much")
    return section(
        title,
        paragraph("The largest error at any sample, measured from the triangles.", kind="soft"),
        listing(title, heads, lines, words=2),
    )


def _grouped(
    results: Sequence[Result], line: Callable[[Result], Sequence[str]]
) -> dict[str, list[Sequence[str]]]:
    """Return lines by maker, under its name and what it makes."""
    groups: dict[str, list[Sequence[str]]] = {}
    for each in results:
        groups.setdefault(f"{each.contender.name}. {each.contender.purpose}", []).append(line(each))
    return groups


def _seen(made: SweepReport) -> str:
    families = dict.fromkeys(result.contender.family for result in made.sweep)
    names = [name for name in families if name in made.files]
    if not names:
        return section("Where the triangles go", paragraph("This machine draws no 3-D pictures."))
    ramp = '<div class="ramp"><span>64 cells a segment</span><i></i><span>1</span></div>'
    called = {result.contender.family: result.contender.name for result in made.sweep}
    pictures = [figure(made.files[name], called[name]) for name in names]
    return section(
        "Where the triangles go",
        paragraph("The first view, each patch coloured by how long its segments are.", kind="soft"),
        ramp,
        row_of_figures("two", pictures),
    )


def _line(result: Result) -> list[str]:
    contender, kept = result.contender, ""
    if _asks(result):
        kept = "yes" if result.broken is None else f"× {result.broken:.3g}"
    return [
        *_who(result),
        *map(_short, (result.metres, result.metres_rms, result.pixels, result.pixels_rms)),
        kept,
        "static" if contender.is_static else _short(result.pop),
        _milliseconds(result.times.whole),
    ]


def _tile_line(result: Result) -> list[str]:
    first, *rest = _line(result)
    return [first, str(result.contender.tile), *rest]


def _cost_line(result: Result) -> list[str]:
    times = result.times
    return [
        *_who(result),
        _milliseconds(times.whole),
        f"{_milliseconds(times.whole_low)} – {_milliseconds(times.whole_high)}",
        _milliseconds(times.first),
        _milliseconds(times.view),
        f"{_milliseconds(times.view_low)} – {_milliseconds(times.view_high)}".strip(" –"),
        f"{result.mesh_bytes / 1e6:.1f}",
        f"{result.device_bytes / 1e6:.1f}" if result.device_bytes else "",
        "" if times.peak_bytes is None else f"{times.peak_bytes / 1e6:.0f}",
    ]


def _who(result: Result) -> tuple[str, str, str]:
    contender = result.contender
    return contender.setting, contender.edge_rule, f"{result.triangles:,}"


def _milliseconds(seconds: float | None) -> str:
    return "" if seconds is None else _short(1e3 * seconds)


def _short(value: float) -> str:
    if value != value:  # nothing was in view
        return "–"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"
