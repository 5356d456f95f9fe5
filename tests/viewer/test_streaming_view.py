"""A pyramid in the viewer: it shows at once what is held, and goes on until nothing is missing."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.pyramids import rugged
from terrain_lod.cli.app import REFUSED, run
from terrain_lod.drawing.graphics import graphics_problem
from terrain_lod.streaming.window import Window
from terrain_lod.viewer.engine import Engine
from terrain_lod.viewer.model import Model
from terrain_lod.viewer.rig import height_at
from terrain_lod.viewer.scene import Request
from terrain_lod.viewer.streaming_scene import StreamingFrame, StreamingScene

pytest.importorskip("zarr")

SIDE = 150
SPACING = 30.0


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pyramids") / "a.tlod"
    return tl.build(rugged(SIDE, SIDE) * 10, path, chunk=32, spacing=SPACING)


def scene_of(store: Path) -> StreamingScene:
    return StreamingScene(tl.open(store, memory="200MB"))


def request(scene: StreamingScene, x: float, number: int = 0) -> Request:
    camera = tl.Camera((x, -2000.0, 900.0), (x + 900, -1500.0, 0.0), size=(320, 200))
    return Request(camera, scene.settings.changed("pixels", 0.5), number)


def test_frames_come_before_chunks_are_read_and_end_with_all_of_them(
    store: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, real, late = scene_of(store), Window.of, 0.2
    scene.terrain.mesh(lod=tl.MaxErrorLod(500.0))  # kernels

    def slow(*arguments: object) -> Window:
        time.sleep(late)
        return real(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(Window, "of", slow)
    engine, missing, held = Engine(Model(lambda: scene)), [], []
    try:
        engine.ask(request(scene, 1000.0))
        for _ in range(600):
            engine.wait(0.1)
            frame = engine.take()
            if frame is not None:
                assert isinstance(frame, StreamingFrame)
                missing.append(frame.missing)
                held.append(frame.facts()[1])
            if missing and missing[-1] == 0:
                break
    finally:
        engine.close()
    assert engine.problem is None
    # the first did not wait for a single chunk, and they got better meanwhile
    assert missing[0] >= 5
    assert missing == sorted(missing, reverse=True)
    assert missing[-1] == 0
    assert len(missing) > 2
    assert f"{missing[0]} chunks missing" in held[0]
    assert "of 200 MB held" in held[0]
    assert "missing" not in held[-1]
    assert frame.mesh.achieved is not None
    assert frame.mesh.achieved.kept


def test_a_request_ends_what_waits_for_chunks(store: Path) -> None:
    scene = scene_of(store)
    engine = Engine(Model(lambda: scene))
    try:
        for number in range(1, 4):
            engine.ask(request(scene, 1000.0 * number, number))
        assert engine.wait(60.0, measured=True)
        frame = engine.take()
    finally:
        engine.close()
    assert frame is not None
    assert frame.request.number == 3
    assert frame.is_complete


def test_a_damaged_chunk_is_said_and_the_flight_goes_on(store: Path, tmp_path: Path) -> None:
    path = tmp_path / "a.tlod"
    shutil.copytree(store, path)
    shutil.rmtree(path / "heights/0/c")
    scene = scene_of(path)
    for _ in range(600):
        frame = scene.frame(request(scene, 1000.0))
        if frame.is_complete:
            break
        time.sleep(0.01)
    assert frame.mesh.achieved is not None
    assert not frame.mesh.achieved.kept
    assert len(frame.mesh.triangles) > 0
    assert "expected heights/0 chunk" in frame.facts()[2]


def test_eyes_stay_above_the_finest_ground_that_is_held(store: Path) -> None:
    scene = scene_of(store)
    place = 31.4 * SPACING, -40.2 * SPACING
    coarse = scene.floor(*place)
    assert coarse == pytest.approx(height_at(scene.terrain.overview, *place))
    exact = float(scene.terrain.height_at([place])[0])  # reads the chunk
    assert scene.floor(*place) == pytest.approx(exact)
    assert coarse != pytest.approx(exact)
    # outside, the nearest ground
    assert np.isfinite(scene.floor(-1e6, 1e6))


def test_a_click_tells_of_the_mesh(store: Path) -> None:
    scene = scene_of(store)
    asked = request(scene, 1000.0)
    frame = scene.frame(asked)
    pick = frame.pick(asked.camera, 160, 100)
    assert pick is not None
    assert [line.split()[0] for line in pick.lines()] == ["height", "patch", "factors"]
    assert frame.pick(asked.camera, 160, 199) is None  # sky


@pytest.mark.skipif(graphics_problem() is not None, reason="no window")
def test_the_command_opens_a_store(store: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = store.parent / "view.png"
    assert run(["view", str(store), "--off-screen", "-o", str(picture), "--memory", "50MB"]) == 0
    assert picture.stat().st_size > 10_000
    said = capsys.readouterr().out
    assert "of 50 MB held, 0 pages in flight\n" in said
    for given in (["--tile", "8"], ["--y-up"], ["--bounds", "0,0,1,1"], ["--lod", "budget"]):
        assert run(["view", str(store), *given, "--off-screen"]) == REFUSED
        assert len(capsys.readouterr().err.splitlines()) == 1
    assert run(["view", "ridge", "--memory", "1GB", "--off-screen"]) == REFUSED
    assert "expected a pyramid with --memory" in capsys.readouterr().err
