"""What a test measures: the forces of its platens, the nominal stress made of them, and gauges on the specimen."""

import math
import re
from dataclasses import dataclass, replace
from typing import Annotated, Literal

import numpy as np

from rsmpm_ti.checks import Position, Positive, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.spec.boundaries import Axis, Platen
from rsmpm_ti.units import LengthOrArea

GAUGE_NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")


@checked("gauge")
@dataclass(frozen=True, kw_only=True)
class Gauge:
    """Two points a and b of the specimen [m] whose distance is followed; lengthening is positive.

    It is glued to the particles nearest to its points. reads: 'strain' (change of the distance over the distance,
    column `gauge_NAME` of the history) or 'opening' (the change itself [m], column `gauge_NAME_m`: a clip gauge over a
    notch).
    """

    name: str
    a: Position
    b: Position
    reads: Literal["strain", "opening"] = "strain"

    def __post_init__(self):
        if not GAUGE_NAME.fullmatch(self.name):
            raise refuse("gauge.name", self.name, "a word of at most 40 small letters, digits and _")
        if len(self.b) != len(self.a):
            raise refuse("gauge.b", self.b, "2 or 3 coordinates in metres, as many as gauge.a")

    @property
    def length(self) -> float:
        """Distance of the two points [m]."""
        return math.dist(self.a, self.b)

    @property
    def column(self) -> str:
        """Its name in the history."""
        return f"gauge_{self.name}" if self.reads == "strain" else f"gauge_{self.name}_m"


@dataclass(frozen=True)
class Load:
    """What a load cell reads: force on the specimen [N] (per metre of thickness in 2D) and nominal stress [Pa] at its
    lower and its upper side, pressing positive. NaN where nothing is measured."""

    force_lower: float
    force_upper: float
    stress_lower: float
    stress_upper: float

    @property
    def stress(self) -> float:
        """Mean of the sides that are read [Pa]."""
        both = 0.5 * (self.stress_upper + self.stress_lower)
        alone = self.stress_lower if math.isnan(self.stress_upper) else self.stress_upper
        return alone if math.isnan(both) else both


NO_LOAD = Load(math.nan, math.nan, math.nan, math.nan)


@checked("cell")
@dataclass(frozen=True, kw_only=True)
class LoadCell:
    """Which boundaries are read, along which axis, and by which width their force becomes nominal stress.

    What is None comes from the scene. axis: that of the first two platens that face each other. lower, upper: indices
    in `loading.boundaries`; all platens of that side of the axis, so that the reaction of several supports is their
    sum. width [m] (an area [m^2] in 3D): `loading.width`; stress = force / width, so for three-point bending over L
    of a beam of depth h, width = 2 h^2 / (3 L) makes it the stress of beam theory at mid-span.
    """

    axis: Axis | None = None
    lower: tuple[int, ...] | None = None
    upper: tuple[int, ...] | None = None
    width: Annotated[LengthOrArea, Positive] | None = None
    gauges: tuple[Gauge, ...] = ()

    def __post_init__(self):
        for name in ("lower", "upper"):
            indices = getattr(self, name) or ()
            if len(set(indices)) < len(indices) or not all(index >= 0 for index in indices):
                raise refuse(f"cell.{name}", indices, "different indices of loading.boundaries, counted from 0")
        columns = [gauge.column for gauge in self.gauges]
        if len(set(columns)) < len(columns):
            raise refuse("cell.gauges", columns, "gauges of different names")

    def filled(self, loading) -> "LoadCell | None":
        """With what is None from a `Loading`; None where there is no axis along which to measure."""
        pair, axis = loading.platens, self.axis
        if axis is None and pair is not None:
            axis = pair[0].axis
        if axis is None:  # one platen against walls, or alone
            axis = next((b.axis for b in loading.boundaries if isinstance(b, Platen)), None)
        if axis is None:
            return None

        def side(name: str) -> tuple[int, ...]:
            found = getattr(self, name)
            if found is not None:
                return found
            boundaries = enumerate(loading.boundaries)
            return tuple(k for k, b in boundaries if isinstance(b, Platen) and (b.axis, b.side) == (axis, name))

        width = loading.width if self.width is None else self.width
        return replace(self, axis=axis, lower=side("lower"), upper=side("upper"), width=width)

    def read(self, forces: np.ndarray, confinement: float = 0.0) -> Load:
        """Of a cell that is filled. forces: of each boundary on the bodies [N], [boundaries, dim].

        The nominal stress is the mean axial stress of a section of the loaded width: platen force over width, and the
        confining pressure [Pa], which the platens do not read (see `confinement.py`) and which the rest of such a
        section's end feels too. In compression a lower plate pushes along +axis, an upper one along -axis.
        """
        width = math.nan if self.width is None else self.width
        along = forces[:, self.axis]
        lower = float(sum(along[k] for k in self.lower)) if self.lower else math.nan
        upper = -float(sum(along[k] for k in self.upper)) if self.upper else math.nan
        return Load(lower, upper, confinement + lower / width, confinement + upper / width)
