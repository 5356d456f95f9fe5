"""What a user does to the viewer's window, and the benchmark that does a thousand such things."""

from __future__ import annotations

import importlib.util
from pathlib import Path

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "viewer.py"


def press(controls, key):
    """Press a key, as VTK reports it."""
    interactor = controls.window.plotter.iren.interactor
    interactor.SetKeySym(key)
    interactor.InvokeEvent("KeyPressEvent")
    interactor.InvokeEvent("CharEvent")


def drag(controls, start, end, button="Left", shift=False):
    interactor = controls.window.plotter.iren.interactor
    interactor.SetShiftKey(int(shift))
    interactor.SetEventPosition(*start)
    interactor.InvokeEvent(f"{button}ButtonPressEvent")
    interactor.SetEventPosition(*end)
    interactor.InvokeEvent("MouseMoveEvent")
    interactor.InvokeEvent(f"{button}ButtonReleaseEvent")
    interactor.SetShiftKey(0)


def benchmark():
    spec = importlib.util.spec_from_file_location("viewer_benchmark", BENCHMARK)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
