"""The hard cases as a report: every kernel on ground that is hard on floats, against its bound."""

from __future__ import annotations

import csv
import io
import json
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from html import escape
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any, Final

from ...device.device import Device
from ...paths import replacing, require_made
from ..html import (
    card,
    listing,
    paragraph,
    section,
)
from ..template import css_ramp
from .cases import cameras, grounds, rough_ground
from .checks import (
    BOUNDS,
    Finding,
    OnGround,
    camera_findings,
)

# of the JSON file; raised when a key changes its meaning
FORMAT: Final = 1

_CAMERA_QUANTITIES: Final = ("factors", "allowed error")


@dataclass(frozen=True, eq=False)
class StabilityReport:
    """What the hard cases came to.

    Attributes
    ----------
    findings : list of Finding
        One a case and quantity.
    verdict : str
    files : dict of str to Path
        ``html``, ``json`` and ``csv``.
    """

    findings: list[Finding]
    verdict: str
    files: dict[str, Path]


def hard_findings(device: Device, step: Callable[[], None] = lambda: None) -> Iterator[Finding]:
    """Yield how far every quantity is from its reference, case by case; `step` after each case."""
    for name, ground in grounds().items():
        with warnings.catch_warnings():
            # the references overflow where the kernels are not allowed to
            warnings.simplefilter("ignore", RuntimeWarning)
            yield from OnGround(name, ground, device).findings()
        step()
    ground = rough_ground()
    for name, camera in cameras(ground).items():
        yield from camera_findings(name, ground, camera, device)
        step()


def write_stability(
    directory: str | Path,
    *,
    device: Device | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> StabilityReport:
    """Compare every kernel with its reference on the hard cases, and write it down.

    Writes ``stability.html`` (self-contained), ``stability.json`` and ``stability.csv``; the same
    on the same device every time.

    Parameters
    ----------
    directory : str or Path
        Made if it is not there.
    device : Device, optional
    progress : callable, optional
        Called with cases done and cases in all.

    Returns
    -------
    StabilityReport

    Raises
    ------
    FileError
        If the directory or a file cannot be written.
    """
    folder = require_made(Path(directory))
    device = device or Device.open()
    total, done = len(grounds()) + len(cameras(rough_ground())), 0

    def step() -> None:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, total)

    found = list(hard_findings(device, step))
    texts = {
        "csv": ("stability.csv", _csv(found)),
        "json": ("stability.json", _json(found, device)),
        "html": ("stability.html", _page(found, device)),
    }
    written = {}
    for key, (name, text) in texts.items():
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="\n")
        written[key] = folder / name
    return StabilityReport(found, verdict(found), written)


def verdict(found: list[Finding]) -> str:
    """Return in a sentence whether every bound is met."""
    broken = [each for each in found if not each.is_met]
    cases = len({each.case for each in found})
    if not broken:
        return f"All {len(found)} bounds are met, in {cases} cases that are hard on 32-bit floats."
    named = "; ".join(f"{each.quantity} in {each.case}" for each in broken)
    return f"{len(broken)} of {len(found)} bounds are not met, in {cases} cases: {named}."


def _csv(found: list[Finding]) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["case", "quantity", "error", "ulp", "relative", "share of bound", "bound"])
    for each in found:
        numbers = (each.error, each.ulp, each.relative, each.share)
        writer.writerow(
            [each.case, each.quantity, *(f"{n:.4g}" for n in numbers), BOUNDS[each.quantity]]
        )
    return stream.getvalue()


def _json(found: list[Finding], device: Device) -> str:
    def finite(value: Any) -> Any:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    content = {
        "format": FORMAT,
        "terrain_lod": version("terrain_lod"),
        "device": str(device.info),
        "bounds": BOUNDS,
        "findings": [
            {**{key: finite(value) for key, value in asdict(each).items()}, "met": each.is_met}
            for each in found
        ],
        "verdict": verdict(found),
    }
    return json.dumps(content, indent=2, allow_nan=False) + "\n"


def _page(found: list[Finding], device: Device) -> str:
    template = Template(files("terrain_lod.reports").joinpath("report.html").read_text("utf-8"))
    number = version("terrain_lod")
    met = sum(each.is_met for each in found)
    return template.substitute(
        version=escape(number),
        title="Numerical stability",
        subtitle=escape(f"Every kernel against its reference in 64-bit floats, on {device.info}."),
        verdict=paragraph(verdict(found)),
        cards="\n".join(
            [
                card(f"{met} of {len(found)}", "bounds met"),
                card(str(len({each.case for each in found})), "hard grounds and cameras"),
                card(str(sum(math.isinf(each.error) for each in found)), "NaN from finite input"),
            ]
        ),
        sections="\n".join(_sections(found)),
        footer=escape(
            f"Made by terrain_lod {number}. The same numbers: stability.json, stability.csv."
        ),
        ramp=css_ramp(),
    )


def _sections(found: list[Finding]) -> Iterator[str]:
    yield section(
        "Bounds",
        paragraph(
            "For each quantity the case that comes nearest to its bound. An ulp is the distance "
            "from one 32-bit float to the next, here at the value that the bound speaks of.",
            kind="soft",
        ),
        listing(
            ("Quantity", "Bound", "Nearest case", "Error, ulp", "Relative", "Share of bound", ""),
            (_worst(found, quantity) for quantity in BOUNDS),
            words=3,
        ),
    )
    for title, quantities in (
        ("Grounds", [name for name in BOUNDS if name not in _CAMERA_QUANTITIES]),
        ("Cameras", list(_CAMERA_QUANTITIES)),
    ):
        yield section(
            title,
            paragraph("Error in ulp, and × where the bound is not met.", kind="soft"),
            listing(("", *map(str.capitalize, quantities)), _pivot(found, quantities)),
        )


def _worst(found: list[Finding], quantity: str) -> list[str]:
    each = max((each for each in found if each.quantity == quantity), key=lambda each: each.share)
    numbers = (f"{value:.2g}" for value in (each.ulp, each.relative))
    met = "met" if each.is_met else "not met"
    return [quantity, BOUNDS[quantity], each.case, *numbers, f"{each.share:.0%}", met]


def _pivot(found: list[Finding], quantities: list[str]) -> Iterator[list[str]]:
    """Yield a line a case, with a number a quantity."""
    chosen = [each for each in found if each.quantity in quantities]
    for case in dict.fromkeys(each.case for each in chosen):
        known = {each.quantity: each for each in chosen if each.case == case}
        yield [
            case,
            *(f"{known[name].ulp:.2g}{'' if known[name].is_met else ' ×'}" for name in quantities),
        ]
