"""Formulas of any folder: what their headers find, when they are built again, what is refused."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import rough
from support.own_formulas import slope_lod, slope_reference, write_formulas
from terrain_lod.checks.terrain import check_lod
from terrain_lod.device.sources import KERNELS, kernel_source
from terrain_lod.terrain.lod import Scene

GROUND = rough(60, 50, spacing=(30.0, 20.0))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_formulas(tmp_path / "my own")
    return tmp_path / "my own"


def own(header: object, **numbers: float) -> tl.Lod:
    """Return a level of detail of a header, with whatever numbers."""

    @dataclass(frozen=True)
    class OwnLod(tl.Lod):
        needs_camera = False

        def parameters(self, scene: Scene) -> dict[str, float]:
            return numbers

    OwnLod.header = header  # type: ignore[assignment]
    return OwnLod()


def constant(path: Path, factor: str) -> Path:
    path.write_text(
        "inline float patch_lod(const Patch patch, const View view,\n"
        "                       __global const float *parameters)\n"
        f"{{\n    return {factor};\n}}\n"
    )
    return path


def test_a_header_of_any_folder_finds_files_beside_it_and_the_packages(folder: Path) -> None:
    assert check_lod(slope_lod(folder), slope_reference).is_met
    mesh = tl.Terrain(GROUND, levels=1).mesh(lod=slope_lod(folder))
    assert not tl.crack_report(mesh)


def test_what_is_beside_a_header_comes_before_what_has_its_name_in_the_package(
    folder: Path,
) -> None:
    (folder / "terrain").mkdir()
    (folder / "terrain" / "patch.h").write_text("int mine;\n")
    text = kernel_source("terrain/hull.cl", {"layout.h": ""}, {"LOD": folder / "slope.h"})
    # the package's own files do not see it
    assert text.index("typedef struct {\n    float3 midpoint;") < text.index("int mine;")


def test_an_edited_header_is_built_again_in_the_same_process(tmp_path: Path) -> None:
    terrain, lod = tl.Terrain(GROUND, levels=1), own(constant(tmp_path / "own.h", "3.0f"))
    three = terrain.mesh(lod=lod)
    np.testing.assert_array_equal(three.patches.inside_factors, 3)
    was = os.stat(tmp_path / "own.h")
    constant(tmp_path / "own.h", "5.0f")
    os.utime(tmp_path / "own.h", ns=(was.st_atime_ns, was.st_mtime_ns))  # by content, not by time
    assert terrain.mesh(lod=lod).patches.inside_factors.max() == 5
    constant(tmp_path / "own.h", "3.0f")
    np.testing.assert_array_equal(terrain.mesh(lod=lod).triangles, three.triangles)


def test_an_edited_header_that_another_includes_is_built_again(folder: Path) -> None:
    terrain, lod = tl.Terrain(GROUND, levels=1), slope_lod(folder)
    assert terrain.mesh(lod=lod).patches.inside_factors.max() > 2
    (folder / "degrees.h").write_text("inline float degrees_of(float a, float b) { return 0; }\n")
    np.testing.assert_array_equal(terrain.mesh(lod=lod).patches.inside_factors, 1)


def test_a_header_that_does_not_compile_is_named_with_its_line(tmp_path: Path) -> None:
    header = constant(tmp_path / "own.h", "no_such_number")
    with pytest.raises(tl.DeviceError) as caught:
        tl.Terrain(GROUND, levels=1).mesh(lod=own(header))
    assert f"{header.as_posix()}:4:" in str(caught.value)


def test_a_missing_include_is_named_with_who_wants_it(folder: Path) -> None:
    (folder / "degrees.h").unlink()
    asker = (folder / "slope.h").as_posix()
    with pytest.raises(tl.DeviceError, match=f"{asker}:3 wants kernels/degrees.h: there is no"):
        tl.Terrain(GROUND, levels=1).mesh(lod=slope_lod(folder))


@pytest.mark.parametrize(
    ("header", "numbers", "error", "message"),
    [
        (Path("none.h"), {}, tl.FileError, "expected a header at none.h, got no such file"),
        ("slope.h", {}, tl.InputError, "a header of kernels/ or a pathlib.Path to one, got 'slo"),
        ("", {}, tl.InputError, "got ''"),
        (None, {}, tl.InputError, "got None"),
        (str(KERNELS / "terrain/lod/uniform.h"), {}, tl.InputError, "pathlib.Path"),
        ("terrain/lod/uniform.h", {"factor": np.nan}, tl.InputError, "factor in parameters"),
        ("terrain/lod/uniform.h", {"factor": None}, tl.InputError, "factor in parameters"),
        ("terrain/lod/uniform.h", {"a-b": 1.0}, tl.InputError, "got 'LOD_A-B'"),
    ],
)
def test_what_is_no_formula_is_refused_in_one_line(header, numbers, error, message) -> None:
    with pytest.raises(error, match=message) as caught:
        tl.Terrain(GROUND, levels=1).mesh(lod=own(header, **numbers))
    assert "\n" not in str(caught.value)


def test_a_formula_without_numbers_or_answers_leaves_no_holes(tmp_path: Path) -> None:
    lod = own(constant(tmp_path / "own.h", "patch.midpoint.x > 700.0f ? NAN : -INFINITY"))
    mesh = tl.Terrain(GROUND, levels=1).mesh(lod=lod)
    np.testing.assert_array_equal(mesh.patches.inside_factors, 1)
    assert not tl.crack_report(mesh)


def test_the_packages_own_programs_are_not_read_again(monkeypatch: pytest.MonkeyPatch) -> None:
    tl.Terrain(GROUND, levels=1).mesh(lod=tl.UniformLod(3))
    monkeypatch.setattr("terrain_lod.device.device.kernel_source", None)
    tl.Terrain(GROUND, levels=1).mesh(lod=tl.UniformLod(3))
