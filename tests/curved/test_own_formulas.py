"""Factors of edges, surfaces and curves whose headers are the user's own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.curved_meshes import torus
from support.own_formulas import write_formulas
from terrain_lod.checks.curved import check_shape
from terrain_lod.checks.curved_pn import check_factor

EGG = """\
#include "curved/parameter.h"

inline Place surface(Parameter u, Parameter v, __global const float *shape)
{
    const float2 around = turns(u, 1), up = circle(v, 1);
    const float r = shape[RADIUS], h = shape[HEIGHT];
    Place place;
    place.position = (float3)(r * up.y * around, -h * up.x);
    place.normal = (float3)(h * up.y * around, -r * up.x);
    return place;
}
"""
LINE = """\
inline Bead curve(Parameter t, __global const float *shape)
{
    Bead bead;
    bead.position = (float3)(shape[LENGTH] * fraction(t), 0.0f, 0.0f);
    bead.tangent = (float3)(1.0f, 0.0f, 0.0f);
    return bead;
}
"""


@pytest.fixture
def egg(tmp_path: Path) -> tl.curved.ParametricSurface:
    (tmp_path / "egg.h").write_text(EGG)
    numbers = {"radius": tl.Number(1.0), "height": tl.Number(1.4, low=0.5, high=3.0)}
    return tl.curved.ParametricSurface(tmp_path / "egg.h", numbers, closed="u")


def egg_reference(u, v, n):
    angle, up = 2 * np.pi * u, np.pi * v
    ring = n["radius"] * np.sin(up)
    return ring * np.cos(angle), ring * np.sin(angle), -n["height"] * np.cos(up)


def test_a_surface_of_ones_own_is_its_reference_and_closed(egg) -> None:
    assert check_shape(egg, egg_reference).is_met
    mesh = tl.curved.surface(egg, patches=(8, 4), factor=3, height=2.0)
    assert np.ptp(mesh.vertices[:, 2]) == pytest.approx(4.0)
    assert not tl.crack_report(mesh)


def test_a_wrong_reference_is_found_out(egg) -> None:
    wrong = check_shape(egg, lambda u, v, n: egg_reference(u, v, {**n, "height": 1.41}))
    assert not wrong.is_met


def test_a_curve_of_ones_own(tmp_path: Path) -> None:
    (tmp_path / "line.h").write_text(LINE)
    line = tl.curved.ParametricCurve(tmp_path / "line.h", {"length": tl.Number(2.0)})
    made = tl.curved.curve(line, pieces=2, factor=4, partitioning="integer", length=8.0)
    np.testing.assert_allclose(made.points[:, 0], np.arange(9))
    assert not made.closed


def test_a_factor_of_ones_own_is_its_reference(tmp_path: Path) -> None:
    write_formulas(tmp_path)

    @dataclass(frozen=True)
    class TiltFactor(tl.curved.EdgeFactor):
        most: float = 9.0
        header = tmp_path / "tilt.h"
        needs_camera = False

    def tilt(edge, view, parameters):
        return 1 + (parameters["most"] - 1) * abs(edge.ends[1] - edge.ends[0])[2] / edge.length

    assert check_factor(TiltFactor(), tilt).is_met
    made = tl.pn_triangles(torus(), lod=TiltFactor(most=5))
    assert len(made.triangles) > len(torus().triangles)
    assert not tl.crack_report(made)


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (
            lambda egg: tl.curved.surface(5),
            tl.InputError,
            "surface's name or a ParametricSurface, got 5",
        ),
        (
            lambda egg: tl.curved.surface(egg.header),
            tl.InputError,
            "surface's name or a Parametric",
        ),
        (
            lambda egg: tl.curved.surface(egg, tube=1),
            tl.InputError,
            "unknown tube= for egg: expected rad",
        ),
        (
            lambda egg: tl.curved.surface(egg, height=4),
            tl.InputError,
            "height from 0.5 to 3, got 4",
        ),
        (
            lambda egg: tl.curved.ParametricSurface(egg.header, {}, closed="w"),
            tl.InputError,
            "closed to be '', 'u', 'v' or 'uv', got 'w'",
        ),
        (
            lambda egg: tl.curved.ParametricSurface(egg.header, {}, twisted=True),
            tl.InputError,
            "twisted surface to be closed in u",
        ),
        (
            lambda egg: tl.curved.ParametricSurface(egg.header, {"factor": tl.Number(1.0)}),
            tl.InputError,
            "factor is taken",
        ),
        (
            lambda egg: tl.curved.surface(tl.curved.ParametricSurface(Path("no.h"), {})),
            tl.FileError,
            "expected a header at no.h",
        ),
        (lambda egg: tl.curved.curve(5), tl.InputError, "curve's name or a ParametricCurve, got 5"),
    ],
)
def test_bad_shapes_are_refused_in_one_line(egg, make, error, message) -> None:
    with pytest.raises(error, match=message) as caught:
        make(egg)
    assert "\n" not in str(caught.value)
