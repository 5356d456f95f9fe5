"""Can this machine draw? VTK ends the whole process where OpenGL is missing, so a child asks first.

Meshing, measuring and every table work without OpenGL; only 3-D pictures and windows need it.
"""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache
from typing import Final

from ..errors import GraphicsError

INSTALL_COMMAND: Final = "apt-get install libegl1 libgl1-mesa-dri"

# without a display, VTK tries X before EGL and complains about it
_WINDOW_VARIABLE: Final = "VTK_DEFAULT_OPENGL_WINDOW"
_EGL_WINDOW: Final = "vtkEGLRenderWindow"

_TIMEOUT: Final = 120.0  # seconds; a first start on a cold disk takes ten

# draws eight green pixels off screen and looks at one of them
_PROBE: Final = """
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter
import vtkmodules.vtkRenderingOpenGL2
window, renderer, picture = vtkRenderWindow(), vtkRenderer(), vtkWindowToImageFilter()
window.SetOffScreenRendering(1)
window.SetSize(8, 8)
renderer.SetBackground(0, 1, 0)
window.AddRenderer(renderer)
window.Render()
picture.SetInput(window)
picture.Update()
green = picture.GetOutput().GetScalarComponentAsFloat(4, 4, 0, 1)
print("drawn" if green == 255 else f"a pixel of {green:g}")
"""


@cache
def graphics_problem() -> str | None:
    """Return why 3-D pictures cannot be drawn here, in one line; None where they can.

    A child process draws a tiny picture (0.6 s, once a process), so that a missing or crashing
    OpenGL driver cannot take this process along.
    """
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        os.environ.setdefault(_WINDOW_VARIABLE, _EGL_WINDOW)
    try:
        probe = subprocess.run(
            [sys.executable, "-c", _PROBE], capture_output=True, text=True, timeout=_TIMEOUT
        )
    except subprocess.TimeoutExpired:
        return _advice(f"no picture within {_TIMEOUT:g} s")
    except OSError as error:
        return _advice(f"no child process: {error.strerror}")
    if probe.returncode < 0:
        return _advice(f"a crash of VTK with signal {-probe.returncode}")
    if "drawn" not in probe.stdout:
        last_line = (probe.stdout + probe.stderr).strip().rpartition("\n")[2]
        return _advice(last_line or f"exit status {probe.returncode}")
    return None


def require_graphics() -> None:
    """Return where 3-D pictures can be drawn.

    Raises
    ------
    GraphicsError
        Where they cannot; the message names the command that mends it.
    """
    problem = graphics_problem()
    if problem is not None:
        raise GraphicsError(problem)


def _advice(symptom: str) -> str:
    cure = INSTALL_COMMAND if sys.platform == "linux" else "install an OpenGL 3.2 driver"
    return f"expected OpenGL for 3-D pictures, got {symptom}: mend it with  {cure}"
