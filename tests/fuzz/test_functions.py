"""Everything public is called with wrong arguments."""

from __future__ import annotations

from pathlib import Path

from fuzz.functions import MADE_BY_US, OF_ROOMS, Bench, covered


def test_everything_public_is_called(tmp_path: Path) -> None:
    called = {call.name for call in Bench(tmp_path).calls()}
    left_out = {name for name in covered() if name.split(".")[0] in MADE_BY_US or name in OF_ROOMS}
    assert covered() - called == left_out
