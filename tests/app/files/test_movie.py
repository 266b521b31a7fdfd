"""Movies are decoded again and compared with the frames that went in."""

from __future__ import annotations

import io

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from app.files.movie import movie

COLOURS = [(200, 40, 40), (40, 160, 60), (40, 70, 200), (230, 200, 60), (20, 20, 20), (240, 240, 240)]


def pixels(colour: tuple[int, int, int], width: int = 160, height: int = 90) -> np.ndarray:
    """A plain picture with a white square in its top left corner."""
    picture = np.empty((height, width, 3), np.uint8)
    picture[:] = colour
    picture[:20, :20] = 255
    return picture


def as_file(picture: np.ndarray, kind: str) -> bytes:
    file = io.BytesIO()
    Image.fromarray(picture).save(file, kind)
    return file.getvalue()


def decoded(data: bytes, tmp_path) -> tuple[dict, list[np.ndarray]]:
    path = tmp_path / "movie.mp4"
    path.write_bytes(data)
    reader = imageio_ffmpeg.read_frames(str(path))
    about = next(reader)
    width, height = about["size"]
    return about, [np.frombuffer(frame, np.uint8).reshape(height, width, 3) for frame in reader]


def test_an_mp4_shows_the_frames_at_their_rate(tmp_path):
    kinds = ["PNG", "JPEG", None] * 2
    frames = [
        pixels(colour) if kind is None else as_file(pixels(colour), kind)
        for colour, kind in zip(COLOURS, kinds, strict=True)
    ]
    data, suffix = movie(iter(frames), 25)
    assert suffix == ".mp4"
    assert data[4:8] == b"ftyp"
    assert data.index(b"moov") < data.index(b"mdat")  # a browser can begin before it has all
    about, seen = decoded(data, tmp_path)
    assert about["fps"] == 25
    assert about["codec"] == "h264"
    assert about["pix_fmt"].startswith("yuv420p")
    assert len(seen) == len(frames)
    for picture, colour in zip(seen, COLOURS, strict=True):
        assert np.abs(picture[60, 100].astype(int) - colour).max() < 20
        assert picture[5, 5].min() > 225


def test_odd_sizes_and_transparent_pixels(tmp_path):
    clear = np.zeros((91, 161, 4), np.uint8)
    clear[:45, :, 3] = 255
    about, seen = decoded(movie([clear] * 3, 30)[0], tmp_path)
    assert about["size"] == (160, 90)
    assert seen[0][10, 80].max() < 20
    assert seen[0][80, 80].min() > 235


def test_frames_are_taken_one_by_one():
    taken = []

    def drawn():
        for number in range(50):
            taken.append(number)
            if number == 3:
                raise RuntimeError("the browser is gone")
            yield pixels(COLOURS[0])

    with pytest.raises(RuntimeError, match="the browser is gone"):
        movie(drawn(), 25)
    assert taken == [0, 1, 2, 3]


def test_frames_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="at least one frame"):
        movie([], 25)
    with pytest.raises(ValueError, match="frame 2 is 320 × 90 pixels large, the first 160 × 90"):
        movie([pixels(COLOURS[0]), pixels(COLOURS[0], width=320)], 25)


def test_without_an_encoder_it_is_a_gif_of_the_same_length(monkeypatch):
    def missing() -> str:
        raise RuntimeError("No ffmpeg exe could be found")

    monkeypatch.setattr(imageio_ffmpeg, "get_ffmpeg_exe", missing)
    data, suffix = movie([pixels(COLOURS[k // 10]) for k in range(50)], 50)
    assert suffix == ".gif"
    shown = Image.open(io.BytesIO(data))
    assert shown.size == (160, 90)
    duration, seen = 0, set()
    for number in range(shown.n_frames):
        shown.seek(number)
        duration += shown.info["duration"]
        seen.add(shown.convert("RGB").getpixel((100, 60)))
    assert duration == pytest.approx(1000, rel=0.05)
    assert len(seen) == 5
