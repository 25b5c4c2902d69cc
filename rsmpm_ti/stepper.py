"""Time stepping: musl, usf and usl as lists of passes, and the clock that counts them."""

import math

from rsmpm_ti.kernels import g2p, g2p_remap, p2g
from rsmpm_ti.node_update import clear_nodes, momentum_to_velocity, update_nodes
from rsmpm_ti.state import Simulation
from rsmpm_ti.tracking import track_cracks

VELOCITY_POSITION = (True, True, False)
POSITION_STRESS = (False, True, True)
STRESS = (False, False, True)
EVERYTHING = (True, True, True)


def scatter_all(sim: Simulation, momentum: bool, force: bool, time: float) -> None:
    for colour in range(sim.traversal.colours):
        p2g(sim, momentum, force, colour, time)


def musl(sim: Simulation, dt: float, time: float, factor: float) -> None:
    """Stress last, from velocities mapped back from moved particles.  Sulsky, Zhou & Schreyer (1995)."""
    clear_nodes(sim)
    scatter_all(sim, momentum=True, force=True, time=time - dt)
    update_nodes(sim, True, dt, factor)
    for colour in range(sim.traversal.colours):
        g2p_remap(sim, colour)
    momentum_to_velocity(sim, sim.nodes.w, factor)
    g2p(sim, POSITION_STRESS, dt, time)


def usf(sim: Simulation, dt: float, time: float, factor: float) -> None:
    """Stress first.  Bardenhagen (2002), J. Comput. Phys. 180:383."""
    clear_nodes(sim)
    scatter_all(sim, momentum=True, force=False, time=time - dt)
    momentum_to_velocity(sim, sim.nodes.v, factor)
    g2p(sim, STRESS, dt, time)
    scatter_all(sim, momentum=False, force=True, time=time - dt)
    update_nodes(sim, False, dt, factor)
    g2p(sim, VELOCITY_POSITION, dt, time)


def usl(sim: Simulation, dt: float, time: float, factor: float) -> None:
    """Stress last, from the updated node velocities; dissipates.  Sulsky, Chen & Schreyer (1994)."""
    clear_nodes(sim)
    scatter_all(sim, momentum=True, force=True, time=time - dt)
    update_nodes(sim, True, dt, factor)
    g2p(sim, EVERYTHING, dt, time)


ORDERS = {"musl": musl, "usf": usf, "usl": usl}


class Clock:
    """Counts steps of one run: time [s], platen strain (compression positive), platen speed over the full one."""

    def __init__(self, sim: Simulation):
        scene = sim.scene
        self._sim, self._pass_list = sim, ORDERS[scene.order]
        self.dt, self.total = scene.dt, scene.steps
        self.factor = scene.loading.start.factor
        self.strain_rate = scene.loading.strain_rate if scene.loading.platens else math.nan
        self.step, self.strain = 0, 0.0

    @property
    def time(self) -> float:
        return self.step * self.dt

    @property
    def done(self) -> bool:
        return self.step >= self.total

    def advance(self, steps: int) -> None:
        for _ in range(min(steps, self.total - self.step)):
            factor = self.factor(self.time + 0.5 * self.dt)
            self._pass_list(self._sim, self.dt, self.time + self.dt, factor)
            if self._sim.averaging and self.step % self._sim.means.interval == 0:
                track_cracks(self._sim, self.time + self.dt)
            self.strain += factor * self.strain_rate * self.dt
            self.step += 1
