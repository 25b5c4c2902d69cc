"""One time step of the material point method in NumPy, written from the books: what whole steps are compared with."""

from types import SimpleNamespace

import numpy as np
from exact import lame, shape_function

from rsmpm_ti.fields.grid import MARGIN
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.spec.scene import Scene

PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))


def axis_weights(scene: Scene, x: np.ndarray, axis: int, nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """(w [n, node], dw/dx [n, node]) along one axis for all nodes; v_-1 = 2 v_0 - v_1 beyond walls."""
    d = x[:, axis, None] / scene.domain.dx + MARGIN - np.arange(nodes)
    parts = [part.copy() for part in shape_function(scene.shape)(d)]
    for boundary in scene.loading.boundaries:
        if boundary.axis == axis and scene.shape.width == 3:
            wall, outward = round(boundary.position / scene.domain.dx) + MARGIN, -1 if boundary.side == "lower" else 1
            for part in parts:
                beyond = part[:, wall + outward].copy()
                part[:, wall] += 2.0 * beyond
                part[:, wall - outward] -= beyond
                part[:, wall + outward] = 0.0
    return parts[0], parts[1] / scene.domain.dx


class Reference:
    """One time step of the material point method as the books have it: dense weights, no runs, no stripes."""

    def __init__(self, sim: Simulation, state: SimpleNamespace):
        self.scene, self.s, self.dx = sim.scene, state, sim.scene.domain.dx
        shape, dim = sim.grid.nodes, sim.dim
        axes = [axis_weights(self.scene, state.reference, d, shape[d]) for d in range(dim)]
        letters = "ijk"[:dim]
        product = ",".join("p" + c for c in letters) + "->p" + letters

        def combined(*factors):
            return np.einsum(product, *factors).reshape(len(state.reference), -1)

        self.w = combined(*(a[0] for a in axes))
        self.g = np.stack([combined(*(a[int(d == e)] for d, a in enumerate(axes))) for e in range(dim)], axis=-1)
        index = np.indices(shape).reshape(dim, -1).T
        self.node_x = (index - MARGIN) * self.dx
        self.away = self.node_x[None] - state.reference[:, None]  # x_i - x_p
        self.held = np.zeros((len(index), dim), dtype=bool)
        for b in self.scene.loading.boundaries:
            beyond = index[:, b.axis] - round(b.position / self.dx) - MARGIN
            self.held[:, b.axis] |= beyond <= 0 if b.side == "lower" else beyond >= 0
        self.mass_p = self.scene.density * state.volume
        self.mass = self.w.T @ self.mass_p

    def momentum(self) -> np.ndarray:
        carried = self.s.v[:, None, :] + np.einsum("pde,pie->pid", self.s.C, self.away)
        return np.einsum("p,pi,pid->id", self.mass_p, self.w, carried)

    def force(self) -> np.ndarray:
        dim = self.scene.dim
        total = tensor(self.s.sigma) - self.s.q[:, None, None] * np.eye(3)
        return -np.einsum("p,pde,pie->id", self.s.volume * self.s.J, total[:, :dim, :dim], self.g)

    def hold(self, v) -> np.ndarray:
        return np.where(self.held, 0.0, v)

    def over_mass(self, field) -> np.ndarray:
        return np.where(self.mass[:, None] > 0.0, field / np.maximum(self.mass, 1e-300)[:, None], 0.0)

    def to_particles(self, v_i, dv_i) -> None:
        transfer, s = self.scene.transfer, self.s
        v_pic, dv = self.w @ v_i, self.w @ dv_i
        if isinstance(transfer, Apic):
            inertia = np.einsum("pi,pie->pe", self.w, self.away**2)
            s.C = np.einsum("pi,id,pie->pde", self.w, v_i, self.away) / inertia[:, None, :]
            s.v = v_pic
        else:
            assert isinstance(transfer, PicFlip), f"give the formula of the new transfer {transfer}"
            s.v = v_pic + transfer.flip * (s.v + dv - v_pic)

    def stress(self, v_i, dt) -> None:
        """Hooke with the Hughes-Winget rotation, plane strain in the plane; then viscosity from the same gradient."""
        s, elasticity, dim = self.s, self.scene.rock.elasticity, self.scene.dim
        L = np.zeros((len(s.reference), 3, 3))
        L[:, :dim, :dim] = np.einsum("id,pie->pde", v_i, self.g)
        s.J = s.J * np.linalg.det(np.eye(3) + dt * L)
        G = dt * L @ np.linalg.inv(np.eye(3) + 0.5 * dt * L)
        W, D = 0.5 * (G - G.transpose(0, 2, 1)), 0.5 * (G + G.transpose(0, 2, 1))
        R = np.linalg.solve(np.eye(3) - 0.5 * W, np.eye(3) + 0.5 * W)
        lam, mu = lame(elasticity.E, elasticity.nu)
        dilation = np.trace(D, axis1=1, axis2=2)[:, None, None]
        full = R @ tensor(s.sigma) @ R.transpose(0, 2, 1) + lam * dilation * np.eye(3) + 2.0 * mu * D
        s.sigma = np.stack([full[:, a, b] for a, b in PLACES[: s.sigma.shape[1]]], axis=1)
        if self.scene.rock.viscosity.acts:
            law, rate = self.scene.rock.viscosity, np.minimum(np.trace(L, axis1=1, axis2=2), 0.0)
            speed, density = self.scene.wave_speed, self.scene.density / s.J
            s.q = density * self.dx * (law.c1 * self.dx * rate**2 - law.c2 * speed * rate)

    def step(self, order: str, dt: float) -> None:
        momentum = self.momentum()
        if order == "usf":
            self.stress(self.hold(self.over_mass(momentum)), dt)
            old = self.hold(self.over_mass(momentum))
        else:
            old = self.over_mass(momentum)
        new = self.hold(old + dt * self.over_mass(self.force()))
        self.to_particles(new, new - old)
        if order == "usl":
            self.stress(new, dt)
        elif order == "musl":
            self.stress(self.hold(self.over_mass(self.momentum())), dt)
        else:
            assert order == "usf", f"write the new order {order} into the reference"
        self.s.u = dt * self.w @ new


def tensor(packed) -> np.ndarray:
    """Packed [n, 4 or 6] -> [n, 3, 3], from the definition of the packing."""
    full = np.zeros((len(packed), 3, 3))
    for k in range(packed.shape[1]):
        a, b = PLACES[k]
        full[:, a, b] = full[:, b, a] = packed[:, k]
    return full
