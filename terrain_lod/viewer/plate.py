"""A small picture that stands in a window of VTK's, in front of everything."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..drawing.notes import Strip


class Plate:
    """A picture at the lower border of a window, hidden to begin with.

    Parameters
    ----------
    renderer : vtkRenderer
        Of the window.

    Attributes
    ----------
    width : int
        Of what is shown, pixels; 0 where nothing is.
    """

    def __init__(self, renderer: Any) -> None:
        from vtkmodules.vtkRenderingCore import vtkActor2D, vtkImageMapper

        self.width = 0
        self._shown: Strip | None = None
        self._mapper, self._actor = vtkImageMapper(), vtkActor2D()
        self._mapper.SetColorWindow(255)
        self._mapper.SetColorLevel(127.5)
        self._actor.SetMapper(self._mapper)
        self._actor.SetVisibility(False)
        renderer.AddViewProp(self._actor)

    def show(self, strip: Strip | None) -> None:
        """Show a picture from now on; nothing for None."""
        if strip is self._shown:
            return
        self._shown, self.width = strip, 0 if strip is None else strip.shape[1]
        self._actor.SetVisibility(strip is not None)
        if strip is not None:
            self._mapper.SetInputData(_image(strip))

    def move(self, left: int) -> None:
        """Stand so many pixels from the left border of the window."""
        self._actor.SetPosition(left, 0)


def _image(strip: Strip) -> Any:
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    height, width, _ = strip.shape
    image = vtkImageData()
    image.SetDimensions(width, height, 1)
    # VTK counts rows from below
    rows = np.ascontiguousarray(strip[::-1]).reshape(-1, 4)
    image.GetPointData().SetScalars(numpy_to_vtk(rows, deep=True))
    return image
