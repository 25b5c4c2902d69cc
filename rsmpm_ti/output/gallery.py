"""The pictures of one run: frames, the movie that is made of them, and summary.png."""

from collections.abc import Sequence

import numpy as np

from rsmpm_ti.output.files import frame_name
from rsmpm_ti.output.pictures import Commission
from rsmpm_ti.paint.figure import FramePainter
from rsmpm_ti.paint.movie import Movie
from rsmpm_ti.paint.png import TIME_NOTE, read_png, write_png
from rsmpm_ti.paint.summary_picture import summary_picture
from rsmpm_ti.records.snapshot import Pattern, Snapshot


class Gallery:
    """Paints and writes the pictures of one run. Allocates Taichi fields, so Taichi must have been started."""

    def __init__(self, wanted: Commission):
        self._wanted, self._out = wanted, wanted.out
        self.painters = {kind: FramePainter(kind=kind, **wanted.painters) for kind in wanted.kinds}
        self.warning = ""
        self._movie = None
        if wanted.movie:
            try:
                self._movie = Movie(self._out / f"{wanted.name}.mp4")
            except RuntimeError as error:  # no encoder: frames still come
                self.warning = f"no movie is written: {error}"

    def paint(self, number: int, snapshot: Snapshot, history: np.ndarray) -> dict[str, np.ndarray]:
        """Frames by kind, for `write`."""
        return {kind: painter.paint(snapshot, history, number) for kind, painter in self.painters.items()}

    def write(self, kind: str, number: int, image: np.ndarray, time: float) -> None:
        """A frame to its file, with a note of its time [s]."""
        notes = {"painter": self._wanted.painters["backend"], TIME_NOTE: f"{time:.10g}"}
        write_png(self._out / frame_name(kind, number), image, **notes)

    def refilm(self, numbers: list[int]) -> None:
        """Begin the movie with frames of a run that goes on, from their files, without those that are damaged."""
        for number in numbers:
            try:
                pictures = [self._read(kind, number) for kind in ("stress", "cracks")]
            except (OSError, ValueError, SyntaxError) as error:  # Pillow raises each of them
                self._warn(f"the movie goes without frame {number:04d}, which is damaged ({error})")
                continue
            self.film(*pictures)

    def _read(self, kind: str, number: int) -> np.ndarray:
        return read_png(self._out / frame_name(kind, number), self.painters[kind].layout.size)

    def _warn(self, sentence: str) -> None:
        self.warning = "; ".join(filter(None, (self.warning, sentence)))

    def film(self, stress: np.ndarray, cracks: np.ndarray) -> None:
        """Into the movie, in order of the frames' numbers. One that fails, for any reason, costs the movie alone."""
        if self._movie is not None:
            try:
                self._movie.add(stress, cracks)
            except Exception as error:
                self._unfilmed(error)

    def _unfilmed(self, error: Exception) -> None:
        self._warn(f"no movie is written: {error or type(error).__name__}")
        self.discard()
        self._movie = None

    def discard(self) -> None:
        """Remove what there is of a movie that cannot be finished."""
        if self._movie is not None:
            self._movie.discard()

    def close(
        self,
        snapshot: Snapshot,
        history: np.ndarray,
        lines: list[np.ndarray],
        acoustic: np.ndarray,
        peak: Pattern | None = None,
        peak_lines: Sequence[np.ndarray] = (),
    ) -> None:
        """Finish the movie, paint summary.png, give the painters' memory back.

        lines: of cracks, where the rock is at the end, each [k, 2] [m]; acoustic: times of acoustic events, ascending
        [s]; peak: the crack pattern at the largest load, with its own lines.
        """
        if self._movie is not None:
            try:
                self._movie.close()
            except Exception as error:
                self._unfilmed(error)
        summary_picture(
            self._out / "summary.png", snapshot, history, self.painters["cracks"], self._wanted.title, lines, acoustic,
            peak, peak_lines,
        )  # fmt: skip
        for painter in self.painters.values():
            painter.close()
