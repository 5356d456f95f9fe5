"""The viewer: how soon a moved camera has its mesh on screen, and whether anything wears it out.

    python benchmarks/viewer.py [--pixels 0.4]        a flight, each time printed apart
    python benchmarks/viewer.py --events 1000         sliders, keys, mouse, resizes, reloads
    python benchmarks/viewer.py --events 1000 --what pot.bpt

Off screen, so that drawing is all that a window would do but showing.
"""

from __future__ import annotations

import argparse
import resource
from collections.abc import Callable, Iterator
from contextlib import suppress
from ctypes import CDLL
from dataclasses import replace
from pathlib import Path
from statistics import median
from time import perf_counter, sleep
from typing import Any

import numpy as np

import terrain_lod as tl
from terrain_lod.camera.path import flyover
from terrain_lod.errors import InputError
from terrain_lod.viewer.controls import Controls
from terrain_lod.viewer.memory import keep_large_blocks_apart
from terrain_lod.viewer.model import Model
from terrain_lod.viewer.rig import Rig
from terrain_lod.viewer.scene import Frame, Scene
from terrain_lod.viewer.terrain_scene import TerrainScene
from terrain_lod.viewer.view import scene_of
from terrain_lod.viewer.window import Window

_PICTURES = 30  # as many as a driver may have memory for at a time
KEYS = (*"123456mlpexnbtfgrhwasd", "Up", "Down", "Left", "Right", "F13")


def flight(window: Window, controls: Controls, frames: int) -> None:
    """Fly, wait for each mesh, and print medians and the longest time that input had to wait."""
    scene = window.model.scene
    rigs = [window.home.orbit(360 * number / frames, 0.0) for number in range(frames)]
    if isinstance(scene, TerrainScene):
        rigs = [Rig.of(camera) for camera in flyover(scene.ground, frames, fov=55)]
    times: dict[str, list[float]] = {}
    for number, rig in enumerate(rigs):
        begun = perf_counter()
        longest = took(lambda rig=rig: window.drive(rig))
        wanted = window._asked
        while window.frame is None or window.frame.request.number < wanted:
            longest = max(longest, took(controls.pump))
            sleep(0.001)
        frame = window.frame
        if number:  # the first builds kernels
            row = {
                "camera move to new mesh on screen": perf_counter() - begun,
                "  engine": frame.engine_seconds,
                "  of which device": sum(frame.mesh.timings.values()),
                "  colours": frame.paint_seconds,
                "  drawing": window.draw_seconds,
                "longest wait of input": longest,
                "triangles": len(frame.mesh.triangles),
            }
            for name, value in row.items():
                times.setdefault(name, []).append(value)
    counts = times.pop("triangles")
    width, height = window.size
    print(f"{frames} moves, {width} x {height}, {median(counts):,.0f} triangles (median)")
    for name, values in times.items():
        print(
            f"{name:36} median {1e3 * median(values):6.1f} ms, longest {1e3 * max(values):6.1f} ms"
        )


def took(action: Callable[[], Any]) -> float:
    """Return how long something takes, in seconds."""
    begun = perf_counter()
    action()
    return perf_counter() - begun


def event(controls: Controls, rng: np.random.Generator) -> None:
    """Do something that a user might, through VTK's own events."""
    window, interactor = controls.window, controls.window.plotter.iren.interactor
    x, y = (int(value) for value in rng.integers(0, 700, 2))
    match rng.integers(0, 10):
        case 0 | 1:
            interactor.SetKeySym(str(rng.choice(KEYS)))
            interactor.InvokeEvent("KeyPressEvent")
        case 2 | 3 | 4:
            button = str(rng.choice(("Left", "Middle", "Right")))
            interactor.SetEventPosition(x, y)
            interactor.InvokeEvent(f"{button}ButtonPressEvent")
            for _ in range(rng.integers(0, 4)):
                x, y = x + int(rng.integers(-90, 90)), y + int(rng.integers(-90, 90))
                interactor.SetEventPosition(x, y)
                interactor.InvokeEvent("MouseMoveEvent")
                controls.pump()
            interactor.InvokeEvent(f"{button}ButtonReleaseEvent")
        case 5:
            way = str(rng.choice(("Forward", "Backward")))
            interactor.InvokeEvent(f"MouseWheel{way}Event")
        case 6 | 7:
            slide(controls, str(rng.choice(list(controls.widgets))), float(rng.random()))
        case 8:
            choice = window.settings.choices[rng.integers(0, len(window.settings.choices))]
            window.change(choice.name, choice.values[rng.integers(0, len(choice.values))])
        case 9:
            resize_or_reload(controls, rng)
    controls.pump()


def slide(controls: Controls, name: str, share: float) -> None:
    """Move a slider to a share of its range."""
    widget = controls.widgets[name]
    shape = widget.GetRepresentation()
    low, high = shape.GetMinimumValue(), shape.GetMaximumValue()
    shape.SetValue(low + share * (high - low))
    widget.InvokeEvent("InteractionEvent")


