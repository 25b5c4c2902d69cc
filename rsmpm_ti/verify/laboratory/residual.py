"""Lab rock in a jacket to the end of its test: peak and residual strength, with `time_scale = auto` as a user gives it.

Peak: Mohr-Coulomb's line, sigma_1 = UCS + N_phi p. Residual: a fault slides with the residual friction angle phi_r
and no cohesion. On the plane that carries least, at 45 + phi_r/2, that is N_r p, N_r = tan^2(45 + phi_r/2) (Coulomb;
Jaeger, Cook & Zimmerman 2007, sec. 3.3). Rock in the fault that flows at constant volume need not have its worst plane
along it: on a plane of no extension it carries no more than tan(phi*) = sin(phi_r) (Davis 1968, in Lee (ed.), Soil
Mechanics: Selected Topics, 341; Vermeer 1990, Geotechnique 40:223, sec. 3). So the residual lies from N* p, with phi*
for phi_r, to N_r p, as the mean over the last tenth of the strain.

On a lattice all is symmetric, and two faults cross and hold each other. Rock is not symmetric. Particles moved by a
hundredth of their spacing choose one fault.
"""

import math
from dataclasses import replace

import numpy as np

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.analysis.load_curve import FilteredLoad, loading_curve
from rsmpm_ti.cases.case import Case, Outcome, Row, at_least, at_most, relative
from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import LinearSoftening
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.seeding import Jittered
from rsmpm_ti.verify.laboratory.strength_tests import ROCKS, strength

PRESSURES = (0.0, 5e6, 10e6, 20e6, 40e6)
"""Of the jacket [Pa]."""

RESIDUAL_ANGLE, DX = 35.0, 1e-3
ENERGIES = LinearSoftening(G_f_I=60.0, G_f_II=2000.0)
"""Of a granite [J/m^2]: G_f_I of K_Ic = 1.9 MPa sqrt(m); G_f_II of shear under pressure, Wong (1982), J. Geophys. Res.
87:990, table 3: 10^3 to 10^4."""

BEYOND = 2.2
"""Strain at the end over that at the peak: a fault has then slipped by what its loss of strength takes."""


FAULT = "a fault within seven degrees of the weakest plane, and what is left of its length as it slips"


def specimen(pressure: float) -> Scene:
    """The scene `intact` of granite with cracks, in cells of 1 mm."""
    granite = ROCKS["granite"]
    law = Directional(residual_friction_angle=RESIDUAL_ANGLE, softening=ENERGIES)
    rock = replace(granite, after_failure=law, nonlocal_mean=Nonlocal(length=2.0 * DX))
    E, nu = rock.elasticity.E, rock.elasticity.nu
    strain = BEYOND * (strength(rock, pressure) - pressure) * (1.0 - nu**2) / E
    scene = load_scene("intact", dx=DX, strain_end=strain, time_scale="auto")
    bodies = tuple(replace(body, seeding=Jittered(amount=0.01)) for body in scene.bodies)
    return replace(scene, rock=rock, bodies=bodies, loading=replace(scene.loading, confinement=pressure))


def _tested(pressure: float) -> tuple[list[Row], np.ndarray]:
    """Rows, and the history."""
    scene = specimen(pressure)
    history = simulate(scene).history
    peak = FilteredLoad(scene).see_all(history).peak
    late = history["axial_strain"] > 0.9 * scene.schedule.strain_end
    residual, name = float(nominal_stress(history)[late].mean()), f"p = {1e-6 * pressure:g} MPa"
    read = "inertia and the reading of a peak, 1 % each"
    rows = [relative(f"peak, {name} [Pa]", strength(scene.rock, pressure), peak, 0.02, read)]
    if pressure:
        davis = math.degrees(math.atan(math.sin(math.radians(RESIDUAL_ANGLE))))
        most, least = (math.tan(math.radians(45.0 + 0.5 * angle)) ** 2 * pressure for angle in (RESIDUAL_ANGLE, davis))
        rows.append(at_most(f"residual over Coulomb's, {name}", residual / most, 1.05, FAULT))
        rows.append(at_least(f"residual over Davis', {name}", residual / least, 0.95, FAULT))
    return rows, history


def residual(full: bool) -> Outcome:
    """Every pressure. quick: one."""
    pressures = PRESSURES if full else PRESSURES[3:4]
    tested = [_tested(pressure) for pressure in pressures]

    def draw(figure):
        axes = figure.subplots()
        for pressure, (rows, history) in zip(pressures, tested, strict=True):
            _, stress, strain = loading_curve(history)
            (line,) = axes.plot(100.0 * strain, 1e-6 * stress, label=f"p = {1e-6 * pressure:g} MPa", linewidth=0.9)
            axes.axhline(1e-6 * rows[0].reference, color=line.get_color(), linestyle=":", linewidth=0.8)
        axes.set(
            xlabel="axial strain [%]", ylabel="axial stress [MPa]", title="granite in a jacket; dotted: Mohr-Coulomb"
        )
        axes.legend()

    return Outcome(tuple(row for rows, _ in tested for row in rows), draw)


CASES = (Case("lab_residual", "peak and residual strength of cracking rock in a jacket, time_scale auto", residual),)
