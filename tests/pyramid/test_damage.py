"""What is wrong in a store is one line that names the chunk, and the rest can be read."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.pyramids import CHUNK, rugged
from terrain_lod.cli.app import run
from terrain_lod.pyramid.store import Store
from terrain_lod.pyramid.verify import damages

pytest.importorskip("zarr")


@pytest.fixture
def store(tmp_path: Path) -> Path:
    return tl.build(rugged(70, 140), tmp_path / "a.tlod", chunk=CHUNK, spacing=1.0)


def test_a_sound_store_is_described(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert list(damages(Store.open(store))) == []
    assert run(["info", str(store)]) == 0
    said = capsys.readouterr().out
    assert "70 × 140" in said
    assert "every chunk is as it was written" in said


@pytest.mark.slow
def test_flipped_bytes(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = store / "heights/0/c/0/0/0/0"
    sound = file.read_bytes()
    rng = np.random.default_rng(2)
    for place in rng.integers(0, len(sound), 4):
        broken = bytearray(sound)
        broken[place] ^= 0x40
        file.write_bytes(broken)
        found = list(damages(Store.open(store)))
        assert found
        assert all("expected heights/0 chunk [" in line and "\n" not in line for line in found)
    # what lies in other files is not lost
    opened = Store.open(store)
    opened.heights(0, 0, 8)
    opened.heights(1, 0, 0)
    assert run(["info", str(store)]) == 2
    assert "heights/0 chunk" in capsys.readouterr().err


@pytest.mark.slow
def test_truncated_and_missing(store: Path) -> None:
    for name in ("heights/0/c/0/0/0/0", "errors/1/c/0/0/0/0/0", "chunk_ranges/2/c/0/0/0"):
        file = store / name
        sound = file.read_bytes()
        file.write_bytes(sound[:-5])
        chunk = name.split("/c/")[0]
        assert all(line.startswith(f"expected {chunk}") for line in damages(Store.open(store)))
        file.unlink()
        lines = list(damages(Store.open(store)))
        assert lines
        assert all("its file is missing" in line for line in lines)
        file.write_bytes(sound)
    assert list(damages(Store.open(store))) == []


def test_other_versions_and_other_things(store: Path, tmp_path: Path) -> None:
    file = store / "zarr.json"
    sound = json.loads(file.read_text())
    for change, said in (
        ({"version": 2}, "expected a pyramid of version 1, got 2"),
        ({"format": "other"}, "got other arrays"),
        ({"complete": False}, "whose build ended early"),
        ({"base": None, "rows": "many"}, "expected the description of a pyramid"),
    ):
        changed = json.loads(json.dumps(sound))
        changed["attributes"]["terrain_lod"] |= change
        file.write_text(json.dumps(changed))
        with pytest.raises(tl.FileError, match=said):
            Store.open(store)
    file.write_text("{")
    with pytest.raises(tl.FileError, match="got damage"):
        Store.open(store)
    with pytest.raises(tl.FileError, match="got nothing at"):
        Store.open(tmp_path / "none")
