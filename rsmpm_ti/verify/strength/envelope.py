"""The failure envelope through the real solver: blocks strained along many stress paths until they fail."""

import itertools
import math
from dataclasses import dataclass, replace

import numpy as np

from rsmpm_ti import load_scene
from rsmpm_ti.cases.case import Case, Outcome, Row, at_most, relative
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.snapshot import MODE_NAMES, SHEAR, TENSION
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.readout import read_events
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice

E, NU = 17e9, 0.14
TENSILE, COHESION = 2.0e6, 5.95e6
N_PHI = math.tan(math.radians(65.0)) ** 2
UCS = 2.0 * COHESION * math.sqrt(N_PHI)
"""phi = 40 degrees: N_phi = tan^2(45 + phi/2), UCS = 2 c sqrt(N_phi) = 25.52 MPa."""

DX, CELLS, GAP = 1e-3, 12, 4
"""Cell [m]; cells along a block's edge and between blocks."""

RELEASE = 1.5
"""Cells that waves from a block's free faces have come by the time of failure; the centre is 6 cells away."""


@dataclass(frozen=True)
class Path:
    """A ray through the in-plane stress (xx, yy, xy) [MPa], which lies on the envelope; mode 0: inside it, and twice
    as far too."""

    name: str
    stress: tuple[float, float, float]
    mode: int
    plane_stress: bool = False

    @property
    def reach(self) -> float:
        """How far the block is taken, over `stress`."""
        return 1.1 if self.mode else 2.0

    def gradient(self) -> np.ndarray:
        """Symmetric displacement gradient [2, 2] at which the logarithmic strain is that of `stress` by Hooke's law."""
        xx, yy, xy = 1e6 * np.array(self.stress)
        nu, modulus = (NU, E) if self.plane_stress else (NU / (1.0 - NU), E / (1.0 - NU**2))
        shear = (1.0 + NU) / E * xy
        strain, axes = np.linalg.eigh([[(xx - nu * yy) / modulus, shear], [shear, (yy - nu * xx) / modulus]])
        return axes * np.expm1(strain) @ axes.T

    def sigma(self, factor: np.ndarray) -> np.ndarray:
        """Stress [n, 3, 3] of particles that move on with their velocities: F = 1 + factor x gradient, [n].

        F is symmetric and keeps its axes, so Hooke's law in rates gives the logarithmic strain its stress.
        """
        stretch, axes = np.linalg.eigh(self.gradient())
        strain = np.einsum("ia,na,ja->nij", axes, np.log1p(np.multiply.outer(factor, stretch)), axes)
        trace = np.trace(strain, axis1=1, axis2=2)
        lam = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
        if self.plane_stress:
            lam = E * NU / (1.0 - NU**2)
        sigma = np.zeros((len(factor), 3, 3))
        sigma[:, :2, :2] = E / (1.0 + NU) * strain + lam * trace[:, None, None] * np.eye(2)
        sigma[:, 2, 2] = 0.0 if self.plane_stress else lam * trace
        return sigma


def distance(sigma: np.ndarray) -> np.ndarray:
    """Load over strength, 1 on the envelope: the cut-off or Mohr-Coulomb, on all three principal stresses; [n]."""
    sigma_3, _, sigma_1 = np.linalg.eigvalsh(sigma).T
    return np.maximum(sigma_1 / TENSILE, (N_PHI * sigma_1 - sigma_3) / UCS)


