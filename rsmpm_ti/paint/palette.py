"""What a painter needs to know before the first particle: which part of space is shown, and in which colours."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from cmcrameri import cm

INFLATE = 1.04
"""Squares of exactly the particle's volume let the background shimmer through where rock is stretched."""

MAX_SQUARE = 2.0
"""In median half-sizes: a failed particle whose volume has run away must not cover the picture."""

LEVELS = 4097
"""Colours of a `Palette.table`: 16 for each of a ramp's, and odd, so that the value 0 has one of its own."""


@dataclass(frozen=True, kw_only=True)
class View:
    """The rectangle of space [m] that a panel of width x height pixels shows."""

    lower: tuple[float, float]
    upper: tuple[float, float]
    width: int
    height: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Palette:
    """Colours of one kind of frame, 0 to 255.

    `ramp`, float32 [k, 3], runs from value -limit to value +limit; `void`, `tension` and `shear` stand for no rock and
    for the two failure modes. `folded`: the halves of the ramp show two kinds of rock, each darker with the distance
    from the middle; a pixel that sees both shows the kind that weighs more and the mean distance, not their difference.
    """

    ramp: np.ndarray
    limit: float
    void: tuple[int, int, int]
    tension: tuple[int, int, int]
    shear: tuple[int, int, int]
    folded: bool = False

    def marks(self) -> np.ndarray:
        """Colours that failure modes 1 and 2 select, after that of the void, float32 [3, 3]."""
        return np.array((self.void, self.tension, self.shear), dtype=np.float32)

    def table(self) -> np.ndarray:
        """The ramp in LEVELS steps, uint8 [LEVELS, 3]: a colour is then one look-up, off by half a step of 255."""
        position = np.linspace(0.0, len(self.ramp) - 1.0, LEVELS)
        known = np.arange(len(self.ramp))
        return np.rint([np.interp(position, known, channel) for channel in self.ramp.T]).astype(np.uint8).T.copy()

    def colours(self, value: np.ndarray, mode: np.ndarray) -> np.ndarray:
        """Colour of each particle, float32 [n, 3]: `value` in limits, -1 to 1, `mode` as in a Snapshot."""
        position = (np.clip(value, -1.0, 1.0) + 1.0) * 0.5 * (len(self.ramp) - 1)
        left = np.minimum(position.astype(np.int32), len(self.ramp) - 2)
        fraction = (position - left)[:, None]
        ramp = self.ramp[left] * (1.0 - fraction) + self.ramp[left + 1] * fraction
        return np.where((mode > 0)[:, None], self.marks()[mode], ramp).astype(np.float32)


def stress_palette(limit: float) -> Palette:
    """Signed stress: vik, neutral at 0, tension red, compression blue; on a white void the rim would read as zero."""
    ramp = np.asarray(cm.vik(np.linspace(0.0, 1.0, 256)), dtype=np.float32)[:, :3] * 255.0
    return Palette(ramp=ramp, limit=limit, void=(184, 184, 184), tension=(0, 0, 0), shear=(0xFF, 0xC2, 0x0A))


def crack_palette() -> Palette:
    """Failure modes alone, in two colours that colour-blind readers can tell apart, on grey rock."""
    ramp = np.tile(np.array((0xBD, 0xBD, 0xB2), dtype=np.float32), (2, 1))
    return Palette(ramp=ramp, limit=1.0, void=(255, 255, 255), tension=(0xD5, 0x5E, 0x00), shear=(0x00, 0x72, 0xB2))


def cracking_palette() -> Palette:
    """Failure modes, and in pale tints of their colours rock that has begun to fail: shear below 0, tension above."""
    plain = crack_palette()
    intact, ends = plain.ramp[0], np.array(((0x8C, 0xC4, 0xEC), (0xFF, 0xC0, 0x87)), dtype=np.float32)
    fraction = np.abs(np.linspace(-1.0, 1.0, 257, dtype=np.float32))[:, None]
    ramp = (1.0 - fraction) * intact + fraction * np.repeat(ends, (128, 129), axis=0)
    return replace(plain, ramp=ramp, folded=True)


def margin_palette() -> Palette:
    """Signed load: bam, pale at 0, shear green below, tension purple above; without its darkest, so black shows."""
    ramp = np.asarray(cm.bam(np.linspace(0.92, 0.08, 257)), dtype=np.float32)[:, :3] * 255.0
    marks = {"void": (184, 184, 184), "tension": (0, 0, 0), "shear": (0xFF, 0xC2, 0x0A)}
    return Palette(ramp=ramp, limit=1.0, **marks, folded=True)


class Squares(NamedTuple):
    """Particles as squares on the panel, in pixels from its upper left corner, all [n]."""

    column: np.ndarray  # of the centre, float32
    row: np.ndarray  # of the centre, float32, downwards
    half: np.ndarray  # half side, float32
    value: np.ndarray  # in units of the palette's limit, float32
    mode: np.ndarray  # int32


def squares_in_view(
    view: View, limit: float, x: np.ndarray, half: np.ndarray, mode: np.ndarray, value: np.ndarray | None
) -> tuple[Squares, int]:
    """Squares that touch the panel, and how many particles were left out because something of theirs is not finite.

    Positions x [m] are [n, 2] or more (the rest is not looked at), half sides [m], modes and values [n].
    """
    value = np.zeros(len(x)) if value is None else np.asarray(value, dtype=float)
    half = np.broadcast_to(np.asarray(half, dtype=float), (len(x),))
    finite = np.isfinite(x[:, 0]) & np.isfinite(x[:, 1]) & np.isfinite(half) & np.isfinite(value)
    skipped = len(x) - int(np.count_nonzero(finite))
    if skipped == len(x):
        none = np.zeros(0, dtype=np.float32)
        return Squares(none, none, none, none, np.zeros(0, dtype=np.int32)), skipped

    scale = view.width / (view.upper[0] - view.lower[0]), view.height / (view.upper[1] - view.lower[1])
    column = (x[:, 0] - view.lower[0]) * scale[0]
    row = (view.upper[1] - x[:, 1]) * scale[1]
    side = np.minimum(half, MAX_SQUARE * np.median(half[finite])) * scale[0] * INFLATE
    with np.errstate(invalid="ignore"):
        inside = (abs(column - view.width / 2) < view.width / 2 + side) & (
            abs(row - view.height / 2) < view.height / 2 + side
        )
    shown = finite & inside
    squares = Squares(
        column[shown].astype(np.float32),
        row[shown].astype(np.float32),
        side[shown].astype(np.float32),
        (value[shown] / limit).astype(np.float32),
        np.asarray(mode)[shown].astype(np.int32),
    )
    return squares, skipped
