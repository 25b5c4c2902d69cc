"""The material point method in NumPy: one time step of elastic rock, as the paper and the books have it. Read it first.

p2g.py, nodes.py and g2p.py do the same fast; tests hold them to this file, number by number. It shares no code with
them and takes the weights of all particles at all nodes, so it is for small scenes. Left out are failure (eq. 11 and
12), walls that move and force fields.

Indices: p particle, i node, d and e axes. Numbers in brackets are equations of the paper (README, references).
"""

from types import SimpleNamespace

import numpy as np

from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.spec.scene import Scene

PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
"""Entries of a symmetric tensor, as stress is packed: the first 4 in the plane, 6 in 3D."""


def tensor(packed: np.ndarray) -> np.ndarray:
    """Packed [n, 4 or 6] -> [n, 3, 3]."""
    full = np.zeros((len(packed), 3, 3))
    for k in range(packed.shape[1]):
        a, b = PLACES[k]
        full[:, a, b] = full[:, b, a] = packed[:, k]
    return full


def shape_function(shape, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """N and dN/dd at signed distances d [cells]: the hat, or its mean over [d - l, d + l].

    That mean is uGIMP, and with l = 1/2 the quadratic B-spline.
    """

    def hat(s):
        return np.maximum(1.0 - np.abs(s), 0.0)

    def integral(s):
        s = np.clip(s, -1.0, 1.0)
        return np.where(s < 0.0, 0.5 * (1.0 + s) ** 2, 1.0 - 0.5 * (1.0 - s) ** 2)

    name = type(shape).__name__
    if name == "Linear":
        return hat(d), np.where(np.abs(d) < 1.0, -np.sign(d), 0.0)
    l = {"Gimp": lambda: shape.half_width, "QuadraticBSpline": lambda: 0.5}[name]()
    return (integral(d + l) - integral(d - l)) / (2.0 * l), (hat(d + l) - hat(d - l)) / (2.0 * l)


class PlainStep:
    """One step of a scene from a state of its particles: reference, u, v, sigma (packed), J, volume (stress-free), C
    (affine matrix) and q (viscous pressure), each an array with a row per particle. `step` changes the state."""

    def __init__(self, scene: Scene, state: SimpleNamespace):
        grid, dim = Grid(scene), scene.dim
        self.scene, self.s, self.dx = scene, state, scene.domain.dx
        x = state.reference + state.u
        index = np.indices(grid.nodes).reshape(dim, -1).T
        self.from_particle = np.array(grid.origin) + index * self.dx - x[:, None]  # x_i - x_p, [p, i, d]
        axes = [self.axis_weights(x[:, d], d, grid.nodes[d], grid.origin[d]) for d in range(dim)]
        # w_ip is the product of one weight per axis; its gradient along e has the slope along e in place of the weight
        self.w = np.prod([w[:, index[:, d]] for d, (w, _) in enumerate(axes)], axis=0)
        self.grad_w = np.stack(
            [np.prod([axis[int(d == e)][:, index[:, d]] for d, axis in enumerate(axes)], axis=0) for e in range(dim)],
            axis=-1,
        )
        self.held = np.zeros((len(index), dim), dtype=bool)  # components that a wall holds at zero
        for b in scene.loading.boundaries:
            beyond = index[:, b.axis] - round((b.position - grid.origin[b.axis]) / self.dx)
            self.held[:, b.axis] |= beyond <= 0 if b.side == "lower" else beyond >= 0
        self.mass_p = scene.density * state.volume
        self.mass = self.w.T @ self.mass_p  # (8)

    def axis_weights(self, x: np.ndarray, axis: int, nodes: int, origin: float) -> tuple[np.ndarray, np.ndarray]:
        """w and dw/dx [p, node] along one axis. Functions that reach beyond a wall give v_-1 = 2 v_0 - v_1 there."""
        N, slope = shape_function(self.scene.shape, (x[:, None] - origin) / self.dx - np.arange(nodes))
        for b in self.scene.loading.boundaries:
            if b.axis == axis and self.scene.shape.width == 3:
                wall, outward = round((b.position - origin) / self.dx), -1 if b.side == "lower" else 1
                for part in (N, slope):
                    part[:, wall] += 2.0 * part[:, wall + outward]
                    part[:, wall - outward] -= part[:, wall + outward]
                    part[:, wall + outward] = 0.0
        return N, slope / self.dx

    def momentum(self) -> np.ndarray:
        """(m v)_i = sum_p w_ip m_p (v_p + C_p (x_i - x_p)), with C = 0 but for APIC; (7) divides it by m_i."""
        v_ip = self.s.v[:, None, :] + np.einsum("pde,pie->pid", self.s.C, self.from_particle)
        return np.einsum("p,pi,pid->id", self.mass_p, self.w, v_ip)

    def internal_force(self) -> np.ndarray:
        """f_i = - sum_p V_p (sigma_p - q_p) . grad w_ip: (9) with the total stress, and viscosity."""
        stress = tensor(self.s.sigma) - self.s.q[:, None, None] * np.eye(3)
        dim = self.scene.dim
        return -np.einsum("p,pde,pie->id", self.s.volume * self.s.J, stress[:, :dim, :dim], self.grad_w)

    def external_force(self) -> np.ndarray:
        """f_i = sum_p w_ip m_p b: (10). Mass scaling leaves a body's weight unchanged, so b falls as mass grows."""
        b = np.array(self.scene.loading.body_force or (0.0,) * self.scene.dim) / self.scene.time_scale**2
        return np.einsum("p,pi,d->id", self.mass_p, self.w, b)

    def per_mass(self, sums: np.ndarray) -> np.ndarray:
        return np.where(self.mass[:, None] > 0.0, sums / np.maximum(self.mass, 1e-300)[:, None], 0.0)

    def hold(self, v: np.ndarray) -> np.ndarray:
        return np.where(self.held, 0.0, v)

    def velocity_to_particles(self, v_i: np.ndarray, dv_i: np.ndarray) -> None:
        """PIC and FLIP mixed: v_p <- v_pic + flip (v_p + dv - v_pic); or APIC: v_pic, and C = B D^-1."""
        s, transfer = self.s, self.scene.transfer
        v_pic, dv = self.w @ v_i, self.w @ dv_i
        if type(transfer).__name__ == "Apic":
            D = np.einsum("pi,pie->pe", self.w, self.from_particle**2)
            s.C = np.einsum("pi,id,pie->pde", self.w, v_i, self.from_particle) / D[:, None, :]
            s.v = v_pic
        else:
            s.v = v_pic + transfer.flip * (s.v + dv - v_pic)

    def update_stress(self, v_i: np.ndarray, dt: float) -> None:
        """Hooke's law with the rotation of Hughes & Winget (1980), plane strain in the plane; then viscosity."""
        s, rock, dim = self.s, self.scene.rock, self.scene.dim
        L = np.zeros((len(s.v), 3, 3))
        L[:, :dim, :dim] = np.einsum("id,pie->pde", v_i, self.grad_w)
        s.J = s.J * np.linalg.det(np.eye(3) + dt * L)  # (1)
        G = dt * L @ np.linalg.inv(np.eye(3) + 0.5 * dt * L)
        W, strain = 0.5 * (G - G.transpose(0, 2, 1)), 0.5 * (G + G.transpose(0, 2, 1))
        R = np.linalg.solve(np.eye(3) - 0.5 * W, np.eye(3) + 0.5 * W)
        E, nu = rock.elasticity.E, rock.elasticity.nu
        lam, mu = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))
        dilation = np.trace(strain, axis1=1, axis2=2)[:, None, None]
        sigma = R @ tensor(s.sigma) @ R.transpose(0, 2, 1) + lam * dilation * np.eye(3) + 2.0 * mu * strain
        s.sigma = np.stack([sigma[:, a, b] for a, b in PLACES[: s.sigma.shape[1]]], axis=1)
        if rock.viscosity.acts:
            law, rate = rock.viscosity, np.minimum(np.trace(L, axis1=1, axis2=2), 0.0)
            density = self.scene.density / s.J
            s.q = density * self.dx * (law.c1 * self.dx * rate**2 - law.c2 * self.scene.wave_speed * rate)

    def step(self, dt: float) -> None:
        """The three orders differ in when stress is updated, and from which velocity."""
        order = self.scene.order
        old = self.per_mass(self.momentum())  # (7)
        if order == "usf":
            old = self.hold(old)
            self.update_stress(old, dt)
        force = self.internal_force() + self.external_force()
        new = self.hold(old + dt * self.per_mass(force))  # (2), and (4) at walls
        self.velocity_to_particles(new, new - old)
        if order == "usl":
            self.update_stress(new, dt)
        if order == "musl":  # from the velocity that the particles now have
            self.update_stress(self.hold(self.per_mass(self.momentum())), dt)
        self.s.u = self.s.u + dt * self.w @ new  # (6)
