"""The doctor outlives real crashes and hangs, and its own checks hold on this machine."""

from __future__ import annotations

import logging
import re
import sys
from pathlib import Path

import pytest

from terrain_lod.checks.table import CHECKS
from terrain_lod.cli import doctor
from terrain_lod.cli.doctor import Finding, examine, run_doctor
from terrain_lod.device.drivers import devices

BAD = "support.doctor_checks"


@pytest.fixture(autouse=True)
def _talkative(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(logging.getLogger("terrain_lod"), "level", logging.WARNING)


def verdicts(*kernels: str, checks: str = BAD, timeout: float = 100.0) -> list[str]:
    findings = examine(0, kernels, checks=checks, timeout=timeout)
    assert [finding.kernel for finding in findings] == list(kernels)
    return [finding.row[-1] for finding in findings]


def test_differences_are_held_against_their_bounds() -> None:
    assert verdicts("sound", "wrong", "unknown") == ["sound", "WRONG", "WRONG"]
    assert not Finding("nan", error=float("nan"), bound=1.0).sound


def test_what_drivers_print_is_no_answer() -> None:
    assert verdicts("noisy", "sound") == ["sound", "sound"]


def test_an_exception_is_one_line_and_the_rest_goes_on() -> None:
    assert verdicts("raises", "sound") == ["RuntimeError: the first line", "sound"]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no signals")
def test_crashes_are_blamed_on_their_kernels_and_the_rest_goes_on() -> None:
    assert verdicts("sound", "aborts", "reads_nowhere", "exits", "sound") == [
        "sound",
        "crashed with SIGABRT",
        "crashed with SIGSEGV",
        "ended with exit status 3",
        "sound",
    ]


@pytest.mark.slow
def test_a_hang_ends_with_its_time_and_is_not_tried_again() -> None:
    assert verdicts("sound", "hangs", "sound", checks="support.doctor_hangs", timeout=15) == [
        "sound",
        "no answer within 15 s",
        "not tried",
    ]


@pytest.mark.slow
def test_what_is_slow_at_first_is_tried_again_as_long_as_answers_come(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DOCTOR_SLOW", str(tmp_path / "built"))
    found = verdicts("sound", "slow", checks="support.doctor_slow", timeout=15)
    assert found == ["sound", "sound"]


def test_a_device_that_does_not_open_says_why() -> None:
    (finding,) = examine(99, ["sound"], checks=BAD)
    assert "unknown device '99'" in finding.problem


@pytest.mark.slow
def test_every_kernel_is_sound_here_and_the_doctor_says_which_device_to_use(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")  # no name of a kernel is broken
    assert run_doctor() == 0
    said = capsys.readouterr().out
    assert f"use 0: {devices()[0].name} (the default)" in said
    for kernel in CHECKS:
        rows = re.findall(rf"^ *{kernel}  .* (\w+) *$", said, re.MULTILINE)
        assert rows == ["sound"] * len(devices()), kernel


def test_a_later_device_is_chosen_by_its_number(capsys: pytest.CaptureFixture[str]) -> None:
    infos = [*devices(), *devices()]
    assert doctor._advise(infos, [1]) == 0
    assert "(export TERRAIN_LOD_DEVICE=1)" in capsys.readouterr().out


@pytest.mark.slow
def test_no_sound_device_is_exit_status_1(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_doctor(checks=BAD) == 1
    said = capsys.readouterr()
    assert "WRONG" in said.out
    assert "no device computes every kernel" in said.err


def test_no_driver_is_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("OCL_ICD_VENDORS", "/nonexistent")
    assert run_doctor() == 1
    assert capsys.readouterr().err.splitlines() == [
        "terrain-lod: expected an OpenCL device, found none: pip install 'pyopencl[pocl]'"
    ]


@pytest.mark.skipif(sys.platform == "win32", reason="no signals")
def test_a_crash_while_listing_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_doctor(checks="support.doctor_crash_at_import") == 1
    assert capsys.readouterr().err.splitlines() == [
        "terrain-lod: the OpenCL drivers of this machine cannot be listed: crashed with SIGABRT"
    ]
