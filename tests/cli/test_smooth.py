"""``terrain-lod smooth``: five meshes in, closed curved ones out; one line for what is wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista
from pyvista import examples

from support.curved_meshes import chamfered_cube, cone, torus
from terrain_lod.cli.app import REFUSED, run
from terrain_lod.files.meshes.loading import load_mesh
from terrain_lod.measure.cracks import crack_report


@pytest.fixture
def meshes(tmp_path: Path) -> dict[str, Path]:
    """Return five closed meshes of several formats."""
    for mesh, name in ((torus(), "torus.obj"), (cone(), "cone.vtp"), (chamfered_cube(), "c.glb")):
        mesh.save(tmp_path / name)
    # polygons with shared vertices, and no normals
    box = pyvista.Cube().clean()
    box.clear_data()
    box.save(tmp_path / "cube.vtk")
    return {
        "ant.ply": Path(examples.antfile),
        "nut.ply": Path(examples.nutfile),
        **{name: tmp_path / name for name in ("torus.obj", "cone.vtp", "c.glb", "cube.vtk")},
    }


@pytest.mark.parametrize(
    "options", [[], ["--lod", "silhouette", "--sharp"], ["--lod", "distance"]], ids=str
)
@pytest.mark.parametrize(
    "name", ["ant.ply", "nut.ply", "torus.obj", "cone.vtp", "c.glb", "cube.vtk"]
)
def test_meshes_become_closed_curved_ones(
    meshes: dict[str, Path], name: str, options: list[str], tmp_path: Path, capsys
) -> None:
    output = tmp_path / "smooth.glb"
    assert run(["smooth", str(meshes[name]), "-o", str(output), *options]) == 0
    said = capsys.readouterr().out
    assert "after: watertight" in said
    smooth, source = load_mesh(output), load_mesh(meshes[name])
    assert not crack_report(smooth, closed=True)
    assert len(smooth.triangles) > 2 * len(source.triangles)
    assert f"{len(smooth.triangles):,} triangles from {len(source.triangles):,}" in said


def test_what_was_done_to_the_mesh_is_said(meshes: dict[str, Path], tmp_path: Path, capsys) -> None:
    output = str(tmp_path / "smooth.ply")
    assert run(["smooth", str(meshes["cube.vtk"]), "-o", output, "--factor", "3"]) == 0
    noted = capsys.readouterr().err
    assert "polygons cut into 12 triangles" in noted
    assert "normals computed" in noted
    assert run(["-q", "smooth", str(meshes["cube.vtk"]), "-o", output]) == 0
    assert capsys.readouterr() == ("", "")


def test_sharp_keeps_the_cube(meshes: dict[str, Path], tmp_path: Path) -> None:
    output = tmp_path / "smooth.glb"
    assert run(["smooth", str(meshes["cube.vtk"]), "-o", str(output), "--sharp"]) == 0
    assert (abs(load_mesh(output).vertices).max(axis=1) == 0.5).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["cube.vtk", "--factor", "0.5"], "factor from 1 to 64, got 0.5"),
        (["nothing.ply"], "got none at"),
        (["empty.ply"], "triangles"),
        (["outside.ply"], "among its 3 vertices"),
        (["nan.ply"], "finite positions"),
        (["cube.vtk", "--pixels", "4"], "--lod length or curvature with --pixels"),
        (["cube.vtk", "--sharp", "--crease", "200"], "0 to 180"),
        (["cube.vtk", "--crease", "20"], "expected --sharp with --crease"),
        (["cube.vtk", "--lod", "length", "--eye", "1,1,1", "--target", "1,1,1"], "away from"),
        (["cube.vtk", "--eye", "1,1,1"], "a --lod that looks through --eye, got uniform"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(
    meshes: dict[str, Path], arguments: list[str], message: str, tmp_path: Path, capsys
) -> None:
    head = "ply\nformat ascii 1.0\nelement vertex 3\n" + "".join(
        f"property float {axis}\n" for axis in "xyz"
    )
    faces = "element face {}\nproperty list uchar int vertex_indices\nend_header\n"
    points = "0 0 0\n1 0 0\n0 1 0\n"
    for name, text in (
        ("empty", head + faces.format(0) + points),
        ("outside", head + faces.format(1) + points + "3 0 1 7\n"),
        ("nan", head + faces.format(1) + points.replace("1 0 0", "1 nan 0") + "3 0 1 2\n"),
    ):
        (tmp_path / f"{name}.ply").write_text(text)
    output = tmp_path / "smooth.glb"
    file, *options = arguments
    assert run(["smooth", str(tmp_path / file), "-o", str(output), *options]) == REFUSED
    error = capsys.readouterr().err.strip().splitlines()
    assert message in error[-1]
    assert not any("into 0 triangles" in line for line in error)
    assert sum("expected" in line for line in error) == 1
    assert not output.exists()


def test_an_unknown_ending_is_refused_before_any_work(meshes: dict[str, Path], tmp_path, capsys):
    assert run(["smooth", str(meshes["ant.ply"]), "-o", str(tmp_path / "a.fbx")]) == REFUSED
    assert "unknown mesh format" in capsys.readouterr().err
    assert np.all([not path.name.startswith("a.") for path in tmp_path.iterdir()])
