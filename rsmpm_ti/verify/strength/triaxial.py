"""Triaxial compression: an intact specimen under confining pressure, whose uniform state is known up to failure.

From sigma = -p 1 the axial stress alone changes, by -q; sides stay at -p, and plane strain adds nu times the sum of
the in-plane increments: sigma_zz = -p - nu q. For 0 <= nu <= 1 that lies between -p and -p - q, so it is the
intermediate principal stress at every p, and failure comes on Mohr-Coulomb's line p + q = UCS + N_phi p.

In rock strained within the plane from the stress-free state sigma_zz is nu (sigma_xx + sigma_yy) instead. Beyond
p = 16.5 MPa it is the least compressive stress there and lowers the line to 71.65 MPa + 1.808 p (case `envelope`). A
sample in a pressure vessel does not start so: the fluid presses on its faces out of the plane too. So p = 30 MPa is
on the same line as the others, at 163.5 MPa; the other one would have 125.9 MPa.
"""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti import load_scene
from rsmpm_ti.analysis.summary import summarise
from rsmpm_ti.cases.case import Case, Outcome, at_most, difference, relative
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.records.snapshot import SHEAR
from rsmpm_ti.solver.history import History
from rsmpm_ti.solver.readout import read_events, take_snapshot
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.regions import Box, Disc
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered, Lattice

E, NU, DENSITY = 17e9, 0.14, 2600.0
UCS, N_PHI = 25.520e6, 4.5989
"""2 c cos(phi)/(1 - sin(phi)) [Pa] and tan^2(45 + phi/2) of c = 5.95 MPa, phi = 40 degrees."""

PRESSURES, QUICK = (0.0, 5e6, 10e6, 15e6, 30e6), (5e6, 30e6)
"""Confining pressures [Pa], all and those of the quick form: each compiles its own kernels."""

SIZE, DX = (10e-3, 20e-3), 1e-3
HALF_WAY = 0.5
"""Fraction of the load increment at failure at which strains and the stress out of the plane are read."""


@dataclass(frozen=True)
class Tested:
    """One specimen: half way to failure, and at failure. Stresses as increments from -p, tension positive [Pa]."""

    p: float
    axial_stress: float
    axial_strain: float  # logarithmic, of the particles' own displacements, as the lateral one
    lateral_strain: float
    zz_excess: float  # d_sigma_zz - nu (d_sigma_xx + d_sigma_yy)
    strength: float  # axial stress by the platens at the first failure, compression positive
    criterion: float  # sigma_3 of the first failure, compression positive
    shear: bool  # its label
    history: np.ndarray


def increment(p: float) -> float:
    """Axial stress at failure less the pressure [Pa]."""
    return UCS + (N_PHI - 1.0) * p


def _scene(p: float, steps: int) -> Scene:
    strain = 1.02 * increment(p) * (1.0 - NU**2) / E
    rock = load_scene("intact").rock
    cfl = 0.5
    duration = steps * cfl * DX / rock.wave_speed()  # without mass scaling: inertia then is that of a fast test
    speed = 0.5 * strain * SIZE[1] / duration
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=speed),
        Platen(axis=1, side="upper", position=SIZE[1], speed=-speed),
    )
    return Scene(
        title="Triaxial test of an intact specimen",
        domain=Domain(lower=(-2.0 * DX, 0.0), upper=(SIZE[0] + 2.0 * DX, SIZE[1]), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=SIZE), seeding=Lattice()),),
        rock=rock,
        loading=Loading(boundaries=platens, start=Affine(), width=SIZE[0], confinement=p),
        schedule=Schedule(strain_end=strain, cfl=cfl),
        shape=Linear(),
    )


