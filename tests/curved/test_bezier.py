"""Bézier patches: the pot and its twin, exact shapes, watertight edges, collapsed edges, files."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from terrain_lod.curved.bezier import bezier
from terrain_lod.device.device import Device
from terrain_lod.device.layout import FIXED_ONE, PARTITIONINGS
from terrain_lod.errors import FileError, InputError
from terrain_lod.files.meshes.bpt import load_bpt, save_bpt
from terrain_lod.measure.cracks import crack_report
from terrain_lod.reference.curved import bezier as reference
from terrain_lod.tessellation.tessellator import tessellate

POT = Path(__file__).parents[2] / "examples" / "data" / "pot.bpt"


def points_of(patches, factor, partitioning="fractional_odd"):
    """Return patch, u and v of every vertex."""
    pattern = tessellate(
        "quad", np.full((patches, 4), factor), np.full((patches, 2), factor),
        partitioning=partitioning,
    )  # fmt: skip
    patch = np.repeat(np.arange(patches), np.diff(pattern.point_offsets))
    return patch, *(pattern.points / FIXED_ONE).T


def flat_net():
    """Return a patch that is the plane z = 0 with u, v for x, y."""
    thirds = np.arange(4) / 3
    x, y = np.meshgrid(thirds, thirds, indexing="ij")
    return np.stack([x, y, np.zeros_like(x)], axis=-1)


def agree(nets, factor=6.3):
    mesh = bezier(nets, factor=factor)
    patch, u, v = points_of(len(nets), factor)
    positions, normals = reference.bezier(np.asarray(nets, np.float32)[patch].astype(float), u, v)
    size = np.abs(nets).max()
    np.testing.assert_allclose(mesh.vertices, positions, atol=1e-6 * size)
    np.testing.assert_allclose(mesh.normals, normals, atol=1e-4)
    return mesh


def test_the_pot_is_its_twin():
    agree(load_bpt(POT))


@pytest.mark.parametrize("partitioning", PARTITIONINGS)
@pytest.mark.parametrize("factor", [1, 3.7, 8])
def test_a_flat_patch_is_exact(factor, partitioning):
    mesh = bezier([flat_net()], factor=factor, partitioning=partitioning)
    _, u, v = points_of(1, factor, partitioning)
    np.testing.assert_allclose(mesh.vertices, np.stack([u, v, 0 * u], axis=1), atol=1e-7)
    np.testing.assert_allclose(mesh.normals, np.tile([0, 0, 1], (len(u), 1)), atol=1e-6)
    corners = mesh.vertices[mesh.triangles].astype(float)
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    assert (facing >= 0).all()
    assert facing.sum() / 2 == pytest.approx(1)


@pytest.mark.parametrize("partitioning", PARTITIONINGS)
@pytest.mark.parametrize("factor", [1, 2.3, 5, 11.9, 64])
def test_the_pot_is_watertight_and_faces_outwards(factor, partitioning):
    mesh = bezier(POT, factor=factor, partitioning=partitioning)
    report = crack_report(mesh, closed=True)
    assert not report, report
    corners = mesh.vertices[mesh.triangles].astype(float)
    assert np.linalg.det(corners).sum() / 6 > 1.5  # its volume


def test_a_group_of_work_items_makes_what_one_makes(monkeypatch):
    alone = bezier(POT, factor=7.3)
    monkeypatch.setattr(Device, "group_size", lambda self, wanted=64: wanted)
    together = bezier(POT, factor=7.3)
    np.testing.assert_array_equal(together.vertices, alone.vertices)
    np.testing.assert_array_equal(together.normals, alone.normals)


def test_the_pots_poles_have_the_axis_for_normal():
    mesh = bezier(POT, factor=7)
    on_axis = (mesh.vertices[:, :2] == 0).all(axis=1)
    at_top = mesh.vertices[:, 2] > 1
    assert np.count_nonzero(on_axis) == 2 * 4 * 8
    expected = np.where(at_top[on_axis], 1, -1)[:, None] * [0, 0, 1]
    np.testing.assert_allclose(mesh.normals[on_axis], expected, atol=1e-6)


# an edge shared by two patches, in any direction and along u or v


def turned(net, turn, mirrored):
    net = np.rot90(net, turn, axes=(0, 1))
    return net[::-1] if mirrored else net


@given(st.integers(0, 3), st.booleans(), st.integers(0, 10**6), st.floats(1, 12))
@settings(deadline=None, max_examples=60)
def test_shared_edges_have_the_same_bits(turn, mirrored, seed, factor):
    random = np.random.default_rng(seed)
    one = random.normal(size=(4, 4, 3)) * 10.0 ** random.integers(-3, 4, 3) + 1000
    other = random.normal(size=(4, 4, 3))
    other[0] = one[-1]
    mesh = bezier([one, turned(other, turn, mirrored)], factor=factor)
    patch, u, _ = points_of(2, factor)
    edge = {tuple(p) for p in mesh.vertices[(patch == 0) & (u == 1)].tolist()}
    beyond = {tuple(p) for p in mesh.vertices[patch == 1].tolist()}
    assert edge <= beyond


# collapsed patches


def sphere_octant():
    """Return a patch with a collapsed edge v = 1 at the pole, near the unit sphere."""
    k = 4 / 3 * (np.sqrt(2) - 1)
    circle = np.array([[1, 0], [1, k], [k, 1], [0, 1]])
    return np.array([[[x * r, y * r, z] for r, z in circle] for x, y in circle])


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_collapsed_edge_has_the_limit_of_its_normals(turn, mirrored):
    mesh = bezier([turned(sphere_octant(), turn, mirrored)], factor=9)
    sign = -1 if mirrored else 1
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)
    np.testing.assert_allclose(mesh.normals, sign * mesh.vertices, atol=2e-3)
    pole = mesh.vertices[:, 2] == 1
    assert np.count_nonzero(pole) == 10
    np.testing.assert_allclose(mesh.normals[pole], np.tile([0, 0, sign], (10, 1)), atol=1e-6)


def test_a_corner_whose_edges_leave_in_one_direction_has_a_normal():
    net = flat_net()
    net[0, 1] = net[1, 0]  # both derivatives at (0, 0) point the same way
    mesh = agree([net])
    np.testing.assert_allclose(mesh.normals, np.tile([0, 0, 1], (len(mesh.normals), 1)), atol=1e-6)


def test_a_cusp_has_the_normal_of_its_neighbourhood():
    net = flat_net()
    net[:2] = net[:, :2] = net[0, 0]  # more in one point than first derivatives can tell
    mesh = bezier([net[..., [2, 0, 1]]], factor=5)  # upright: not the normal of last resort
    np.testing.assert_allclose(mesh.normals, np.tile([1, 0, 0], (len(mesh.normals), 1)), atol=1e-5)


@pytest.mark.parametrize("net", [np.zeros((4, 4, 3)), np.ones((4, 4, 3)) * 7])
def test_a_patch_without_any_area_has_unit_normals(net):
    mesh = bezier([net], factor=3)
    np.testing.assert_array_equal(mesh.normals, np.tile([0, 0, 1], (len(mesh.normals), 1)))


@pytest.mark.parametrize("scale", [1e-12, 1e-3, 1e15])
def test_size_does_not_matter(scale):
    mesh, scaled = (bezier(load_bpt(POT) * s, factor=5) for s in (1, scale))
    np.testing.assert_allclose(scaled.normals, mesh.normals, atol=1e-5)


# files and input


def test_the_pot_is_what_its_script_writes(tmp_path, monkeypatch):
    script = runpy.run_path(str(POT.with_name("make_pot.py")))
    nets = [patch for curve in script["PROFILE"] for patch in script["quarters"](curve)]
    written = save_bpt(nets, tmp_path / "pot.bpt")
    assert written.read_text() == POT.read_text()


def test_a_file_comes_back_as_it_went(tmp_path):
    nets = np.random.default_rng(0).normal(size=(3, 4, 4, 3)).astype(np.float32)
    path = save_bpt(nets.reshape(3, 16, 3), tmp_path / "a.bpt")
    np.testing.assert_array_equal(load_bpt(path).astype(np.float32), nets)
    spaced = path.read_text().replace("\n", "\r\n\n  ")
    path.write_text(spaced)
    np.testing.assert_array_equal(load_bpt(path).astype(np.float32), nets)


def test_no_patches_make_an_empty_mesh(tmp_path):
    assert len(bezier(np.empty((0, 4, 4, 3))).triangles) == 0
    assert len(bezier(save_bpt(np.empty((0, 16, 3)), tmp_path / "none.bpt")).triangles) == 0


GOOD = "1\n3 3\n" + "0 0 0\n" * 16


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: expected the number of patches, got the end of the file"),
        ("two\n", "line 1: expected the number of patches, got 'two'"),
        ("-1\n", "line 1: expected the number of patches, got -1"),
        ("1\n2 3\n", "line 2: expected a bicubic patch, 3 3, got 2 3"),
        (GOOD.replace("0 0 0", "0 0", 1), "line 3: expected a control point x y z, got '0 0'"),
        (GOOD.replace("0 0 0", "0 0 nan", 1), "line 3: expected a control point x y z, got '0 0 n"),
        (GOOD[:-6], "line 18: expected a control point x y z, got the end of the file"),
        (GOOD + "3 3\n", "line 19: expected the end after 1 patches, got '3 3'"),
    ],
)
def test_a_bad_file_is_refused_in_one_line(tmp_path, text, message):
    path = tmp_path / "bad.bpt"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_bpt(path)
    assert str(caught.value).startswith(f"{path} {message}")
    assert "\n" not in str(caught.value)


def test_no_file_and_no_text_are_refused(tmp_path):
    with pytest.raises(FileError, match=r"cannot read .*: No such file"):
        bezier(tmp_path / "none.bpt")
    (tmp_path / "binary.bpt").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FileError, match="it is no text"):
        load_bpt(tmp_path / "binary.bpt")


@pytest.mark.parametrize(
    ("nets", "options", "message"),
    [
        (np.zeros((2, 5, 4, 3)), {}, r"got shape \(2, 5, 4, 3\)"),
        (np.zeros((4, 4, 3)), {}, r"patches \(P, 4, 4, 3\)"),
        ([[1, 2], [3]], {}, "patches as real numbers"),
        (np.full((2, 16, 3), np.nan), {}, r"finite patches, got nan at \[0, 0, 0\]"),
        (np.full((1, 16, 3), 1e39), {}, "control points that float32 can hold, got 1e"),
        (np.zeros((1, 16, 3)), {"factor": 0}, "factor > 0, got 0"),
        (np.zeros((1, 16, 3)), {"factor": np.nan}, "finite factor"),
        (np.zeros((1, 16, 3)), {"partitioning": "odd"}, "unknown partitioning 'odd': expected one"),
    ],
)
def test_bad_input_is_refused_in_one_line(nets, options, message):
    with pytest.raises(InputError, match=message) as caught:
        bezier(nets, **options)
    assert "\n" not in str(caught.value)
