"""python -m rsmpm_ti.verify.reference.half_disc: stiffness and K_I of a notched half disc, by finite elements.

Half of it, mapped from a square: quadratic quadrilaterals, rollers that hold the edge over a width, plane strain. K_I
follows from how the compliance grows with the notch, G = P^2/2 dC/da = K_I^2/E' (Irwin & Kies 1954, Weld. J. 33:193s).
All lengths over the radius, loads over radius and plane modulus. Needs the extra `reference`.
"""

import math
import sys

import numpy as np

from rsmpm_ti.setups.semicircular import NOTCH_RATIO, SPAN, stress_intensity

CELLS = 40
"""Along each edge of the square."""

POISSON, ROLLER = 0.25, 0.05
"""The rock's, and the width of a roller over the radius."""


def on_disc(square: np.ndarray) -> np.ndarray:
    """Points of the unit square [2, n] on a quarter of the unit disc; what lies on the axes stays."""
    x, y = square
    return np.array([x * np.sqrt(1.0 - 0.5 * y**2), y * np.sqrt(1.0 - 0.5 * x**2)])


def stiffness(notch: float, roller: float = ROLLER, cells: int = CELLS) -> float:
    """Load on the upper roller over its deflection, per thickness and plane modulus; notch: a whole number of cells."""
    from skfem import Basis, BilinearForm, ElementQuad2, ElementVector, MeshQuad, MeshQuad2, condense, solve
    from skfem.helpers import ddot, eye, sym_grad, trace

    ticks = np.linspace(0.0, 1.0, cells + 1)
    square = MeshQuad2.from_mesh(MeshQuad.init_tensor(ticks, ticks))
    basis = Basis(MeshQuad2(on_disc(square.doflocs), square.t), ElementVector(ElementQuad2()))
    mu = 0.5 * (1.0 - POISSON)
    lam = 2.0 * mu * POISSON / (1.0 - 2.0 * POISSON)

    @BilinearForm
    def energy(u, v, _):
        strain = sym_grad(u)
        return ddot(2.0 * mu * strain + lam * eye(trace(strain), 2), sym_grad(v))

    along_x, along_y = (
        np.concatenate([dofs[axis] for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs)])
        for axis in (0, 1)
    )
    (x, y), near = basis.doflocs, 1e-9
    middle = along_x[(x[along_x] < near) & (y[along_x] > notch - near)]
    on_support = (y[along_y] < near) & (np.abs(x[along_y] - SPAN) < 0.5 * roller + near)
    on_top = (np.hypot(x[along_y], y[along_y]) > 1.0 - near) & (x[along_y] < 0.5 * roller + near)
    top, held = along_y[on_top], np.concatenate([middle, along_y[on_support], along_y[on_top]])
    u = basis.zeros()
    u[top] = -1.0
    K = energy.assemble(basis)
    u = solve(*condense(K, x=u, D=held))
    return -2.0 * float((K @ u)[top].sum())


def toughness_ratio(roller: float = ROLLER, cells: int = CELLS) -> float:
    """K_I of a load by finite elements over that by the formula of the standard."""
    step = 1.0 / cells
    soft, stiff = (1.0 / stiffness(NOTCH_RATIO + sign * step, roller, cells) for sign in (1.0, -1.0))
    K_I = math.sqrt(0.5 * (soft - stiff) / (2.0 * step))
    return K_I / stress_intensity(1.0, radius=1.0, notch=NOTCH_RATIO, span=2.0 * SPAN)


def main() -> int:
    for cells in (CELLS // 2, CELLS, 2 * CELLS):
        print(f"{cells} cells: stiffness {stiffness(NOTCH_RATIO, cells=cells):.4f}", end="")
        for roller in (ROLLER, 0.5 * ROLLER):
            change = 100.0 * (toughness_ratio(roller, cells) - 1.0)
            print(f"; rollers of {roller:g}: K_I {change:+.1f} % off the formula", end="")
        print()
    return 0


if __name__ == "__main__":
    sys.exit(main())
