"""What cannot be tiled is said in one line, and nothing is written; what was cut off goes on."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.tilesets import contents, jacksboro
from terrain_lod.cli.app import REFUSED, run


def ground_at(lon, lat, crs="EPSG:4326", step=0.001):
    heights = np.add.outer(np.arange(20.0), np.arange(20.0))
    return tl.Heightmap(heights, spacing=step, origin=(lon, lat), crs=crs)


@pytest.mark.parametrize(
    ("ground", "options", "line"),
    [
        (tl.sample("ridge"), {}, "none with a CRS: name it with crs="),
        (ground_at(0, 89.95), {}, "tiles meet in one point at a pole"),
        (ground_at(179.99, 10), {}, "does not cross the 180th meridian"),
        (ground_at(10, 86), {"scheme": "mercator"}, "choose geographic tiles"),
        (ground_at(10, 86), {"format": "terrarium"}, "from latitude -85"),
        (ground_at(10, 40, "EPSG:999999"), {}, "a CRS that PROJ knows"),
        (ground_at(10, 40), {"zoom": 40}, "a whole number from 0 to 22 for zoom"),
        (ground_at(10, 40, step=1.0), {"zoom": 22}, "choose a lower zoom"),
        (ground_at(10, 40), {"format": "gltf"}, "unknown format 'gltf'"),
        (ground_at(10, 40), {"error": 0}, "expected error > 0"),
        (ground_at(10, 40), {"error": 1e-4}, "3dtiles have more"),
        (ground_at(10, 40), {"borders": "frozen"}, "3dtiles have frozen ones"),
        (
            ground_at(10, 40),
            {"format": "3dtiles", "borders": "frozen", "zoom": 20},
            "a zoom up to 16 with frozen borders",
        ),
        (ground_at(10, 40), {"borders": "walls"}, "unknown borders"),
        (ground_at(10, 40), {"tiling": "implicit"}, "tiling with 3dtiles alone"),
        (ground_at(10, 40), {"format": "mapbox", "error": 3}, "an error with quantized-mesh"),
        (ground_at(10, 40), {"geoid": "egm1"}, "or a grid's file, for geoid"),
    ],
)
def test_one_line_and_nothing_written(ground, options, line, tmp_path):
    with pytest.raises(tl.InputError) as refusal:
        tl.write_tiles(ground, tmp_path / "tiles", **options)
    assert line in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert not (tmp_path / "tiles").exists()


def test_a_folder_of_other_things_is_left_alone(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(tl.InputError, match=r"expected an empty folder.*got other files"):
        tl.write_tiles(jacksboro(), tmp_path)
    assert os.listdir(tmp_path) == ["mine.txt"]


def test_tiles_of_another_error_are_left_alone(tmp_path):
    tl.write_tiles(jacksboro(), tmp_path, format="3dtiles", error=40.0)
    before = (tmp_path / "tiles.jsonl").read_bytes()
    with pytest.raises(tl.InputError, match="got tiles of other work"):
        tl.write_tiles(jacksboro(), tmp_path, format="3dtiles", error=30.0)
    assert (tmp_path / "tiles.jsonl").read_bytes() == before


def test_work_that_was_cut_off_goes_on(tmp_path):
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    options = {"format": "3dtiles", "error": 40.0, "zoom": 2}
    tl.write_tiles(jacksboro(), whole, **options)
    done = []

    def stop(finished, _):
        done.append(finished)
        if finished == 7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tl.write_tiles(jacksboro(), cut, progress=stop, **options)
    # a killed writer leaves half a line, and perhaps half of nothing else
    with (cut / "tiles.jsonl").open("a") as journal:
        journal.write('{"z": 2, "x"')
    report = tl.write_tiles(jacksboro(), cut, **options)
    assert report.made in (21 - 7, 21 - 6)
    assert contents(cut) == contents(whole)


# all tiles but the largest have room on this disk; kernels are built before
FULL_DISK = """
import resource, signal, sys
from support.tilesets import jacksboro
import terrain_lod as tl
options = {"format": "3dtiles", "error": 40.0, "zoom": 2}
report = tl.write_tiles(jacksboro(), sys.argv[1], **options)
room = max(record.bytes for record in report.records) - 1
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))
try:
    tl.write_tiles(jacksboro(), sys.argv[2], **options)
except tl.FileError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits the size of a file")
def test_a_full_disk_is_said_and_what_is_finished_stays(tmp_path):
    whole, full = tmp_path / "whole", tmp_path / "full"
    child = subprocess.run(
        [sys.executable, "-c", FULL_DISK, str(whole), str(full)],
        cwd=Path(__file__).parents[1], capture_output=True, text=True, check=True,
    )  # fmt: skip
    report = tl.write_tiles(jacksboro(), whole, format="3dtiles", error=40.0, zoom=2)
    sizes = [record.bytes for record in report.records]
    fit = sizes.index(max(sizes))
    assert fit > 0
    assert child.stdout.startswith(f"cannot write {full / report.records[fit].path}: ")
    assert child.stdout.count("\n") == 1
    assert len(list(full.rglob("*.glb"))) == fit
    assert not list(full.rglob(".terrain_lod-*"))
    again = tl.write_tiles(jacksboro(), full, format="3dtiles", error=40.0, zoom=2)
    assert again.made == len(report.records) - fit
    assert contents(full) == contents(whole)


@pytest.mark.slow
def test_processes_write_the_same_files(tmp_path):
    options = {"format": "3dtiles", "error": 40.0, "zoom": 1}
    tl.write_tiles(jacksboro(), tmp_path / "here", **options)
    tl.write_tiles(jacksboro(), tmp_path / "there", workers=2, **options)
    assert contents(tmp_path / "here") == contents(tmp_path / "there")


def test_the_command_line_says_levels_bytes_and_errors(tmp_path, capsys):
    folder = tmp_path / "tiles"
    assert run(["tiles", "jacksboro", "-o", str(folder), "--format", "mapbox", "--zoom", "8"]) == 0
    said = capsys.readouterr().out
    assert "measured" in said
    assert "tiles of terrain-RGB, Mapbox" in said
    assert json.loads((folder / "tiles.json").read_text())["encoding"] == "mapbox"


def test_the_command_line_refuses_in_one_line(tmp_path, capsys):
    assert run(["tiles", "ridge", "-o", str(tmp_path / "tiles")]) == REFUSED
    assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "tiles").exists()
