"""Recordings: GIF with what is always there, MP4 with the extra ``[movie]``."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from PIL import Image

from ..drawing.picture import Picture
from ..errors import FileError, InputError, MissingExtraError
from ..paths import require_folder

ENDINGS: Final = (".gif", ".mp4")
_RATE: Final = 20  # pictures a second; GIF counts in hundredths
_COLOURS: Final = 256


class Movie:
    """A recording that pictures are added to.

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
        if self.path.suffix.lower() not in ENDINGS:
            raise InputError(
                f"expected a recording that ends in {' or '.join(ENDINGS)}, got {self.path.name}"
            )
        require_folder(self.path)
        self._pictures: list[Image.Image] = []
        self._size: tuple[int, int] | None = None
        self._video = _video(self.path) if self.path.suffix.lower() == ".mp4" else None

    def add(self, picture: Picture) -> None:
        """Add a picture; the first one sets the size, later ones are scaled to it."""
        image = Image.fromarray(picture)
        # video codecs want even numbers
        self._size = self._size or (image.width & ~1 or 2, image.height & ~1 or 2)
        if image.size != self._size:
            image = image.resize(self._size)
        if self._video is not None:
            import numpy as np

            self._video.append_data(np.asarray(image))
        else:
            # the other ways lose what is small: a mark, a frustum, green in a brown picture
            self._pictures.append(image.quantize(_COLOURS, Image.Quantize.MAXCOVERAGE))

    def close(self) -> None:
        """Write what was added.

        Raises
        ------
        FileError
            If it cannot be written.
        """
        if self._video is not None:
            self._video.close()
        elif self._pictures:
            first, *rest = self._pictures
            try:
                first.save(
                    self.path, save_all=True, append_images=rest, duration=1000 // _RATE, loop=0
                )
            except OSError as error:
                raise FileError(f"cannot write {self.path}: {error.strerror or error}") from None
            self._pictures.clear()


def _video(path: Path) -> Any:
    try:
        import imageio
        import imageio_ffmpeg  # noqa: F401
    except ImportError:
        raise MissingExtraError(
            f"expected imageio with ffmpeg for {path.name}, got none: install "
            "'terrain_lod[movie]', or record a .gif"
        ) from None
    return imageio.get_writer(path, fps=_RATE, macro_block_size=2)
