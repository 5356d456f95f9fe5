"""A group of items, as on a GPU, finds the errors of a lattice that one item finds by rows."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from support.grounds import rough
from terrain_lod.device import sources
from terrain_lod.device.device import Device
from terrain_lod.ground.relief import Relief
from terrain_lod.terrain.buffers import DeviceGround, lattice_levels

# All tiles at every pair of factors, wholly and within their inner lines. PoCL's compiler does not
# survive groups here, so the group is one item; what it is asked for is that of any.
BOTH = """
#include "terrain/lattice.h"

inline float of_rows(const Lattice *lattice, int fu, int fv, Asked columns, Asked rows, int2 *worst)
{
    return largest_error(lattice, fu, fv, columns, rows, INFINITY, worst);
}
#define largest_error of_group
#include "terrain/lattice_of_groups.h"

__kernel void both(const Grid grid, __global const float *heights, __global const uchar *holes,
                   __global const float *detail_heights, const int tiles,
                   __global float2 *errors)      // (tiles, 2, TILE, TILE)
{
    __local float samples[WIDTH * PITCH], scratch[GROUP + 1];
    const Ground ground = {grid, heights, holes, detail_heights};
    for (int i = 0; i < tiles; ++i) {
        const Tile tile = tile_at(grid, i);
        const Lattice lattice = lattice_of(tile, 1, samples, scratch);
        read_lattice(ground, tile, &lattice);
        for (int k = 0; k < 2 * TILE * TILE; ++k) {
            const int fu = k % TILE + 1, fv = k / TILE % TILE + 1, least = k < TILE * TILE ? 1 : 2;
            float2 found = (float2)(-1.0f);
            if (fu >= least && fv >= least && fu <= tile.cells_across && fv <= tile.cells_down) {
                const Asked columns = asked_samples(fu, tile.cells_across, 1, least == 2);
                const Asked rows = asked_samples(fv, tile.cells_down, 1, least == 2);
                int2 worst = (int2)(0);
                found.x = of_rows(&lattice, fu, fv, columns, rows, &worst);
                found.y = of_group(&lattice, fu, fv, columns, rows, INFINITY, &worst);
            }
            errors[i * 2 * TILE * TILE + k] = found;
        }
    }
}
"""


@pytest.mark.parametrize("tile", [4, 5, 7, 8])
def test_groups_and_rows_find_the_same_errors(
    tile: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(str(sources.KERNELS), tmp_path / "kernels")
    (tmp_path / "kernels" / "both.cl").write_text(BOTH)
    # a header is included once
    group = (tmp_path / "kernels/terrain/lattice_group.h").read_text()
    again = group.replace("LATTICE_GROUP_H", "LATTICE_OF_GROUPS_H")
    (tmp_path / "kernels/terrain/lattice_of_groups.h").write_text(again)
    monkeypatch.setattr(sources, "KERNELS", tmp_path / "kernels")
    # the last tiles have fewer cells, even and odd numbers of them
    relief = Relief(rough(2 * tile + 2, 3 * tile))
    device = Device.open()
    ground = DeviceGround.upload(relief, tile, device)
    errors = device.empty((ground.grid.count, 2, tile, tile, 2), np.float32)
    kernel = device.kernel(
        "both.cl", "both", TILE=tile, FINER=lattice_levels(tile), GROUP=1, **ground.defines
    )
    kernel((1,), (1,), **ground.arguments, tiles=ground.grid.count, errors=errors)
    rows, group = np.moveaxis(errors.host(), -1, 0)
    np.testing.assert_array_equal(rows, group)
    assert rows[:, 0].max() > 0
    assert rows[:, 1].max() > 0
