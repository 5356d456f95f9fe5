"""PLY files: whole or refused, in text and in binary."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from support.mesh_files import CUBE, ply
from terrain_lod.errors import FileError
from terrain_lod.files.meshes.loading import load_mesh

HEADER = """ply
format {form} 1.0
comment drawn
element vertex 4
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""


def binary_ply(faces, order="<"):
    """Return a binary PLY file of four vertices and these faces."""
    form = "binary_little_endian" if order == "<" else "binary_big_endian"
    body = np.arange(12).astype(order + "f4").tobytes()
    for face in faces:
        body += bytes([len(face)]) + np.array(face, order + "i4").tobytes()
    return HEADER.format(form=form, faces=len(faces)).encode() + body


def text_ply(faces):
    """Return a PLY file in text."""
    rows = ["0 0 0", "1 0 0", "0 1 0", "1 1 0"]
    rows += [" ".join(map(str, [len(face), *face])) for face in faces]
    return (HEADER.format(form="ascii", faces=len(faces)) + "\n".join(rows)).encode()


FACES = st.lists(st.lists(st.integers(0, 3), min_size=3, max_size=5), min_size=1, max_size=5)


@pytest.mark.slow
@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(faces=FACES, form=st.sampled_from(["<", ">", "text"]), data=st.data())
def test_a_ply_file_is_whole_or_refused_at_any_length(tmp_path, faces, form, data):
    content = text_ply(faces) if form == "text" else binary_ply(faces, form)
    path = tmp_path / "some.ply"
    path.write_bytes(content + data.draw(st.sampled_from([b"", b"\n", b"\nmore"])))
    assert load_mesh(path).triangles.shape == (sum(len(face) - 2 for face in faces), 3)
    length = data.draw(st.integers(0, len(content) - 1))
    if form == "text" and content[length - 1 : length + 1].isdigit():
        length -= 1  # inside a number
    path.write_bytes(content[:length])
    with pytest.raises(FileError, match=r"cannot read .*some\.ply: "):
        load_mesh(path)


@pytest.mark.parametrize(
    "header",
    [
        b"solid\n",
        b"ply\nformat binary_middle_endian 1.0\nend_header\n",
        b"ply\nformat ascii 1.0\nelement vertex many\nend_header\n",
        b"ply\nformat ascii 1.0\nproperty float x\nend_header\n",
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n",
    ],
)
def test_a_header_that_is_none_is_refused(tmp_path, header):
    path = tmp_path / "some.ply"
    path.write_bytes(header)
    with pytest.raises(FileError, match=r"cannot read .*: (it has no|its header|its vertices)"):
        load_mesh(path)


def test_mixed_polygons_of_a_binary_ply(tmp_path):
    path = tmp_path / "mixed.ply"
    path.write_bytes(binary_ply([(0, 1, 2), (0, 1, 3, 2)]))
    assert len(load_mesh(path).triangles) == 3


def test_rows_longer_than_the_header_says_lose_no_triangle(tmp_path, caplog):
    path = tmp_path / "long.ply"
    path.write_bytes(ply(CUBE, "ascii", row_end=" 1 2 3"))
    assert len(load_mesh(path).triangles) == 12
    assert "8 ends of rows of 'vertex', longer than the header says, 6 ends of rows" in caplog.text


def test_normals_textures_and_other_tables(tmp_path, caplog):
    path, names = tmp_path / "more.ply", ("x", "y", "z", "nx", "ny", "nz", "s", "t")
    path.write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\n"
        + "".join(f"property float {name}\n" for name in names)
        + "property list uchar int bones\n"
        "element face 1\nproperty list uchar uint vertex_index\n"
        "element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n"
        "0 0 0 0 0.6 0.8 0 0 2 8 9\n1 0 0 0 0.6 0.8 1 0 0\n0 1 0 0 0.6 0.8 0 1 1 8\n"
        "3 0 1 2\n0 1\n1 2\n"
    )
    mesh = load_mesh(path)
    np.testing.assert_allclose(mesh.normals, [(0, 0.6, 0.8)] * 3, atol=1e-7)
    assert mesh.textures.tolist() == [[0, 0], [1, 0], [0, 1]]
    assert "left out 2 rows of 'edge'" in caplog.text


def test_what_is_claimed_is_not_believed(tmp_path):
    path = tmp_path / "claim.ply"
    for form in ("ascii", "binary_little_endian"):
        for claim in (b"1000000000000", b"99999999999999999999999", b"-1"):
            content = ply(CUBE, form)
            path.write_bytes(content.replace(b"element face 6", b"element face " + claim))
            with pytest.raises(FileError, match="cannot read"):
                load_mesh(path)
    path.write_bytes(ply(CUBE, count="uint").replace(b"\4\0\0\0", b"\4\0\0\x7f", 1))
    with pytest.raises(FileError, match="it ends before its 6 rows of 'face'"):
        load_mesh(path)
