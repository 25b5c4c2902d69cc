"""The curve of a run as a figure: load over strain, failures, acoustic events, first failure and peak."""

import io
import math

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from rsmpm_ti.paint.frame_axes import DPI, Wording
from rsmpm_ti.paint.summary_picture import draw_load
from rsmpm_ti.records.events import EventTable

WORDS = Wording(title="", bar=None, legend=(), inset_y="total nominal stress [MPa]")

NONE = np.zeros(0)


class CurveFigure(Figure):
    """A figure that a notebook shows though no pyplot knows it."""

    def _repr_png_(self) -> bytes:
        data = io.BytesIO()
        self.savefig(data, format="png")
        return data.getvalue()


def curve_figure(history: np.ndarray, events: EventTable, acoustic: np.ndarray = NONE) -> CurveFigure:
    """A figure of one plot, and a second axis for counts. acoustic: times of acoustic events, ascending [s]."""
    figure = CurveFigure(figsize=(9.0, 6.0), dpi=DPI, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    first = float(events.time[0]) if len(events) else math.nan
    draw_load(figure.subplots(), history, WORDS, acoustic, first)
    return figure
