"""Beams and plates with a cohesive crack, by finite elements.

The crack runs straight along the plane of symmetry, so half of the body is enough: bilinear quadrilaterals, condensed
to the nodes of the ligament. Those up to a tip are open and carry what softening leaves of the strength, the tip just
reaches the strength, the rest is closed; the load follows for one tip after the other (Hillerborg, Modeer & Petersson
1976, Cem. Concr. Res. 6:773; Petersson 1981, Report TVBM-1006, Lund, ch. 4). Needs the extra `reference`. No particle
and nothing of the solver is in it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

GROWTH, COARSEST = 1.08, 1.0 / 40.0
"""Of cells away from the ligament, and their largest size over the depth."""

ENOUGH = 0.98
"""Of the ligament that is cracked at most."""


@dataclass(frozen=True, kw_only=True)
class HalfBody:
    """Half a body, x >= 0, cracked along x = 0 from y = notch to y = depth [m]; E [Pa].

    length: of the half; span: between supports at y = 0 of a beam that a force presses at x = 0, y = depth, over the
    width `roller`; 0: a plate whose end x = length is pulled without turning and whose side y = depth is a mirror.
    gauge: distance over which the mouth's opening is read at y = 0.
    """

    depth: float
    notch: float
    length: float
    E: float
    nu: float
    plane_stress: bool = False
    span: float = 0.0
    roller: float = 0.0
    gauge: float = 0.0

    @property
    def plane_modulus(self) -> float:
        return self.E / (1.0 if self.plane_stress else 1.0 - self.nu**2)


@dataclass(frozen=True)
class Condensed:
    """Forces on the nodes of the ligament [n], K u + b load, of their half openings u; weights: length of each.

    mouth: row and constant of the gauge's half opening. The load is half of a beam's force, or half of
    a plate's lengthening.
    """

    K: np.ndarray
    b: np.ndarray
    weights: np.ndarray
    mouth: tuple[np.ndarray, float]


def _graded(start: float, end: float, first: float, largest: float) -> np.ndarray:
    """Ticks from start to end whose spacing grows from `first`."""
    steps = [first]
    while sum(steps) < abs(end - start):
        steps.append(min(steps[-1] * GROWTH, largest))
    ticks = np.cumsum([0.0, *steps])
    return start + (end - start) * ticks / ticks[-1]


def condensed(body: HalfBody, cells: int) -> Condensed:
    """cells: along the ligament."""
    import skfem
    from scipy.sparse.linalg import splu
    from skfem.models.elasticity import linear_elasticity

    size, largest = (body.depth - body.notch) / cells, COARSEST * body.depth
    y = np.linspace(body.notch, body.depth, cells + 1)
    if body.notch:
        y = np.concatenate([_graded(body.notch, 0.0, size, largest)[:0:-1], y])
    mesh = skfem.MeshQuad.init_tensor(_graded(0.0, body.length, size, largest), y)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad1()))
    mu = body.E / (2.0 * (1.0 + body.nu))
    lam = 2.0 * mu * body.nu / (1.0 - (1.0 if body.plane_stress else 2.0) * body.nu)
    K = linear_elasticity(lam, mu).assemble(basis).tocsc()
    x, along_x, along_y = mesh.p, *basis.nodal_dofs
    near = 1e-9 * body.depth
    ligament = along_x[(x[0] < near) & (x[1] > body.notch - near)]
    ligament = ligament[np.argsort(x[1][np.searchsorted(along_x, ligament)])]
    force, held = np.zeros(basis.N), np.zeros(basis.N, dtype=bool)
    if body.span:
        top = along_y[(x[1] > body.depth - near) & (x[0] <= 0.5 * body.roller + near)]
        force[top] = -1.0 / len(top)
        low = x[1] < near
        support = np.argmin(np.where(low, np.abs(x[0] - 0.5 * body.span), np.inf))
        held[along_y[support]] = True
    else:
        end = along_x[x[0] > body.length - near]
        force = -np.asarray(K[:, end].sum(axis=1)).ravel()
        held[end] = True
        held[along_y[x[1] > body.depth - near]] = True
    held[ligament] = True
    free = np.flatnonzero(~held)
    solved = splu(K[free][:, free]).solve(np.column_stack([force[free], K[free][:, ligament].toarray()]))
    by_load, by_opening = solved[:, 0], solved[:, 1:]
    across = K[ligament][:, free]
    stiffness = K[ligament][:, ligament].toarray() - across @ by_opening
    low = np.where(x[1] < near, np.abs(x[0] - 0.5 * body.gauge), np.inf)
    gauge = np.searchsorted(free, along_x[np.argmin(low)])
    weights = np.full(cells + 1, size)
    weights[[0, -1]] *= 0.5
    b = across @ by_load - force[ligament]
    return Condensed(stiffness, b, weights, (-by_opening[gauge], float(by_load[gauge])))


def growth(half: Condensed, strength: float, softening: Callable) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Load, opening of the mouth and force across the ligament, for one tip after the other.

    softening(w): stress across a crack that is open by w, and its slope.
    """
    K, b, weights = half.K, half.b, half.weights
    rows, u, load = [], np.zeros(0), 0.0
    for tip in range(int(ENOUGH * len(b))):
        u = np.append(u, 0.0)[:tip]
        for _ in range(60):
            stress, slope = softening(2.0 * u)
            miss = np.append(
                K[:tip, :tip] @ u + b[:tip] * load + weights[:tip] * stress,
                K[tip, :tip] @ u + b[tip] * load + weights[tip] * strength,
            )
            if np.abs(miss).max() < 1e-10 * strength * weights[1]:
                break
            tangent = np.empty((tip + 1, tip + 1))
            tangent[:, :tip], tangent[:, tip] = K[: tip + 1, :tip], b[: tip + 1]
            tangent[range(tip), range(tip)] += 2.0 * weights[:tip] * slope
            change = np.linalg.solve(tangent, -miss)
            u, load = u + change[:tip], load + change[tip]
        across = -(K[:, :tip] @ u + b * load).sum()
        rows.append((load, 2.0 * (half.mouth[0][:tip] @ u + half.mouth[1] * load), across))
    return tuple(np.array(rows).T)


def linear(strength: float, energy: float) -> Callable:
    """f (1 - w f/(2 G_f)), and its slope."""
    end = 2.0 * energy / strength

    def law(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return strength * np.clip(1.0 - w / end, 0.0, 1.0), np.where((w >= 0.0) & (w < end), -strength / end, 0.0)

    return law


def exponential(strength: float, energy: float) -> Callable:
    """f exp(-w f/G_f), and its slope."""

    def law(w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        stress = strength * np.exp(-np.maximum(w, 0.0) * strength / energy)
        return stress, -stress * strength / energy

    return law


def toughness_stress(body: HalfBody, energy: float, cells: int) -> float:
    """Nominal stress [Pa] of a pulled plate at which its energy release rate is `energy` [J/m^2], by how its force at
    a given lengthening falls with the notch's depth (Irwin & Kies 1954, Weld. J. 33:193s)."""

    def force(notch: float) -> float:
        return -float(condensed(replace(body, notch=notch), cells).b.sum())

    step = 0.005 * body.depth
    fall = (force(body.notch - step) - force(body.notch + step)) / (2.0 * step)
    return force(body.notch) * float(np.sqrt(energy / fall)) / body.depth
