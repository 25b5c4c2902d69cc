"""What is swept: numerical settings, and which combinations of them each case runs."""

import itertools
from dataclasses import dataclass, replace

from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic, PicFlip

SHAPES = {
    "linear": lambda per_axis: Linear(),
    "gimp": lambda per_axis: Gimp(half_width=0.5 / per_axis),
    "bspline": lambda per_axis: QuadraticBSpline(),
}
"""Shape function for so many particles per axis, by name."""

TRANSFERS = {"flip": PicFlip(), "apic": Apic()}
ORDERS = ("musl", "usf", "usl")
CELLS = {"slit": (160, 200, 400), "bar": (16, 32, 64), "vortex": (16, 32, 64)}
"""Resolutions: cells over the specimen's height, per wavelength, and per unit radius."""


@dataclass(frozen=True)
class Setting:
    """One way to compute one case. `cells`: see CELLS; `per_axis`: particles per axis of a cell."""

    case: str
    cells: int
    shape: str = "bspline"
    transfer: str = "flip"
    order: str = "musl"
    per_axis: int = 2
    precision: str = "f64"
    time_scale: float = 8.0
    fitted: bool = True

    @property
    def functions(self):
        """The shape function object."""
        return SHAPES[self.shape](self.per_axis)

    @property
    def scheme(self) -> str:
        """Everything but the case and its resolution, for tables."""
        edges = "" if self.fitted or self.case != "slit" else ", stairs"
        scale = f", time_scale {self.time_scale:g}" if self.case == "slit" else ""
        per_cell = f"{self.per_axis}x{self.per_axis}"
        return f"{self.shape}, {self.transfer}, {self.order}, {per_cell}, {self.precision}{edges}{scale}"


def sweep(case: str, finest: bool = True) -> list[Setting]:
    """Every scheme at the coarser resolutions, musl at the finest, then one change at a time."""
    *coarse, fine = CELLS[case]
    settings = [
        Setting(case, cells, shape, transfer, order)
        for cells, shape, transfer, order in itertools.product(coarse, SHAPES, TRANSFERS, ORDERS)
        if not (order == "usl" and shape == "linear")  # refused by the scene: its stable step tends to 0
    ]
    if finest:
        transfers = ("flip",) if case == "slit" else TRANSFERS  # the slit's takes minutes for each
        settings += [Setting(case, fine, shape, transfer) for shape in SHAPES for transfer in transfers]
    for cells, shape in itertools.product(coarse, SHAPES):
        base = Setting(case, cells, shape)
        changes = [{"precision": "f32"}, {"per_axis": 3}]
        if case == "slit":
            changes += [{"time_scale": scale} for scale in (4.0, 16.0, 32.0)] + [{"fitted": False}]
        settings += [replace(base, **change) for change in changes]
    return settings
