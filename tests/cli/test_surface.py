"""``terrain-lod surface``: a mesh or a picture, and one line for what is wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from terrain_lod.cli.app import REFUSED, run
from terrain_lod.files.meshes.loading import load_mesh


def test_a_torus_is_written_with_its_numbers(tmp_path: Path) -> None:
    output = tmp_path / "torus.glb"
    options = ["--factor", "9", "--patches", "6x3", "--numbers", "radius=3,tube=1"]
    assert run(["surface", "torus", "-o", str(output), *options]) == 0
    mesh = load_mesh(output)
    assert len(mesh.triangles) == 6 * 3 * 9 * 9 * 2
    assert np.linalg.norm(mesh.vertices, axis=1).max() == pytest.approx(4, rel=1e-5)


def test_a_picture_shows_the_surface(tmp_path: Path) -> None:
    output = tmp_path / "torus.png"
    assert run(["surface", "torus", "-o", str(output), "--size", "160x120"]) == 0
    picture = np.asarray(Image.open(output))
    assert picture.shape == (120, 160, 3)
    assert 0.1 < (picture != picture[0, 0]).any(axis=2).mean() < 0.9


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["cube"], "sphere"),
        (["torus", "--numbers", "radius=wide"], "such as radius=2,tube=0.3"),
        (["torus", "--numbers", "width=2"], "width"),
        (["torus", "--numbers", "factor=2"], "expected --factor"),
        (["torus", "--eye", "1,2,3"], "expected a picture"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(
    arguments: list[str], message: str, tmp_path: Path, capsys
) -> None:
    output = tmp_path / "out.glb"
    assert run(["surface", *arguments, "-o", str(output)]) == REFUSED
    (error,) = capsys.readouterr().err.strip().splitlines()
    assert message in error
    assert not output.exists()
