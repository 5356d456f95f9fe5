"""The hard cases as a report: every kernel on what is hard on floats, against its bounds."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from ..checks.check import Bound, Check, Difference
from ..checks.table import CHECKS
from ..device.device import Device
from ..paths import require_made
from .html import Strong, card, definitions, listing, paragraph, section
from .template import filled_page
from .texts import Steps, csv_text, json_text, write_texts

# of the JSON file; raised when a key changes its meaning
FORMAT: Final = 2

# whose cases are grounds
_GROUND_ROOMS: Final = ("terrain", "mesh", "measure")


@dataclass(frozen=True)
class Finding:
    """How far one quantity of a kernel is from its reference, in one case.

    Attributes
    ----------
    kernel : str
        Its file, without its ending.
    case : str
    difference : Difference
        Where it is nearest to its bound.
    """

    kernel: str
    case: str
    difference: Difference

    @property
    def bound(self) -> Bound:
        return self.difference.bound

    @property
    def places(self) -> tuple[str, str]:
        """Where the kernel stands, and the comparison that applies the bound."""
        compare = inspect.unwrap(CHECKS[self.kernel].compare)
        file, (_, line) = inspect.getfile(compare), inspect.getsourcelines(compare)
        return f"kernels/{self.kernel.partition(',')[0]}.cl", f"checks/{Path(file).name}:{line}"

    @property
    def numbers(self) -> tuple[str, str, str]:
        """Difference and bound with their unit, and the share that the one is of the other."""
        return (
            f"{self.difference.error:.2g} {self.bound.unit}",
            f"{self.difference.allowed:.2g} {self.bound.unit}",
            _share(self.difference),
        )


@dataclass(frozen=True, eq=False)
class StabilityReport:
    """What the hard cases came to.

    Attributes
    ----------
    findings : list of Finding
        One a kernel, case and quantity.
    verdict : str
    files : dict of str to Path
        ``html``, ``json`` and ``csv``.
    """

    findings: list[Finding]
    verdict: str
    files: dict[str, Path]


def findings(
    device: Device,
    checks: Mapping[str, Check] = CHECKS,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[Finding]:
    """Yield how far every quantity is from its reference, kernel by kernel and case by case."""
    tasks = [(kernel, case) for kernel, check in checks.items() for case in check.cases]
    step = Steps(progress, len(tasks))
    for kernel, case in tasks:
        worst: dict[str, Difference] = {}
        for each in checks[kernel].differences(case, device):
            quantity = each.bound.quantity
            worst[quantity] = max(worst.get(quantity, each), each, key=lambda one: one.share)
        yield from (Finding(kernel, case, each) for each in worst.values())
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
    device = Device.of(device)
    found = list(findings(device, CHECKS, progress))
    texts = {"csv": _csv(found), "json": _json(found, device), "html": _page(found, device)}
    written = write_texts(folder, {kind: (f"stability.{kind}", texts[kind]) for kind in texts})
    return StabilityReport(found, verdict(found), written)


def verdict(found: list[Finding]) -> str:
    """Return in a sentence whether every bound is met."""
    broken = [each for each in found if not each.difference.is_met]
    cases = f"in {len({each.case for each in found})} cases"
    if not broken:
        return f"All {len(found)} bounds are met, {cases} that are hard on 32-bit floats."
    named = "; ".join(f"{each.bound.quantity} ({each.kernel}) in {each.case}" for each in broken)
    return f"{len(broken)} of {len(found)} bounds are not met, {cases}: {named}."


def _entry(each: Finding) -> dict[str, Any]:
    """Return what both files say of a finding."""
    return {
        "kernel": each.kernel,
        "case": each.case,
        "quantity": each.bound.quantity,
        "difference": each.difference.error,
        "allowed": each.difference.allowed,
        "unit": each.bound.unit,
        "share": each.difference.share,
        "met": each.difference.is_met,
    }


def _csv(found: list[Finding]) -> str:
    entries = [_entry(each) for each in found]
    return csv_text([entries[0], *(each.values() for each in entries)])


def _json(found: list[Finding], device: Device) -> str:
    content = {
        "device": str(device.info),
        "bounds": {
            bound.quantity: {"bound": bound.limit, "reason": bound.reason}
            for bound in _bounds(found)
        },
        "findings": [_entry(each) for each in found],
        "verdict": verdict(found),
    }
    return json_text(FORMAT, content)


def _bounds(found: list[Finding]) -> list[Bound]:
    return list(dict.fromkeys(each.bound for each in found))


def _page(found: list[Finding], device: Device) -> str:
    met = sum(each.difference.is_met for each in found)
    wrong = sum(math.isinf(each.difference.error) for each in found)
    return filled_page(
        title="Numerical stability",
        subtitle=f"Every kernel against its reference in 64-bit floats, on {device.info}.",
        verdict=[verdict(found)],
        cards=[
            card(f"{met} of {len(found)}", "bounds met"),
            card(str(len({each.kernel for each in found})), "kernels"),
            card(str(len({each.case for each in found})), "cases"),
            card(str(wrong), "NaN from finite input"),
        ],
        sections=_sections(found),
        numbers="stability.json, stability.csv",
    )


_HEADS: Final = ("Difference", "Allowed", "Share", "Bound applied", "Kernel", "Check")


def _line(each: Finding) -> list[str]:
    return [*each.numbers, each.bound.limit, *each.places]


def _sections(found: list[Finding]) -> Iterator[str]:
    of_ground = [each for each in found if each.kernel.split("/")[0] in _GROUND_ROOMS]
    yield section(
        "Hard cases of every kernel on ground",
        paragraph(
            "Share of the bound that is used up, of the quantity that is nearest to its own; each "
            "kernel's worst case in bold, and × where a bound is not met.",
            kind="soft",
        ),
        _matrix(of_ground),
    )
    yield section(
        "Bounds",
        paragraph(
            "For each quantity the case that comes nearest to its bound. Difference and allowed "
            "are in the quantity's own unit, never in ulps: an ulp, the distance from one 32-bit "
            "float to the next, says nothing where a value is near zero.",
            kind="soft",
        ),
        listing(
            "Bounds",
            ("Quantity", "Nearest case", *_HEADS),
            (
                [each.bound.quantity, each.case, *_line(each)]
                for each in map(_nearest, _by(found, lambda each: each.bound.quantity).values())
            ),
            words=2,
        ),
    )
    others = [each for each in found if each not in of_ground]
    yield section(
        "Patterns and curved meshes",
        listing(
            "Patterns and curved meshes",
            ("Case", "Quantity", *_HEADS),
            {
                kernel: [
                    [each.case, each.bound.quantity, *_line(each)]
                    for each in map(_nearest, _by(of_kernel, lambda one: one.case).values())
                ]
                for kernel, of_kernel in _by(others, lambda one: one.kernel).items()
            },
            words=2,
        ),
    )
    yield section(
        "Why so much is allowed",
        definitions((each.quantity, f"{each.limit}: {each.reason}.") for each in _bounds(found)),
    )


def _by(found: list[Finding], key: Callable[[Finding], Any]) -> dict[Any, list[Finding]]:
    """Return findings in groups of one key, in the order in which these come."""
    groups: dict[Any, list[Finding]] = {}
    for each in found:
        groups.setdefault(key(each), []).append(each)
    return groups


def _nearest(found: list[Finding]) -> Finding:
    return max(found, key=lambda each: each.difference.share)


def _share(difference: Difference) -> str:
    if difference.error == 0:
        return "0"
    mark = "" if difference.is_met else " ×"
    return f"{difference.share:.0%}{mark}" if math.isfinite(difference.share) else f"any{mark}"


def _matrix(found: list[Finding]) -> str:
    """Return a table with a line a case and a column a kernel."""
    columns = {
        kernel: {case: _nearest(own) for case, own in _by(of_kernel, lambda e: e.case).items()}
        for kernel, of_kernel in _by(found, lambda each: each.kernel).items()
    }
    worst = {kernel: _nearest(list(cells.values())) for kernel, cells in columns.items()}

    def cell(kernel: str, case: str) -> str:
        each = columns[kernel].get(case)
        if each is None:
            return ""
        text = _share(each.difference)
        return Strong(text) if each is worst[kernel] and each.difference.error else text

    heads = ("Case", *(kernel.rpartition("/")[2].replace("_", " ") for kernel in columns))
    cases = dict.fromkeys(each.case for each in found)
    return listing(
        "Grounds and cameras",
        heads,
        ([case, *(cell(kernel, case) for kernel in columns)] for case in cases),
    )
