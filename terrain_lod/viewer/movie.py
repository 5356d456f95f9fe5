"""Recordings: GIF with what is always there, MP4 with the extra ``[movie]``.

Pictures are written as they come, under a temporary name: a recording may be as long as the disk.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt
from PIL import Image
from PIL.GifImagePlugin import getdata, getheader

from ..drawing.picture import Picture
from ..errors import InputError, MissingExtraError
from ..paths import replacing, require_folder

ENDINGS: Final = (".gif", ".mp4")
_RATE: Final = 20  # pictures a second; GIF counts in hundredths
_COLOURS: Final = 256

_Write = Callable[[npt.NDArray[np.uint8]], None]


class Movie:
    """A recording that pictures are added to; the file appears when it is closed.

    Parameters
    ----------
    path : Path
        Ends in .gif or .mp4.

    Raises
    ------
    InputError
        If it ends in something else.
    FileError
        If it cannot be written.
    MissingExtraError
        For .mp4 without the extra.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        ending = self.path.suffix.lower()
        if ending not in ENDINGS:
            raise InputError(
                f"expected a recording that ends in {' or '.join(ENDINGS)}, got {self.path.name}"
            )
        require_folder(self.path)
        if ending == ".mp4":
            _require_video(self.path)
        self._size: tuple[int, int] | None = None
        self._recording = _recording(self.path, _video if ending == ".mp4" else _gif)
        next(self._recording)

    def add(self, picture: Picture) -> None:
        """Add a picture; the first one sets the size, later ones are scaled to it.

        Raises
        ------
        FileError
            If it cannot be written; that was the end of the recording.
        """
        image = Image.fromarray(picture)
        # video codecs want even numbers
        self._size = self._size or (image.width & ~1 or 2, image.height & ~1 or 2)
        if image.size != self._size:
            image = image.resize(self._size)
        self._recording.send(np.asarray(image))

    def close(self) -> None:
        """End the recording: what was added becomes the file, if anything was.

        Raises
        ------
        FileError
            If it cannot be written.
        """
        with suppress(StopIteration):
            self._recording.send(None)


def _recording(
    path: Path, writer: Callable[[Path], AbstractContextManager[_Write]]
) -> Generator[None, npt.NDArray[np.uint8] | None]:
    """Take pictures, of one size, and write each; None ends it."""
    picture = yield
    if picture is None:
        return
    with replacing(path) as temporary, writer(temporary) as write:
        while picture is not None:
            write(picture)
            picture = yield


@contextmanager
def _gif(path: Path) -> Iterator[_Write]:
    """Yield what writes a picture: where it differs from the one before, in its own colours."""
    shown: npt.NDArray[np.uint8] | None = None

    def write(picture: npt.NDArray[np.uint8]) -> None:
        nonlocal shown
        left, top = 0, 0
        changed = picture
        if shown is not None:
            rows, columns = np.nonzero((picture != shown).any(axis=-1))
            if len(rows):
                left, top = int(columns.min()), int(rows.min())
                changed = picture[top : rows.max() + 1, left : columns.max() + 1]
            else:
                changed = picture[:1, :1]
        # the other ways lose what is small: a mark, a frustum, green in a brown picture
        image = Image.fromarray(changed).quantize(_COLOURS, Image.Quantize.MAXCOVERAGE)
        if shown is None:
            file.writelines(getheader(image, info={"loop": 0})[0])
        file.writelines(
            getdata(image, (left, top), duration=1000 // _RATE, include_color_table=True)
        )
        shown = picture

    with path.open("wb") as file:
        yield write
        file.write(b";")


@contextmanager
def _video(path: Path) -> Iterator[_Write]:
    """Yield what writes a picture."""
    import imageio

    with imageio.get_writer(path, fps=_RATE, macro_block_size=2) as video:
        yield video.append_data


def _require_video(path: Path) -> None:
    try:
        import imageio  # noqa: F401
        import imageio_ffmpeg  # noqa: F401
    except ImportError:
        raise MissingExtraError(
            f"expected imageio with ffmpeg for {path.name}, got none: install "
            "'terrain_lod[movie]', or record a .gif"
        ) from None
