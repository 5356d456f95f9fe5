"""Every kernel against its reference, on ordinary and on hard cases, and what a bound means."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from terrain_lod.checks.check import Bound
from terrain_lod.checks.grounds import hard_views
from terrain_lod.checks.table import CHECKS
from terrain_lod.device.sources import KERNELS

CASES = [(kernel, case) for kernel, check in CHECKS.items() for case in check.cases]
METRES = Bound("height", "m", "a tenth of a millimetre", "for tests")


def test_every_kernel_file_has_a_check() -> None:
    root = Path(str(KERNELS))
    files = {file.relative_to(root).with_suffix("").as_posix() for file in root.rglob("*.cl")}
    # some have several checks, each with a word behind the file
    assert files == {name.split(",")[0] for name in CHECKS}


@pytest.mark.parametrize(("kernel", "case"), CASES, ids=[": ".join(each) for each in CASES])
def test_kernel_keeps_its_bounds(kernel: str, case: str) -> None:
    found = CHECKS[kernel].differences(case, tl.Device.open())
    assert found
    assert [each for each in found if not each.is_met] == []


@pytest.mark.parametrize("camera", [name for name in hard_views() if "camera" in name])
def test_what_a_hard_camera_sees_is_finite_and_as_promised(camera: str) -> None:
    view = hard_views()[camera]
    ground = view.ground.sum
    mesh = tl.Terrain(ground).mesh(view.camera, lod=tl.ScreenErrorLod(1.0))
    assert np.isfinite(mesh.vertices).all()
    assert np.isfinite(mesh.normals).all()
    assert not tl.screen_error(mesh, ground, view.camera).maximum > 1.0


def test_a_difference_is_held_against_its_bound_where_it_is_nearest() -> None:
    expected = np.array([1.0, 2.0, np.nan])
    off = METRES.met_by(expected + np.array([1e-3, 2e-3, 0]), expected, [1e-4, 1e-3, 1e-4])
    assert (off.error, off.allowed) == (pytest.approx(1e-3), 1e-4)
    assert off.share == pytest.approx(10)
    assert not off.is_met
    assert METRES.met_by(expected, expected).is_met
    assert METRES.met_by(expected, expected, np.nan).is_met
    assert METRES.met_by([], []).is_met
    for wrong in (np.nan, np.inf):
        assert METRES.met_by([wrong], [1.0], 1e9).error == np.inf
    assert not METRES.met_by([0.0], [np.nan], 1e9).is_met
    assert not METRES.met_by([0.0], [1.0, 2.0], 1e9).is_met
    # infinite on both sides is no difference
    assert METRES.met_by([np.inf], [np.inf]).is_met


def test_rows_are_counted() -> None:
    rows = np.arange(12).reshape(4, 3)
    assert METRES.met_by_rows(rows, rows).is_met
    assert METRES.met_by_rows(rows[:0], rows[:0]).is_met
    assert METRES.met_by_rows(rows, rows + np.array([[0], [1], [0], [1]])).error == 2
    assert METRES.met_by_rows(rows[:3], rows).error == 4
