"""Is every kernel right on every device of this machine, and which device is the one to use?

Drivers crash and hang. So a child process a device does the work (``checkup.py``) and answers line
by line; one that ends early is blamed on the kernel it was at, and another goes on after it.
"""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from ..device.info import DeviceInfo
from .output import complain, say, say_table

CHECKS: Final = "terrain_lod.checks.table"
TIMEOUT: Final = 120.0

_COLUMNS: Final = ("kernel", "nearest to its bound", "difference", "bound", "time", "verdict")


@dataclass(frozen=True)
class Finding:
    """What came of one kernel on one device.

    Attributes
    ----------
    kernel : str
        Its file, without its ending.
    quantity : str
        What is nearest to its bound of all that it computes.
    error, bound : float
        Its difference from the float64 reference, and the largest that rounding explains there.
    unit : str
    seconds : float
        Of device time.
    problem : str
        Why there is no result, in one line; empty where there is one.
    """

    kernel: str
    quantity: str = ""
    error: float = math.nan
    bound: float = math.nan
    unit: str = ""
    seconds: float = math.nan
    problem: str = ""

    @property
    def sound(self) -> bool:
        return not self.problem and self.error <= self.bound

    @property
    def row(self) -> tuple[str, ...]:
        """Cells for a table."""
        if self.problem:
            return self.kernel, "", "", "", "", self.problem
        return (
            self.kernel,
            self.quantity,
            f"{self.error:.2g} {self.unit}",
            f"{self.bound:.2g} {self.unit}",
            "" if math.isnan(self.seconds) else f"{self.seconds * 1e3:.2f} ms",
            "sound" if self.sound else "WRONG",
        )


def run_doctor(*, checks: str = CHECKS, timeout: float = TIMEOUT) -> int:
    """Check every kernel on every device, print what was found, and say which device to use.

    Parameters
    ----------
    checks : str, optional
        Module whose ``CHECKS`` are run.
    timeout : float, optional
        Seconds that a device may take.

    Returns
    -------
    int
        Exit status: 0 where at least one device is sound, else 1.
    """
    answers, problem = _ask([checks], timeout)
    if not answers:
        complain(f"the OpenCL drivers of this machine cannot be listed: {problem}")
        return 1
    infos = [DeviceInfo(**info) for info in answers[0]["devices"]]
    if not infos:
        complain("expected an OpenCL device, found none: pip install 'pyopencl[pocl]'")
        return 1
    sound = []
    for number, info in enumerate(infos):
        findings = examine(number, answers[0]["kernels"], checks=checks, timeout=timeout)
        say_table(_COLUMNS, [finding.row for finding in findings], title=f"{number}: {info}")
        if all(finding.sound for finding in findings):
            sound.append(number)
    return _advise(infos, sound)


def _advise(infos: Sequence[DeviceInfo], sound: Sequence[int]) -> int:
    if not sound:
        complain("no device computes every kernel as it should: update its driver, or add PoCL's")
        return 1
    best = sound[0]
    how = "the default" if best == 0 else f"export TERRAIN_LOD_DEVICE={best}"
    say(f"use {best}: {infos[best].name} ({how})")
    return 0


def examine(
    number: int, kernels: Sequence[str], *, checks: str = CHECKS, timeout: float = TIMEOUT
) -> list[Finding]:
    """Return what came of `kernels` on device `number`, in their order."""
    findings: list[Finding] = []
    while len(findings) < len(kernels):
        remaining = kernels[len(findings) :]
        answers, problem = _ask([checks, str(number), *remaining], timeout)
        findings += [Finding(**answer) for answer in answers]
        is_late = problem.startswith("no answer")
        if is_late and answers:  # it was going on: kernels are built for the first time
            continue
        if len(answers) < len(remaining):
            findings.append(Finding(remaining[len(answers)], problem=problem))
        if is_late:  # the next might not answer either
            findings += [Finding(name, problem="not tried") for name in kernels[len(findings) :]]
    return findings


def _ask(arguments: Sequence[str], timeout: float) -> tuple[list[dict[str, Any]], str]:
    """Return the answers of a child process, and how it ended if not well."""
    # the child finds the modules that this process finds, and none that merely lie around
    paths = os.pathsep.join(path or os.getcwd() for path in sys.path)
    command = [sys.executable, "-P", "-m", "terrain_lod.checks.checkup", *arguments]
    try:
        child = subprocess.run(
            command, capture_output=True, timeout=timeout, env={**os.environ, "PYTHONPATH": paths}
        )
    except subprocess.TimeoutExpired as late:
        return _parse(late.stdout or b""), f"no answer within {timeout:g} s"
    answers = _parse(child.stdout)
    if child.returncode < 0:
        return answers, f"crashed with {signal.Signals(-child.returncode).name}"
    last_line = child.stderr.decode(errors="replace").strip().rpartition("\n")[2]
    return answers, last_line or f"ended with exit status {child.returncode}"


def _parse(output: bytes) -> list[dict[str, Any]]:
    """Return the answers among `output`: drivers print, too, and a killed child stops midway."""
    answers = []
    for line in output.decode(errors="replace").splitlines():
        try:
            answer = json.loads(line)
        except ValueError:
            continue
        if isinstance(answer, dict):
            answers.append(answer)
    return answers