PATHS = (
    Path("tension", (0.0, 2.0, 0.0), TENSION),
    Path("equal tension", (2.0, 2.0, 0.0), TENSION),
    Path("pure shear", (0.0, 0.0, 2.0), TENSION),
    Path("tension 2, compression 12", (2.0, -12.0, 0.0), TENSION),
    Path("tension 1, compression", (1.0, -20.92, 0.0), SHEAR),
    Path("compression", (0.0, -25.52, 0.0), SHEAR),
    Path("compression at 30 degrees", (-6.38, -19.14, 11.0505), SHEAR),
    Path("compression confined by 5", (-5.0, -48.51, 0.0), SHEAR),
    Path("confined by 16.53, the corner", (-16.53, -101.5, 0.0), SHEAR),
    Path("confined by 20, beyond it", (-20.0, -107.8, 0.0), SHEAR),
    Path("confined by 30", (-30.0, -125.9, 0.0), SHEAR),
    Path("equal compression to 100", (-50.0, -50.0, 0.0), 0),
    Path("tension, plane stress", (0.0, 2.0, 0.0), TENSION, True),
    Path("tension 1, compression, plane stress", (1.0, -20.92, 0.0), SHEAR, True),
    Path("compression, plane stress", (0.0, -25.52, 0.0), SHEAR, True),
    Path("confined by 5, plane stress", (-5.0, -25.52, 0.0), SHEAR, True),
    Path("equal compression, plane stress", (-25.52, -25.52, 0.0), SHEAR, True),
)
"""Beyond the corner the out-of-plane stress is the least compressive one in plane strain; in plane stress it always is
in biaxial compression, which caps the strength at UCS."""


@dataclass(frozen=True)
class Failed:
    """What befell the 2 x 2 cells at the centre of a block: the first failure and how many particles failed there."""

    path: Path
    factor: float  # of the path's stress, by the time of the first failure; NaN without one
    sigma_1: float
    sigma_3: float
    mode: int
    spread: float  # of sigma_1 and sigma_3 over those particles, over UCS
    count: int


