"""Where things are on a frame, in pixels from its upper left corner, for specimens of any aspect ratio."""

from dataclasses import dataclass

from rsmpm_ti.errors import refuse
from rsmpm_ti.paint.palette import View

LEFT, TOP, BOTTOM = 100, 75, 75
"""Margins around the panel that hold the axes' numbers, the title and the axis label."""

COLUMN = 464
"""Right of the panel: colour bar, legend, numbers and inset."""

COLUMN_GAP = 45

PANEL_LARGEST = (1000, 1290)
COLUMN_LEAST = 970
"""Height below which the column's parts would run into each other."""

LEGEND_LINE, TEXT_LINE, SPACE = 32, 27, 50
INSET = (330, 185)

PAD = 0.05
"""Free space around the specimen, of its longer side: room for platens to move and for the specimen to bulge."""


@dataclass(frozen=True, kw_only=True)
class Box:
    """A rectangle of a frame [px]."""

    left: int
    top: int
    width: int
    height: int

    @property
    def bottom(self) -> int:
        return self.top + self.height

    @property
    def right(self) -> int:
        return self.left + self.width

    def fraction(self, size: tuple[int, int]) -> tuple[float, float, float, float]:
        """As matplotlib places axes: left, bottom, width, height as parts of the figure."""
        return self.left / size[0], 1.0 - self.bottom / size[1], self.width / size[0], self.height / size[1]


@dataclass(frozen=True, kw_only=True)
class Layout:
    """Boxes of one frame of `size` (width, height); `view` is what the panel shows, with equal scales."""

    size: tuple[int, int]
    view: View
    panel: Box
    bar: Box
    legend: Box
    text: Box
    inset: Box


def lay_out(
    lower: tuple[float, float],
    upper: tuple[float, float],
    size: tuple[int, int] | None,
    text_lines: int,
    legend_lines: int,
) -> Layout:
    """The layout for a specimen between two corners [m]; without a size, the frame takes the specimen's shape."""
    pad = PAD * max(upper[0] - lower[0], upper[1] - lower[1])
    lower = lower[0] - pad, lower[1] - pad
    upper = upper[0] + pad, upper[1] + pad
    extent = upper[0] - lower[0], upper[1] - lower[1]

    if size is None:
        room = PANEL_LARGEST
    else:
        room = size[0] - LEFT - COLUMN, size[1] - TOP - BOTTOM
        if room[0] < 100 or room[1] < COLUMN_LEAST or size[0] % 2 or size[1] % 2:
            least = f"({LEFT + COLUMN + 100}, {TOP + BOTTOM + COLUMN_LEAST})"
            raise refuse("size", size, f"two even numbers of pixels, at least {least}")
    scale = min(room[0] / extent[0], room[1] / extent[1])
    width, height = max(2, round(extent[0] * scale)), max(2, round(extent[1] * scale))
    if size is None:
        column_height = max(height, COLUMN_LEAST)
        size = even(LEFT + width + COLUMN), even(TOP + column_height + BOTTOM)
    else:
        column_height = room[1]

    panel = Box(left=LEFT, top=TOP + (column_height - height) // 2, width=width, height=height)
    left = panel.right + COLUMN_GAP
    inset = Box(left=left + 45, top=TOP + column_height - INSET[1] - 45, width=INSET[0], height=INSET[1])
    text_height = text_lines * TEXT_LINE
    text = Box(left=left, top=inset.top - 40 - SPACE - text_height, width=45 + INSET[0], height=text_height)
    legend_height = legend_lines * LEGEND_LINE
    legend = Box(left=left, top=text.top - SPACE - legend_height, width=text.width, height=legend_height)
    bar = Box(left=left, top=TOP, width=34, height=min(545, legend.top - SPACE - TOP))
    view = View(lower=lower, upper=upper, width=width, height=height)
    return Layout(size=size, view=view, panel=panel, bar=bar, legend=legend, text=text, inset=inset)


def even(number: int) -> int:
    """The next even number: H.264 takes no other sizes."""
    return number + number % 2
