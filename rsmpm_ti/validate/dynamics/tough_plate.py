"""Plates of solids that break in tension by a known fracture energy, on cells larger than their process zone.

The zone in which such a solid loses its strength, E G_f/sigma_t^2, is 1.1 mm long in maraging steel and 0.4 mm in PMMA.
The mean stress that decides on tension (rock/nonlocal_mean.py) is two cells long and spans four times that, which must
fit into the zone (rock/sheet/data_sheet.py warns where it does not). Where it does not, the strength is lowered until
it does, with the energy kept, as the crack band model does for large elements (Bazant & Oh 1983, Mater. Struct.
16:155). The energy decides when a crack from a notch runs; the strength decides when rock without a notch breaks, which
then is too early. No result enters: the strength follows from E, G_f and the cell.
"""

import math
import warnings

import numpy as np

from rsmpm_ti import simulate
from rsmpm_ti.errors import RockWarning
from rsmpm_ti.results.result import Result
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.nonlocal_mean import MIN_CELLS, Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.data_sheet import SPAN
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import LinearSoftening
from rsmpm_ti.spec.scene import Scene

OUT_OF_REACH = 10.0
"""Cohesion over tensile strength: what these solids do in shear, which is to yield, is not modelled."""

SHEAR_ENERGY = 1000.0
"""G_f_II over G_f_I: enough for that cohesion not to snap back; nothing spends it."""


def carried_strength(elasticity: Hooke, energy: float, strength: float, dx: float) -> float:
    """The tensile strength [Pa], or what cells of dx [m] can carry of it with a fracture energy [J/m^2].

    sqrt(E G_f/(4 l)), l the length of the mean.
    """
    return min(strength, math.sqrt(elasticity.E * energy / (SPAN * MIN_CELLS * dx)))


def tough(*, density: float, elasticity: Hooke, energy: float, strength: float, dx: float) -> Rock:
    """The solid as a rock: directional cracks that cost `energy` [J/m^2], tension judged by its mean over two cells."""
    carried = carried_strength(elasticity, energy, strength, dx)
    return Rock(
        density=density,
        elasticity=elasticity,
        criterion=_in_tension(carried),
        after_failure=Directional(softening=LinearSoftening(G_f_I=energy, G_f_II=SHEAR_ENERGY * energy)),
        nonlocal_mean=Nonlocal(length=MIN_CELLS * dx),
    )


def brittle(*, density: float, elasticity: Hooke, strength: float) -> Rock:
    """The same by the paper's rule: a particle that reaches the strength pulls no more; no energy is asked for."""
    return Rock(density=density, elasticity=elasticity, criterion=_in_tension(strength))


def _in_tension(strength: float) -> MohrCoulomb:
    return MohrCoulomb(cohesion=OUT_OF_REACH * strength, friction_angle=0.0, tensile_strength=strength)


def run_of(scene: Scene) -> Result:
    """A run of such a solid, without the warnings that it is no rock."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RockWarning)
        return simulate(scene, threads=1)


def front_speed(time: np.ndarray, way: np.ndarray, window: float) -> tuple[np.ndarray, np.ndarray]:
    """Middle [s] and speed [m/s] of windows [s] of a front, by a line through each; one NaN for a crack of no length.

    time [e], ascending, and way [e] of failures [m]; the front is the furthest so far. Windows of fewer than six
    failures say nothing.
    """
    if len(time) < 6:
        return np.full(1, np.nan), np.full(1, np.nan)
    front, found = np.maximum.accumulate(way), []
    for start in np.arange(time[0], time[-1], window):
        held = (time >= start) & (time < start + window)
        if held.sum() >= 6 and np.ptp(time[held]) > 0.5 * window:
            found.append((start + 0.5 * window, float(np.polyfit(time[held], front[held], 1)[0])))
    middles, speeds = np.array(found or [(np.nan, np.nan)]).T
    return middles, speeds
