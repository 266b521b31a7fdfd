"""Pictures -> a movie: MP4 where imageio-ffmpeg brings an encoder for this machine, else an animated GIF."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Iterable, Iterator
from itertools import chain, islice
from pathlib import Path

import imageio_ffmpeg  # type: ignore[import-untyped]
import numpy as np
from PIL import Image

Frame = bytes | np.ndarray  # a PNG or JPEG file; or pixels (H, W, 3 or 4), 0…255
QUALITY = 8  # of imageio-ffmpeg's 0…10
GIF_RATE = 20.0  # frames a second, at most: GIF counts hundredths of a second, and browsers slow down faster ones


def movie(frames: Iterable[Frame], rate: float) -> tuple[bytes, str]:
    """A movie of `rate` frames a second, and its suffix, ".mp4" or ".gif".

    Frames are taken one by one as they are needed; all must be as large as the first. Transparent pixels get white.
    Sizes are rounded down to even ones. Raises ValueError when there is no frame, or one of another size.
    """
    pixels = _same_size(frames)
    try:
        imageio_ffmpeg.get_ffmpeg_exe()
    except RuntimeError:
        return _gif(pixels, rate), ".gif"
    return _mp4(pixels, rate), ".mp4"


def _same_size(frames: Iterable[Frame]) -> Iterator[np.ndarray]:
    """RGB pixels (H, W, 3) of every frame, H and W even."""
    remaining = iter(frames)
    first = next(remaining, None)
    if first is None:
        raise ValueError("a movie needs at least one frame")
    size = _pixels(first).shape

    def checked() -> Iterator[np.ndarray]:
        for number, frame in enumerate(chain([first], remaining), start=1):
            pixels = _pixels(frame)
            if pixels.shape != size:
                raise ValueError(
                    f"frame {number} is {pixels.shape[1]} × {pixels.shape[0]} pixels large, "
                    f"the first {size[1]} × {size[0]}"
                )
            yield pixels

    return checked()


def _pixels(frame: Frame) -> np.ndarray:
    picture = Image.open(io.BytesIO(frame)) if isinstance(frame, bytes) else Image.fromarray(frame)
    if "A" in picture.getbands():
        picture = Image.alpha_composite(Image.new("RGBA", picture.size, "white"), picture.convert("RGBA"))
    pixels = np.asarray(picture.convert("RGB"))
    height, width = pixels.shape[:2]
    return pixels[: height - height % 2, : width - width % 2]


def _mp4(frames: Iterator[np.ndarray], rate: float) -> bytes:
    """H.264 in a form that every browser and office program plays, with its index in front."""
    first = next(frames)
    height, width = first.shape[:2]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "movie.mp4"
        encoder = imageio_ffmpeg.write_frames(
            str(path),
            (width, height),
            fps=rate,
            quality=QUALITY,
            codec="libx264",
            macro_block_size=2,
            ffmpeg_log_level="error",
            output_params=["-movflags", "+faststart"],
        )
        encoder.send(None)
        try:
            for pixels in chain([first], frames):
                encoder.send(np.ascontiguousarray(pixels))
        finally:
            encoder.close()
        return path.read_bytes()


def _gif(frames: Iterator[np.ndarray], rate: float) -> bytes:
    """Every k-th frame, so that the movie lasts as long as it should."""
    every = max(1, int(np.ceil(rate / GIF_RATE)))
    pictures = [Image.fromarray(pixels).quantize() for pixels in islice(frames, 0, None, every)]
    file = io.BytesIO()
    pictures[0].save(
        file, "GIF", save_all=True, append_images=pictures[1:], duration=round(1000 * every / rate), loop=0
    )
    return file.getvalue()
