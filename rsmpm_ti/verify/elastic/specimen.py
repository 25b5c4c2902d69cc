"""The intact specimen, whose uniform state is known: moduli and strengths in plane strain and plane stress."""

from dataclasses import replace

import numpy as np

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.cases.case import Case, Outcome, at_most, difference, relative
from rsmpm_ti.cases.static_state import static_state
from rsmpm_ti.method.shape import Linear, QuadraticBSpline
from rsmpm_ti.rock.elasticity import Hooke

E, NU = 17e9, 0.14
UCS = 25.520e6
"""2 c cos(phi)/(1 - sin(phi)) of c = 5.95 MPa, phi = 40 degrees [Pa]."""


def _compress(dx: float, plane_stress: bool, **keywords):
    scene = load_scene("intact", dx=dx, **keywords)
    rock = replace(scene.rock, elasticity=Hooke(E=E, nu=NU, plane_stress=plane_stress))
    return simulate(replace(scene, rock=rock, shape=Linear()))


def uniaxial(full: bool) -> Outcome:
    """Modulus E/(1 - nu^2) or E; first failure at the uniaxial strength in both, at 2 MPa in direct tension."""
    dx, rows, curves = 0.5e-3 if full else 1e-3, [], []
    for plane_stress, modulus in ((False, E / (1.0 - NU**2)), (True, E)):
        plane = "plane stress" if plane_stress else "plane strain"
        result = _compress(dx, plane_stress, strain_end=1.6e-3, time_scale=40.0)
        curves.append((plane, modulus, result.history))
        why = "log and engineering strain differ by 0.07 % over the fit; the rest is inertia of the scaled mass"
        rows.append(relative(f"modulus, {plane} [Pa]", modulus, result.summary["apparent_modulus_Pa"], 0.002, why))
        why = "a history row is 0.1 % of the load, and the affine start leaves no first wave; the rest is a margin"
        strength = result.summary["first_failure_stress_Pa"]
        rows.append(relative(f"first failure, {plane} [Pa]", UCS, strength, 0.01, why))
    pulled = _compress(dx, False, strain_end=-1.2e-4, time_scale=10.0).summary
    why = "rows of 0.1 % of the load, and the waves of a run with mass scaling"
    rows.append(relative("direct tension, first failure [Pa]", -2e6, pulled["first_failure_stress_Pa"], 0.01, why))
    why = "the label itself: 1 is tension"
    rows.append(difference("direct tension, label", 1.0, float(pulled["first_failure_mode"] == "tension"), 0.0, why))

    def draw(figure):
        axes = figure.subplots()
        for plane, modulus, history in curves:
            line = axes.plot(1e3 * history["axial_strain"], 1e-6 * history["stress_top_Pa"], label=plane)[0]
            strain = np.array([0.0, UCS / modulus])
            axes.plot(1e3 * strain, 1e-6 * modulus * strain, "--", color=line.get_color(), label=f"exact, {plane}")
        axes.axhline(1e-6 * UCS, color="0.5", linewidth=0.8)
        axes.set(xlabel="axial strain [1e-3]", ylabel="nominal stress [MPa]", title="Intact specimen")
        axes.legend()

    return Outcome(tuple(rows), draw)


def platen_edge(full: bool) -> Outcome:
    """Uniform compression between platens with B-splines: no stress error beside them. Plain ones would break rock."""
    scene = load_scene("intact", dx=0.5e-3 if full else 1e-3)
    state = static_state(replace(scene, shape=QuadraticBSpline()))
    x, sigma = state.snapshot.x, state.sigma / state.nominal
    beside = (x[:, 1] < 1.5 * scene.domain.dx) | (x[:, 1] > 0.1 - 1.5 * scene.domain.dx)
    axial, lateral = np.abs(sigma[beside][:, 1, 1] + 1.0).max(), np.abs(sigma[beside][:, 0, 0]).max()
    why = "linear fields are exact at walls, what swings is 0.1 %; a per cent would move the first failure there"
    rows = (at_most("axial stress error", axial, 0.01, why), at_most("lateral stress / axial", lateral, 0.01, why))

    def draw(figure):
        axes = figure.subplots()
        axes.plot(-sigma[:, 1, 1], 1e3 * x[:, 1], ".", markersize=1)
        axes.axvline(1.0, color="k", linewidth=0.8)
        axes.set(xlabel="axial stress / nominal", ylabel="height [mm]", title="Uniform compression, quadratic B-spline")

    return Outcome(rows, draw)


CASES = (
    Case("uniaxial", "modulus and strength of the intact specimen, plane strain and plane stress", uniaxial),
    Case("platen_edge", "B-splines beside a platen in uniform compression", platen_edge),
)
