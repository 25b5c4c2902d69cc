"""What hard cases share: a small free block that is put into a state by hand, without building it again."""

from dataclasses import dataclass, replace

import numpy as np
import taichi as ti

from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.method.transfer import PicFlip
from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.tensors import PACKED_LENGTH
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.survey import survey
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

E, NU, DENSITY = 17e9, 0.14, 2600.0
DX = 1e-3
LONG = 1.0
"""An end of the schedule that no case reaches [s]."""

HOOKE = Hooke(E=E, nu=NU)
ELASTIC = Rock(density=DENSITY, elasticity=HOOKE, criterion=Unbreakable(), viscosity=NoViscosity())
PAPER = MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6)
"""Strength of the paper's rock."""

C_P = ELASTIC.wave_speed()


def breaking(criterion: MohrCoulomb = PAPER, **changes) -> Rock:
    """The same rock with a strength."""
    return replace(ELASTIC, criterion=criterion, **changes)


def scene_of(size: tuple[float, float], lower: tuple[float, ...], upper: tuple[float, ...], **changes) -> Scene:
    """A scene with one box from `lower` to `upper` in a domain of `size`, all in cells; elastic, Linear, FLIP, musl."""
    box = Box(lower=tuple(DX * a for a in lower), upper=tuple(DX * b for b in upper))
    settings = {
        "title": "hard case",
        "domain": Domain(lower=(0.0, 0.0), upper=tuple(DX * a for a in size), dx=DX),
        "bodies": (Body(region=box),),
        "rock": ELASTIC,
        "loading": Loading(),
        "schedule": Schedule(t_end=LONG),
        "shape": Linear(),
        "transfer": PicFlip(),
    }
    return Scene(**settings | changes)


@dataclass
class Piece:
    """A drive that starts again and again: place, velocity and stress by hand, everything else as it was built."""

    drive: Drive

    @classmethod
    def of(cls, scene: Scene, real=ti.f64) -> "Piece":
        return cls(set_up(scene, real))

    def __post_init__(self):
        self.sim, self.particles, self.clock = self.drive.sim, self.drive.sim.particles, self.drive.clock
        self._position = self.particles.reference.to_numpy()[np.argsort(self.particles.id.to_numpy())]

    def start(self, cfl: float, velocity, sigma=0.0, shift=(0.0, 0.0)) -> None:
        """velocity [m/s] and packed sigma [Pa], per particle in the order of ids or one for all; shift in cells."""
        particles, n = self.particles, self.particles.count
        particles.id.from_numpy(np.arange(n, dtype=np.int32))
        particles.reference.from_numpy(self._position + DX * np.array(shift))
        particles.u.fill(0.0)
        particles.J.fill(1.0)
        particles.v.from_numpy(np.broadcast_to(velocity, (n, 2)).copy())
        particles.sigma.from_numpy(np.broadcast_to(sigma, (n, PACKED_LENGTH[2])).copy())
        if particles.affine:
            particles.C.fill(0.0)
        if particles.breaks:
            particles.mode.fill(0)
            self.sim.events.count.fill(0)
            self.sim.events.by_mode.fill(0)
        sort_particles(self.sim)
        ledger = self.sim.ledger
        for field in (ledger.impulse, ledger.work, ledger.latest, ledger.body_work, ledger.viscous, ledger.released):
            field.fill(0.0)
        ledger.stopped.fill(0.0)
        self.sim.grid.begin()
        self.clock.step, self.clock.dt = 0, cfl * DX / self.sim.wave_speed
        self.drive.survey = survey(self.sim)

    def by_id(self, name: str) -> np.ndarray:
        """A particle field in the order of ids."""
        return getattr(self.particles, name).to_numpy()[np.argsort(self.particles.id.to_numpy())]

    @property
    def x(self) -> np.ndarray:
        """Places in the order of ids [cells]."""
        return (self.by_id("reference") + self.by_id("u")) / DX

    @property
    def energy(self) -> float:
        """Kinetic and elastic, as last surveyed [J]."""
        return self.drive.survey.kinetic + self.drive.survey.elastic
