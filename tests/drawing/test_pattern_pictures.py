"""Pictures of patterns: rings, files that repeat, animations, the command."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from terrain_lod.cli.app import run
from terrain_lod.device.layout import FIXED_ONE, PARTITIONINGS
from terrain_lod.drawing.pattern_pictures import save_animation, save_pattern
from terrain_lod.drawing.pattern_rings import (
    edges_of_triangles,
    rings_of_points,
    strips_of_triangles,
)
from terrain_lod.errors import FileError, InputError
from terrain_lod.tessellation.factors import DOMAINS
from terrain_lod.tessellation.semi_uniform import semi_uniform
from terrain_lod.tessellation.tessellator import tessellate

EDGES, INSIDES = [[3, 5, 7.5, 9]], [[4.2, 6]]


def example():
    return tessellate("quad", EDGES, INSIDES)


def parts(pattern):
    return pattern.points.astype(np.int64), pattern.triangles.astype(np.intp)


# rings


@pytest.mark.parametrize(("inside", "counts"), [(5, [20, 12, 4]), (6, [24, 16, 8, 1])])
def test_rings_of_a_quad(inside, counts):
    pattern = tessellate("quad", [[inside] * 4], [[inside] * 2], partitioning="integer")
    assert np.bincount(rings_of_points("quad", parts(pattern)[0])).tolist() == counts


@pytest.mark.parametrize(("inside", "counts"), [(5, [15, 9, 3]), (6, [18, 12, 6, 1])])
def test_rings_of_a_triangle(inside, counts):
    pattern = tessellate("triangle", [[inside] * 3], [[inside]], partitioning="integer")
    assert np.bincount(rings_of_points("triangle", parts(pattern)[0])).tolist() == counts


@pytest.mark.parametrize(
    ("domain", "counts"), [("quad", [32, 16, 2]), ("triangle", [24, 12, 1])]
)  # fmt: skip
def test_strips_have_the_triangles_between_their_rings(domain, counts):
    edges, insides, _ = DOMAINS[domain]
    pattern = tessellate(domain, [[5] * edges], [[5] * insides], partitioning="integer")
    assert np.bincount(strips_of_triangles(domain, *parts(pattern))).tolist() == counts


@pytest.mark.parametrize("domain", ["quad", "triangle"])
@pytest.mark.parametrize("inside", [2, 3, 4.5, 7])
def test_rings_are_closed_and_each_edge_is_there_once(domain, inside):
    edges, insides, _ = DOMAINS[domain]
    pattern = tessellate(domain, [[3] * edges], [[inside] * insides])
    points, triangles = parts(pattern)
    strips = strips_of_triangles(domain, points, triangles)
    lines, on_ring = edges_of_triangles(points, triangles, strips)
    assert len(np.unique(lines, axis=0)) == len(lines)
    # as many edges of rings leave each point as come to it, one ring's
    used = np.bincount(lines[on_ring].ravel(), minlength=len(points))
    assert set(used.tolist()) <= {0, 2}
    # Euler: points - edges + triangles = 1, all points in use
    assert len(points) - len(lines) + len(triangles) == 1


# files


@pytest.mark.parametrize("ending", ["svg", "png", "pdf"])
def test_the_same_numbers_make_the_same_bytes(tmp_path, ending):
    first, second = (
        save_pattern(example(), tmp_path / f"{n}.{ending}", edge_factors=EDGES) for n in "ab"
    )
    assert first.read_bytes() == second.read_bytes()


def test_a_picture_shows_points_control_points_and_factors(tmp_path):
    path = save_pattern(example(), tmp_path / "a.svg", edge_factors=EDGES, inside_factors=INSIDES)
    text = path.read_text()
    said = re.findall(r"<text[^>]*>([^<]*)</text>", text)
    for label in ("u = 0:  3", "v = 0:  5", "u = 1:  7.5", "v = 1:  9", "quad, fractional odd"):
        assert label in said
    assert "inside 4.2, 6:  50 points, 72 triangles" in said
    # markers: 24 hollow points, 26 on the boundary, 4 control points
    assert text.count("<use ") == 24 + 26 + 4
    assert "Date" not in text


@pytest.mark.parametrize("domain", DOMAINS)
@pytest.mark.parametrize("partitioning", PARTITIONINGS)
def test_every_kind_of_pattern_can_be_drawn(tmp_path, domain, partitioning):
    edges, insides, _ = DOMAINS[domain]
    for factor in (0.0, 1.0, 4.5):
        inner = np.full((1, insides), factor) if insides else None
        pattern = tessellate(domain, np.full((1, edges), factor), inner, partitioning=partitioning)
        path = save_pattern(pattern, tmp_path / "a.png")
        ink = np.asarray(Image.open(path).convert("L")) < 100
        assert ink.any()


def test_semi_uniform_patterns_can_be_drawn(tmp_path):
    path = save_pattern(semi_uniform([[3, 1, 0]]), tmp_path / "a.svg", edge_factors=[[3, 1, 0]])
    assert "semi-uniform, levels" in path.read_text()


def sweep(frames, partitioning="fractional_odd"):
    factors = np.linspace(3, 5, frames)[:, None] * np.ones(4)
    return tessellate("quad", factors, factors[:, :2], partitioning=partitioning), factors


def test_an_animation_goes_there_and_back(tmp_path):
    pattern, factors = sweep(5)
    steps = []
    path = save_animation(
        pattern, tmp_path / "a.gif", edge_factors=factors,
        progress=lambda done, total: steps.append((done, total)),
    )  # fmt: skip
    assert steps == [(n, 5) for n in range(1, 6)]
    with Image.open(path) as movie:
        assert movie.n_frames == 5 + 3
        frames = []
        for number in range(movie.n_frames):
            movie.seek(number)
            frames.append(np.asarray(movie.convert("RGB")).astype(int))
    np.testing.assert_array_equal(frames[1], frames[7])
    assert (frames[0] != frames[4]).any()


@pytest.mark.parametrize(
    ("partitioning", "pops"), [("fractional_odd", False), ("fractional_even", False),
                               ("integer", True), ("pow2", True)],
)  # fmt: skip
def test_fractional_patterns_do_not_pop(partitioning, pops):
    # where an edge is divided: the largest way from a point to the nearest of the next factor
    factors = np.linspace(2, 9, 701)
    edges = np.stack([np.ones_like(factors), factors], axis=1)
    pattern = tessellate("isoline", edges, partitioning=partitioning)
    jump = 0.0
    for a, b, c in zip(*(pattern.point_offsets[k : k - 2 or None] for k in range(3)), strict=True):
        one, other = (pattern.points[s:e, 0].astype(float) for s, e in ((a, b), (b, c)))
        for here, there in ((one, other), (other, one)):
            nearest = np.abs(here[:, None] - there).min(axis=1).max()
            jump = max(jump, nearest / FIXED_ONE)
    assert (jump > 0.05) == pops
    assert pops or jump < 0.01


# what is refused


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda p: save_pattern(example(), p / "a.gif"), InputError, "one of .svg, .png, .pdf"),
        (lambda p: save_pattern(example(), p / "a.svg", patch=1), InputError, "from 0 to 0 for pa"),
        (lambda p: save_pattern(semi_uniform([]), p / "a.svg"), InputError, "at least one patch"),
        (lambda p: save_animation(semi_uniform([]), p / "a.gif"), InputError, "at least one patch"),
        (lambda p: save_animation(example(), p / "a.png"), InputError, "unknown animation format"),
        (lambda p: save_pattern(example(), p / "b" / "a.svg"), FileError, "expected a folder"),
        (
            lambda p: save_pattern(example(), p / "a.svg", edge_factors=[1, 2, 3, 4]),
            InputError,
            "factors of 1 patches to label",
        ),
    ],
)
def test_bad_input_is_refused_in_one_line(tmp_path, make, error, message):
    with pytest.raises(error, match=message) as caught:
        make(tmp_path)
    assert "\n" not in str(caught.value)


# the command


def test_the_command_draws_what_the_library_draws(tmp_path, capsys):
    factors = "--edge-factors 3,5,7.5,9 --inside-factors 4.2,6"
    command = f"pattern --domain quad --partitioning fractional_odd {factors}"
    assert run([*command.split(), "-o", str(tmp_path / "a.svg")]) == 0
    assert "50 points, 72 triangles" in capsys.readouterr().out
    save_pattern(example(), tmp_path / "b.svg", edge_factors=EDGES, inside_factors=INSIDES)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_the_command_animates(tmp_path):
    path = tmp_path / "a.gif"
    words = ["pattern", "--domain", "triangle", "--sweep", "1,4", "--frames", "3", "-o", str(path)]
    assert run(words) == 0
    with Image.open(path) as movie:
        assert movie.n_frames == 4


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--edge-factors 3,5 -o a.svg", "for --edge-factors of a quad, got (3.0, 5.0)"),
        ("--inside-factors 1,2,3 -o a.svg", "1 or 2 numbers for --inside-factors of a quad"),
        ("--domain isoline --inside-factors 3 -o a.svg", "no --inside-factors for isoline"),
        ("--domain isoline --partitioning semi_uniform -o a.svg", "--domain triangle or quad"),
        ("-o a.gif", "expected --sweep LOW,HIGH with a .gif"),
        ("-o a.bmp", "unknown picture format '.bmp'"),
        ("--sweep 1,4 -o a.svg", "unknown animation format '.svg'"),
        ("--sweep 1,4 --edge-factors 3 -o a.gif", "--edge-factors and --inside-factors, got both"),
        ("--sweep 1,4 --frames 1 -o a.gif", "whole number from 2 to 1000 for --frames, got 1"),
        ("--edge-factors three -o a.svg", "expected FACTOR[,FACTOR...], got 'three'"),
    ],
)
def test_the_command_refuses_in_one_line(words, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(["pattern", *words.split()]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.slow
def test_the_pictures_of_the_page_are_made_by_its_script(tmp_path):
    root = Path(__file__).parents[2]
    subprocess.run(
        [sys.executable, root / "docs" / "make_pictures.py", tmp_path, "--frames", "3"],
        check=True,
        capture_output=True,
    )
    pages = [
        (root / "docs" / f"{page}.md").read_text(encoding="utf-8")
        for page in ("tessellation", "hierarchy")
    ]
    shown = set(re.findall(r"(?:\(|figure} )pictures/([^)\s]*)", "".join(pages)))
    assert shown == {path.name for path in tmp_path.iterdir()}
    for name in shown:
        committed = root / "docs" / "pictures" / name
        assert committed.is_file(), f"run {root / 'examples' / 'tessellation_pictures.py'}"
