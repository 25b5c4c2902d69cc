"""Panels of the paper's page: stress clouds beside finite elements, and crack growth with its load."""

import numpy as np

from rsmpm_ti.records.snapshot import SHEAR, TENSION
from rsmpm_ti.results.result import Result
from rsmpm_ti.spec.regions import slits_of
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.units import MPa, mm
from rsmpm_ti.verify.elastic.slit_field import FieldError

FINER = 10.0
"""By which the difference has finer colours than the stress."""


def draw_field(panels, error: FieldError, limit: float, title: str) -> None:
    """sigma_1 over the nominal stress by MPM, by finite elements, and their difference; one dot a particle."""
    from cmcrameri import cm

    shown = (
        (error.got, limit, f"{title}: MPM"),
        (error.reference, limit, "finite elements"),
        (np.where(error.away, error.got - error.reference, np.nan), limit / FINER, f"difference, {FINER:g} x finer"),
    )
    for axes, (values, bound, name) in zip(panels, shown, strict=True):
        picture = axes.scatter(*(error.x / mm).T, c=values, s=0.4, cmap=cm.vik, vmin=-bound, vmax=bound, linewidths=0,
                               rasterized=True)  # fmt: skip
        axes.set_aspect("equal")
        axes.set_title(name, fontsize="medium")
        axes.figure.colorbar(picture, ax=axes, location="bottom")


def draw_growth(panels, result: Result, scene: Scene, instants: list[tuple[float, float]]) -> None:
    """Failed particles at each instant (time [s], nominal stress [Pa]) in the specimen's outline."""
    events = result.events
    low, high = np.array(scene.bodies[0].region.bounds()) / mm
    colours = {TENSION: "tab:red", SHEAR: "tab:blue"}
    slit = slits_of(scene.bodies[0].region)[0]
    for axes, (time, stress) in zip(panels, instants, strict=True):
        axes.scatter(*(result.snapshot.x / mm).T, s=0.3, color="0.88", linewidths=0, rasterized=True)
        for mode, colour in colours.items():
            here = (events.time <= time) & (events.mode == mode)
            axes.scatter(*(events.x[here] / mm).T, s=1.2, color=colour, linewidths=0, rasterized=True)
        axes.set_aspect("equal")
        axes.set(xlim=(low[0] - 1, high[0] + 1), ylim=(low[1] - 1, high[1] + 1))
        axes.set_title(f"{stress / MPa:.3g} MPa", fontsize="medium")
        axes.set_xlabel(f"flaw {slit.length / mm:g} mm at {slit.angle:g} degrees", fontsize="small")