def _lower(k: int) -> np.ndarray:
    """Lower corner of block k [m]; blocks stand in rows of 4."""
    return DX * (GAP + (CELLS + GAP) * np.array([k % 4, k // 4]))


def _scene(paths: list[Path], steps: int) -> Scene:
    rock = load_scene("intact").rock
    plane_stress = paths[0].plane_stress
    rock = replace(rock, elasticity=Hooke(E=E, nu=NU, plane_stress=plane_stress), viscosity=NoViscosity())
    corners = [_lower(k) for k in range(len(paths))]
    boxes = [Box(lower=tuple(low), upper=tuple(low + CELLS * DX)) for low in corners]
    upper = np.max(corners, axis=0) + DX * (CELLS + GAP)
    cfl = RELEASE / steps
    return Scene(
        title="Blocks strained to failure",
        domain=Domain(lower=(0.0, 0.0), upper=tuple(upper), dx=DX),
        bodies=tuple(Body(region=box, seeding=Lattice()) for box in boxes),
        rock=rock,
        loading=Loading(start=AtRest()),
        schedule=Schedule(t_end=1.1 * steps * cfl * DX / rock.wave_speed(), cfl=cfl),
        shape=Linear(),
    )


def _strain(paths: list[Path], steps: int) -> list[Failed]:
    """Give every block the velocity field of its path and let it fly: nothing but its own inertia strains it.

    The field is uniform until waves come in from the free faces, which have come a quarter of the way by failure.
    """
    drive = set_up(_scene(paths, steps))
    duration = (steps - 0.5) * drive.clock.dt  # until the envelope, which a path meets in the middle of a step
    particles, clock = drive.sim.particles, drive.clock
    x = particles.reference.to_numpy()
    v = np.zeros_like(x)
    middles = [_lower(k) + 0.5 * CELLS * DX for k in range(len(paths))]
    for path, middle in zip(paths, middles, strict=True):
        own = np.all(np.abs(x - middle) < 0.5 * CELLS * DX, axis=1)
        rate = path.reach / (1.1 * duration)
        v[own] = rate * (x[own] - middle) @ path.gradient()
    particles.v.from_numpy(v)
    drive.advance(clock.total)
    events = read_events(drive.sim)
    return [_failure(p, m, events, duration) for p, m in zip(paths, middles, strict=True)]


def _failure(path: Path, middle: np.ndarray, events: EventTable, duration: float) -> Failed:
    own = np.flatnonzero(np.all(np.abs(events.x - middle) < DX, axis=1))
    if len(own) == 0:
        return Failed(path, math.nan, math.nan, math.nan, 0, math.nan, 0)
    first, extremes = own[0], np.stack([events.sigma_1[own], events.sigma_3[own]])
    factor = path.reach / 1.1 * events.time[first] / duration
    mode, spread = int(events.mode[first]), float(np.ptp(extremes, axis=1).max() / UCS)
    return Failed(path, factor, events.sigma_1[first], events.sigma_3[first], mode, spread, len(own))


def _on_envelope(path: Path) -> float:
    """Factor of the path's stress at which it meets the envelope."""
    low, high = 0.0, path.reach
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if distance(path.sigma(np.array([middle])))[0] >= 1.0 else (middle, high)
    return high


def _row(failed: Failed, steps: int) -> Row:
    """The governing principal stress at the first failure: the largest if it is tension, else the smallest."""
    path = failed.path
    sigma_3, _, sigma_1 = np.linalg.eigvalsh(path.sigma(np.array([_on_envelope(path)])))[0]
    tension = path.mode == TENSION
    name, reference = ("sigma_1", sigma_1) if tension else ("sigma_3", sigma_3)
    got = failed.sigma_1 if tension else failed.sigma_3
    why = f"failure is found at the end of a step, and a step adds 1/{steps} of the stress"
    return relative(f"{name}, {path.name} [MPa]", 1e-6 * reference, 1e-6 * got, 1.0 / steps, why)


def envelope(full: bool) -> Outcome:
    """Stress at the first failure on the rays of PATHS against the envelope of all three principal stresses."""
    steps = 5000 if full else 1000
    failed = []
    for _, group in itertools.groupby(PATHS, key=lambda path: path.plane_stress):
        failed += _strain(list(group), steps)
    rows = [_row(one, steps) for one in failed if one.path.mode]
    wrong = sum(one.mode != one.path.mode for one in failed)
    rows.append(at_most("paths that fail in the wrong mode, or should not", wrong, 0.0, "modes are exact"))
    spread = np.max([one.spread for one in failed if one.path.mode])
    why = "a hundredth of a step's stress: what runs ahead of the waves from the free faces"
    rows.append(at_most("spread over the centre of a block / UCS", float(spread), 0.01 / steps, why))

    def draw(figure):
        for axes, plane_stress in zip(figure.subplots(1, 2), (False, True), strict=True):
            angles = np.radians(np.linspace(-135.0, 45.0, 1801))  # major in-plane stress, then minor
            rays = np.stack([np.cos(angles), np.sin(angles)])
            zz = 0.0 * angles if plane_stress else NU * rays.sum(axis=0)
            sigma = np.zeros((len(angles), 3, 3))
            sigma[:, 0, 0], sigma[:, 1, 1], sigma[:, 2, 2] = *rays, zz
            load = distance(1e6 * sigma)
            curve = np.where(load > 1.0 / 150.0, rays / np.maximum(load, 1e-9), np.nan)
            axes.plot(*curve, "k", linewidth=0.8, label="envelope")
            for one in failed:
                if one.path.plane_stress == plane_stress and one.path.mode and one.count:
                    minor, major = 1e-6 * np.linalg.eigvalsh(one.path.sigma(np.array([one.factor]))[0, :2, :2])
                    axes.plot(major, minor, "ox"[one.mode - 1], color=f"C{one.mode}", label=MODE_NAMES[one.mode])
            title = "plane stress" if plane_stress else "plane strain"
            axes.set(xlabel="larger in-plane stress [MPa]", ylabel="smaller in-plane stress [MPa]", title=title)
            entries = dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
            axes.legend(entries.values(), entries.keys(), fontsize="x-small")

    return Outcome(tuple(rows), draw)


CASES = (Case("envelope", "failure envelope along many stress paths, plane strain and plane stress", envelope),)
