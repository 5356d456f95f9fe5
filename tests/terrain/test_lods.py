"""The table of levels of detail: all that is made from it, and what is no level of detail."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import MISSING, fields
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.curved_meshes import cube
from support.grounds import rough
from support.own_formulas import write_formulas
from terrain_lod.device.sources import KERNELS
from terrain_lod.drawing.flyover import render_path
from terrain_lod.numbered import begin, numbers_of, summary_of
from terrain_lod.reference.terrain.lod import FORMULAS
from terrain_lod.reports.compare.sweep import swept_of
from terrain_lod.reports.report import report
from terrain_lod.terrain.lods import LODS, name_of

GROUND = rough(60, 50, spacing=(30.0, 20.0))
CAMERA = tl.default_camera(GROUND)

# adds a level of detail as a change to the package would, and looks for it wherever users do
ADDED = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from mine import SlopeLod
from terrain_lod.terrain.lods import LODS
LODS["slope"] = SlopeLod

from terrain_lod.cli.app import run
run(["mesh", "--help"])
import terrain_lod as tl
from terrain_lod.viewer.terrain_settings import TerrainSettings
settings = TerrainSettings(diagonal=100.0).changed("lod", "slope").changed("segments", 5)
print("VIEWER", settings.detail(), [each.name for each in settings.sliders][0])
from terrain_lod.reports.compare.sweep import contenders
tried = contenders(tl.sample("ridge"), 15)
print("COMPARED", sorted({each.label for each in tried if each.family == "SlopeLod"}))
"""


def test_a_row_is_all_that_a_level_of_detail_needs(tmp_path: Path) -> None:
    write_formulas(tmp_path)
    child = subprocess.run(
        [sys.executable, "-c", ADDED, str(tmp_path)],
        capture_output=True,
        text=True,
        env={"COLUMNS": "300"},
    )
    assert child.returncode == 0, child.stderr
    assert "slope: the steeper, the more." in child.stdout
    assert "--segments FLOAT" in child.stdout
    assert "Of slope: of a steep tile, more, segments; default 8." in child.stdout
    assert "VIEWER SlopeLod(segments=5.0) segments" in child.stdout
    assert "COMPARED ['Slope 10 segments, min'" in child.stdout


def test_every_formula_has_its_header_its_reference_and_its_row() -> None:
    formulas = [kind for kind in LODS.values() if issubclass(kind, tl.Lod)]
    headers = {f"terrain/lod/{path.name}" for path in (KERNELS / "terrain" / "lod").iterdir()}
    assert {kind.header for kind in formulas} == headers == set(FORMULAS)
    public = {
        kind
        for kind in (getattr(tl, name) for name in tl.__all__)
        if isinstance(kind, type) and issubclass(kind, tl.Lod | tl.PromiseLod)
    }
    assert set(LODS.values()) == public - {tl.Lod, tl.PromiseLod}


@pytest.mark.parametrize("name", LODS)
def test_a_row_says_what_people_are_told(name: str) -> None:
    kind = LODS[name]
    assert len(summary_of(kind)) > 10
    for number in numbers_of(kind).values():
        assert number.help
    # a viewer and a comparison can begin with it
    assert name_of(begin(kind, 1000.0, 7)) == name
    assert swept_of(kind)[0] in numbers_of(kind)
    readme = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    assert f"`{kind.__name__}" in readme
    assert f"`{name}" in readme


NONE = (
    5,
    0,
    "screen-error",
    tl.UniformLod,
    tl.curved.UniformFactor(3),
    object,
    GROUND,
    [tl.UniformLod(1)],
)


@pytest.mark.parametrize("value", NONE, ids=str)
def test_what_is_no_level_of_detail_is_refused_in_one_line(value: object, tmp_path: Path) -> None:
    terrain = tl.Terrain(GROUND)
    for take in (
        lambda: terrain.mesh(CAMERA, lod=value),
        lambda: tl.Weighted(value),
        lambda: report(GROUND, tmp_path / "out", lod=value),
        lambda: render_path(terrain, [CAMERA], tmp_path / "out", lods=[value]),
    ):
        with pytest.raises(tl.InputError, match="expected a level of detail") as caught:
            take()
        assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("value", [5, "length", tl.UniformLod(3), tl.curved.UniformFactor], ids=str)
def test_what_is_no_formula_for_edges_is_refused_in_one_line(value: object) -> None:
    mesh = cube()
    textures = np.zeros((len(mesh.vertices), 2))
    image = np.zeros((4, 4), np.float32)
    for take in (
        lambda: tl.pn_triangles(mesh, lod=value),
        lambda: tl.displace(mesh, image, textures, lod=value),
    ):
        with pytest.raises(tl.InputError, match="expected a formula for edges") as caught:
            take()
        assert "\n" not in str(caught.value)


def test_a_class_is_told_from_what_it_makes() -> None:
    with pytest.raises(
        tl.InputError, match=r"got its class UniformLod: write UniformLod\(\.\.\.\)"
    ):
        tl.Terrain(GROUND).mesh(lod=tl.UniformLod)


def test_weights_are_not_weighed() -> None:
    with pytest.raises(tl.InputError, match="without weights to weigh"):
        tl.Weighted(tl.Weighted(tl.UniformLod(3)))


@pytest.mark.parametrize(
    "kind", [*LODS.values(), tl.curved.LengthFactor, tl.curved.CurvatureFactor], ids=str
)
@pytest.mark.parametrize("value", ["1", b"1", np.nan, np.inf, [], print, -1, 1j], ids=repr)
def test_no_number_is_taken_that_is_none(kind, value) -> None:
    required = [each.name for each in fields(kind) if each.default is MISSING]
    for name in numbers_of(kind):
        numbers = {**dict.fromkeys(required, 1), name: value}
        with pytest.raises(tl.InputError, match=name) as caught:
            kind(**numbers)
        assert "\n" not in str(caught.value)


def test_numbers_are_kept_as_numbers() -> None:
    lod = tl.DistanceLod(near=np.float32(1), maximum=np.int64(7))
    assert repr(lod) == "DistanceLod(near=1.0, far=None, minimum=1.0, maximum=7.0, falloff=1.0)"
    assert repr(tl.BudgetLod(np.int64(9))) == "BudgetLod(triangles=9, pixels=0.0, metres=0.0)"


@pytest.mark.parametrize("factor", [tl.UniformLod(3), "5", [["a"] * 3] * 12, print], ids=repr)
def test_a_factor_is_a_number_or_one_an_edge(factor: object) -> None:
    with pytest.raises(tl.InputError, match="factor") as caught:
        tl.pn_triangles(cube(), factor)
    assert "\n" not in str(caught.value)
