"""The structs that kernels see are those that NumPy writes, byte for byte, on the device itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from terrain_lod.device import layout, sources
from terrain_lod.device.device import Device


@pytest.mark.parametrize("struct", layout.STRUCTS)
def test_struct_has_numpys_size_and_offsets(
    struct: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    dtype = layout.STRUCTS[struct]
    fields = dtype.names or ()
    stores = "".join(
        f"places[{index + 1}] = (int)((char *)&value.{field} - (char *)&value);\n"
        for index, field in enumerate(fields)
    )
    (tmp_path / f"{struct}_places.cl").write_text(
        f'#include "layout.h"\n'
        f"kernel void places(global int *places) {{ {struct} value;\n"
        f"if (get_global_id(0) == 0) {{ places[0] = sizeof(value);\n{stores}}} }}"
    )
    monkeypatch.setattr(sources, "KERNELS", tmp_path)
    device = Device.open()
    places = device.zeros(1 + len(fields), np.int32)
    device.kernel(f"{struct}_places.cl", "places")((1,), (1,), places=places)
    offsets = [dtype.fields[field][1] for field in fields] if dtype.fields else []
    assert places.host().tolist() == [dtype.itemsize, *offsets]


def test_struct_by_value_arrives_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "read_view.cl").write_text(
        '#include "layout.h"\n'
        "kernel void read_view(View view, global float *out) {\n"
        "int i = get_global_id(0);\n"
        "if (i < 3) out[i] = view.eye[i];\n"
        "if (i < 4 * FRUSTUM_PLANES) out[3 + i] = view.planes[i / 4][i % 4]; }"
    )
    monkeypatch.setattr(sources, "KERNELS", tmp_path)
    view = np.zeros((), layout.VIEW)
    view["eye"] = 1, 2, 3
    view["planes"] = np.arange(24).reshape(6, 4)
    device = Device.open()
    out = device.zeros(27, np.float32)
    device.kernel("read_view.cl", "read_view")((24,), (8,), view=view, out=out)
    assert out.host().tolist() == [1, 2, 3, *range(24)]


def test_header_defines_every_constant() -> None:
    lines = layout.header().splitlines()
    for name, value in layout.CONSTANTS.items():
        assert f"#define {name} {value}" in lines