def resize_or_reload(controls: Controls, rng: np.random.Generator) -> None:
    """Give the window another size, read the ground again, or drive the camera far away."""
    window = controls.window
    match rng.integers(0, 3):
        case 0:
            width, height = (int(value) for value in rng.integers(1, 900, 2))
            window.plotter.render_window.SetSize(width, height)
        case 1:
            controls.press("u")
        case 2:
            far = float(rng.choice((1e9, -1e9, 1e4)))
            window.drive(window.rig.fly(far, far))


def tour(controls: Controls) -> Iterator[Callable[[], None]]:
    """Yield events that lead once to everything there is: what is kept for good is then there."""
    window = controls.window
    settings = window.model.scene.settings
    stops = [(slider.name, stop) for slider in settings.numbers for stop in slider.stops]
    yield lambda: window.plotter.render_window.SetSize(900, 900)
    yield window.reload
    # the largest meshes that there are, in every mode: drivers keep room for the largest so far.
    # All of the ground is in view; powers of two make 8 segments of 5 cells
    yield lambda: window.drive(window.home.zoom(0.3))
    yield lambda: window.apply(replace(window.settings, lod="uniform", partitioning="pow2"))
    for name, stop in (("factor", 1e9), *stops[1:2]):
        yield lambda name=name, stop=stop: window.change(name, stop)
    for mode in settings.modes:
        yield lambda mode=mode: window.change("mode", mode)
    yield lambda: window.apply(settings)
    yield lambda: window.drive(window.home)
    # every slider at its ends, and with every kind of detail that it is for
    seen = {"tile"}
    for choice in settings.choices:
        for value in choice.values if choice.name in ("lod", "sharp") else ():
            yield lambda name=choice.name, value=value: window.change(name, value)
            for slider in settings.changed(choice.name, value).sliders:
                for share in (0.0, 1.0) if slider.name not in seen else ():
                    yield lambda name=slider.name, share=share: slide(controls, name, share)
                seen.add(slider.name)
    yield lambda: window.apply(settings)
    for choice in settings.choices:
        first, *rest = choice.values
        for value in (*rest, first):
            yield lambda name=choice.name, value=value: window.change(name, value)
            # kernels are built for each tile size and edge rule
            for name, stop in stops if choice.name == "edge_rule" else ():
                yield lambda name=name, stop=stop: window.change(name, stop)


def stress(window: Window, controls: Controls, count: int) -> None:
    """Do so many events, and print what memory does."""
    rng = np.random.default_rng(6)
    marks, shown = [], set()
    steps = list(tour(controls))
    for number in range(1, count + 1):
        if number <= len(steps):
            steps[number - 1]()
            controls.pump()
        else:
            event(controls, rng)
        if number <= len(steps) or number % 10 == 0:
            shown.add(settled(window).request.settings.mode)
        if number % -(-count // 10) == 0:
            settings = window.settings
            marks.append(at_rest(window))
            print(f"after {number:5} events {marks[-1] / 2**20:8.1f} MiB resident", flush=True)
            window.apply(settings)
    grown = [mark / marks[0] - 1 for mark in marks]
    print(
        f"since the first {100 * grown[-1]:+.1f} %, at most {100 * max(grown):+.1f} %; "
        f"{len(shown)} of {len(window.settings.modes)} modes shown"
    )


def at_rest(window: Window) -> int:
    """Show the same as ever, and return the bytes that this process holds in memory then.

    What is only kept for the next mesh or picture is given back first. OpenGL in software holds
    what it last drew, up to 36 MB a picture, until it draws the next: let those be little.
    """
    window.apply(window.model.scene.settings)
    window.drive(window.home)
    window.plotter.render_window.SetSize(800, 600)
    window.settle(measured=True)
    window.plotter.render_window.SetSize(64, 48)
    for _ in range(_PICTURES):
        window.draw()
    return resident()


def settled(window: Window) -> Frame:
    """Wait for what was asked for last, and return what is shown.

    What cannot be, such as fewer triangles than two a patch, is a line in the window.
    """
    with suppress(InputError):
        window.settle()
    assert window.frame is not None
    return window.frame


def resident() -> int:
    """Return the bytes that this process holds in memory, after giving back what it can."""
    tl.Device.open().memory.trim()
    trim = getattr(CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
    status = Path("/proc/self/statm")
    if status.exists():
        return int(status.read_text().split()[1]) * resource.getpagesize()
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def scene(what: str) -> Scene:
    """Return bundled ground or what a file holds, to look at."""
    if what.endswith(".bpt"):
        return scene_of(tl.curved.load_bpt(what))
    return scene_of(tl.sample(what) if what in tl.sample_names() else tl.load_mesh(what))


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--what", default="ridge", help="bundled ground, a mesh file or a .bpt")
    parser.add_argument("--size", type=int, nargs=2, default=(1920, 1080))
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--pixels", type=float, help="error that ground is shown with")
    parser.add_argument("--events", type=int, default=0)
    options = parser.parse_args()
    keep_large_blocks_apart()
    model = Model(lambda: scene(options.what))
    camera = replace(model.scene.camera(), size=tuple(options.size))
    window = Window(model, camera, off_screen=True)
    controls = Controls(window)
    if options.pixels:
        window.change("pixels", options.pixels)
    window.settle()
    if options.events:
        stress(window, controls, options.events)
    else:
        flight(window, controls, options.frames)
    window.close()


if __name__ == "__main__":
    main()
