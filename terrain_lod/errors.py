"""What can go wrong, as a tree.

::

    TerrainError
    ├── InputError        (ValueError)    an argument or a file's content is not usable
    ├── FileError         (OSError)       a file is missing, unreadable or cannot be written
    ├── DeviceError       (RuntimeError)  no such device, a kernel does not build or launch
    │   └── DeviceMemoryError             more bytes wanted than the device has
    ├── GraphicsError     (RuntimeError)  3-D pictures cannot be drawn on this machine
    ├── WorkerError       (RuntimeError)  processes or a cluster died over their work
    └── MissingExtraError (ImportError)   an optional package is needed; the message names it

Every message is one line: what was expected, what came, what to do.
"""

from __future__ import annotations


class TerrainError(Exception):
    """Base of every error that terrain_lod raises on purpose."""


class InputError(TerrainError, ValueError):
    """An argument, or the content of a file, is not usable."""


class FileError(TerrainError, OSError):
    """A file is missing, cannot be read or cannot be written."""


class DeviceError(TerrainError, RuntimeError):
    """No such device, or a kernel does not build or launch."""


class DeviceMemoryError(DeviceError):
    """More bytes are wanted than the device has."""


class GraphicsError(TerrainError, RuntimeError):
    """3-D pictures cannot be drawn here; the message names the command that mends it."""


class WorkerError(TerrainError, RuntimeError):
    """Processes, or a cluster, died over their work."""


class MissingExtraError(TerrainError, ImportError):
    """An optional package is needed for this; the message names the command that installs it."""