def _test(p: float, steps: int) -> Tested:
    scene = _scene(p, steps)
    drive = set_up(scene)
    history = History(drive.sim, drive.clock, drive.survey)
    every = max(1, steps // 200)
    middle = None
    while not drive.clock.done and (middle is None or not history.failed):
        drive.advance(every)
        history.record(drive.survey)
        if middle is None and drive.clock.step >= HALF_WAY * steps / 1.02:
            middle = take_snapshot(drive.sim, drive.clock.time)
    start = middle.x - middle.displacement
    slopes = [np.polyfit(start[:, d], middle.displacement[:, d], 1)[0] for d in range(2)]
    change = (middle.sigma + p * np.eye(3)).mean(axis=0)
    events, rows = read_events(drive.sim), history.table()
    numbers = summarise(scene, rows, events, history.energy_start)
    return Tested(
        p=p,
        axial_stress=change[1, 1],
        axial_strain=math.log1p(slopes[1]),
        lateral_strain=math.log1p(slopes[0]),
        zz_excess=change[2, 2] - NU * (change[0, 0] + change[1, 1]),
        strength=numbers["first_failure_stress_Pa"] or math.nan,
        criterion=-float(events.sigma_3[0]) if len(events) else math.nan,
        shear=len(events) > 0 and bool(np.all(events.mode == SHEAR)),
        history=rows,
    )


def _resting_disc(p: float) -> float:
    """Largest speed of a jittered disc in stairs under pressure, after 20 steps, over p/(rho c)."""
    rock = load_scene("intact").rock
    disc = Body(region=Disc(centre=(0.0, 0.0), radius=5.3 * DX), seeding=Jittered(amount=0.3))
    edge = (8.0 * DX,) * 2
    scene = Scene(
        title="Disc under pressure",
        domain=Domain(lower=tuple(-e for e in edge), upper=edge, dx=DX),
        bodies=(disc,),
        rock=rock,
        loading=Loading(confinement=p),
        schedule=Schedule(t_end=1.0),
        shape=Linear(),
    )
    drive = set_up(scene)
    drive.advance(20)
    return drive.survey.speed / (p / (rock.density * rock.wave_speed()))


def triaxial(full: bool) -> Outcome:
    """Strength UCS + N_phi p, Hooke's strains and stress out of the plane; a disc at rest under pressure."""
    steps = 4000 if full else 1000
    tests, rows = [_test(p, steps) for p in (PRESSURES if full else QUICK)], []
    for test in tests:
        mega = f"p = {1e-6 * test.p:g} MPa"
        strength = UCS + N_PHI * test.p
        # 0.8 % of the platens' part at 30 MPa, of which bulging sides give 0.13 % back; then inertia
        why = "particles in the end cells shrink before others follow, so platens read less by the axial strain"
        rows.append(relative(f"first failure, {mega} [Pa]", strength, test.strength, 0.01, why))
        why = f"a step adds 1/{steps} of the load; inertia of a fast test leaves a little tension across it"
        rows.append(relative(f"sigma_3 of it, {mega} [Pa]", strength, test.criterion, 1.5 / steps, why))
        rows.append(difference(f"label, {mega}", 1.0, float(test.shear), 0.0, "1: every failure is labelled shear"))
        why = "Hooke's law in rates gives logarithmic strain its stress; the rest is inertia of a fast test"
        axial, lateral = (1.0 - NU**2) / E * test.axial_stress, -NU * (1.0 + NU) / E * test.axial_stress
        rows.append(relative(f"axial strain, {mega}", axial, test.axial_strain, 0.005, why))
        rows.append(relative(f"lateral strain, {mega}", lateral, test.lateral_strain, 0.005, why))
        excess = abs(test.zz_excess / test.axial_stress)
        rows.append(at_most(f"sigma_zz beside Hooke / axial, {mega}", excess, 1e-9, "the law itself, to round-off"))
    if full:
        why = "sigma + p 1 is zero to the last bit wherever particles lie, so nothing ever moves"
        rows.append(at_most("speed of a disc under 10 MPa / (p/(rho c))", _resting_disc(10e6), 0.0, why))

    def draw(figure):
        curves, line = figure.subplots(1, 2)
        for test in tests:
            stress = 1e-6 * nominal_stress(test.history)
            curves.plot(1e3 * test.history["axial_strain"], stress, label=f"p = {1e-6 * test.p:g} MPa")
        curves.set(xlabel="axial strain [1e-3]", ylabel="axial stress [MPa]", title="Up to the first failure")
        curves.legend(fontsize="small")
        p = 1e-6 * np.array([0.0, PRESSURES[-1]])
        line.plot(p, 1e-6 * UCS + N_PHI * p, "k", linewidth=0.8, label="UCS + N_phi p")
        line.plot([1e-6 * t.p for t in tests], [1e-6 * t.strength for t in tests], "o", label="first failure")
        line.set(xlabel="confining pressure [MPa]", ylabel="axial stress [MPa]", title="Strength")
        line.legend(fontsize="small")

    return Outcome(tuple(rows), draw)


CASES = (Case("triaxial", "strength and strains under confining pressure, and a disc at rest in it", triaxial),)
