"""Confining pressure: p on every surface of the bodies, as it moves, without looking for surfaces.

The force of a traction -p n on the nodes is an integral over the boundary; Gauss turns it into one over the volume:
    f_i = -p int N_i n dA = -p int grad N_i dV = -p sum_p V_p grad w_ip,
so that internal force of sigma + p 1 holds both: f_i = -sum_p V_p (sigma_p + p 1) . grad w_ip. Bodies start at
sigma = -p 1 in every direction, out of the plane too. Then these forces are zero to the last bit, however particles
lie, and sigma + p 1 alone drives a body afterwards.

What it means:
- On a held plane (platen, wall, clamp) the same force appears although its face is not free. It cancels in the
  reaction, which reads sigma + p 1: what a plate adds to the pressure. Where stress is reported p is put back
  (`History`).
- Cracks are dry: failed particles are part of the body, and inside it p 1 is uniform and makes no force. So is a
  jacketed test. A slit that is cut out holds no particles and is filled with the pressure, as if the fluid had entered
  it; so is a crack that gapes so far that nodes between its faces see no particle.
- The failure check sees sigma itself.
- J counts from the stress-free state, as the pressure of failed rock K (1 - J) needs it: it starts at 1 - p/K, with
  stress-free volumes so much larger and a density so much smaller that volume and mass are those seeded.
"""

from rsmpm_ti.errors import refuse
from rsmpm_ti.rock.elasticity import Hooke

MAX_FRACTION = 0.1
"""Of the bulk modulus: beyond it p = K (1 - J) is no law of rock any more."""


def check_confined_rock(pressure: float, elasticity: Hooke) -> None:
    """Raises SceneError for rock that cannot start under a pressure [Pa]: a plate, or one too soft for it."""
    if pressure > 0.0 and elasticity.plane_stress:
        remedy = "a fluid presses on the faces of a plate too, where plane stress keeps sigma_zz = 0; use plane strain"
        raise refuse("loading.confinement", pressure, "0 in plane stress", remedy)
    most = MAX_FRACTION * elasticity.bulk
    if pressure > most:
        raise refuse("loading.confinement", pressure, f"at most {MAX_FRACTION:g} of the bulk modulus, {most:.4g} Pa")


def confined_volume_ratio(pressure: float, elasticity: Hooke) -> float:
    """J at which rock is in equilibrium with a pressure [Pa], intact or failed: K (1 - J) = p."""
    return 1.0 - pressure / elasticity.bulk
