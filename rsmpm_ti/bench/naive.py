"""The scheme as one would first write it in Taichi, a thread per particle and atomic adds: speed is held against it.

80 000 particles (100 x 200 cells of 0.5 mm, 2 x 2 per cell), linear functions or quadratic B-splines, stress updated
last with the explicit Jaumann rate, tension and Mohr-Coulomb check; no J, no viscosity, no boundaries, no records. It
does less than a step of the solver, so a ratio against it is on the safe side. twin.cpp is the same scheme by hand.
"""

import math

import numpy as np
import taichi as ti

NX, NY, PAD, DX = 100, 200, 4, 0.5e-3
E, NU, RHO, COHESION, PHI, TENSILE = 17e9, 0.14, 2600.0, 5.95e6, math.radians(40.0), 2e6


@ti.data_oriented
class Naive:
    """Particles and nodes of the yardstick; `step()` advances once. `width`: 2 linear functions, 3 B-splines."""

    def __init__(self, width: int, real=ti.f64):
        self.width, self.shift = width, (0.0, 0.5)[width - 2]
        self.count, self.inv_dx = 4 * NX * NY, 1.0 / DX
        self.lam, self.mu = E * NU / ((1 + NU) * (1 - 2 * NU)), E / 2 / (1 + NU)
        self.dt = 0.5 * DX / math.sqrt((self.lam + 2 * self.mu) / RHO)
        self.mass, self.c_cos, self.sin = RHO * DX * DX / 4, COHESION * math.cos(PHI), math.sin(PHI)
        self.x, self.v = ti.Vector.field(2, real, self.count), ti.Vector.field(2, real, self.count)
        self.sigma = ti.Vector.field(4, real, self.count)  # xx, yy, xy, zz
        self.volume, self.failed = ti.field(real, self.count), ti.field(ti.i32, self.count)
        nodes = (NX + 2 * PAD, NY + 2 * PAD)
        self.node_mass = ti.field(real, nodes)
        self.node_v, self.node_f = ti.Vector.field(2, real, nodes), ti.Vector.field(2, real, nodes)
        i, j = np.meshgrid(np.arange(2 * NX), np.arange(2 * NY), indexing="ij")
        x = (np.stack([i, j], -1).reshape(-1, 2) + 0.5) * DX / 2 + PAD * DX
        self.x.from_numpy(x.astype(np.float64 if real == ti.f64 else np.float32))
        self.volume.fill(DX * DX / 4)
        self.v.fill(0.01)

    def step(self) -> None:
        self.clear()
        self.p2g()
        self.update_nodes()
        self.g2p()

    @ti.kernel
    def clear(self):
        for i in ti.grouped(self.node_mass):
            self.node_mass[i] = 0.0
            self.node_v[i] = ti.Vector([0.0, 0.0])
            self.node_f[i] = ti.Vector([0.0, 0.0])

    @ti.func
    def position(self, p):
        """Base node of a particle, its weights [width, 2], and their gradients."""
        xi = self.x[p] * self.inv_dx
        base = ti.floor(xi - self.shift).cast(int)
        r = xi - base
        w, dw = ti.Matrix.zero(float, self.width, 2), ti.Matrix.zero(float, self.width, 2)
        if ti.static(self.width == 2):
            w, dw = ti.Matrix.rows([1.0 - r, r]), ti.Matrix.rows([0.0 * r - self.inv_dx, 0.0 * r + self.inv_dx])
        else:
            w = ti.Matrix.rows([0.5 * (1.5 - r) ** 2, 0.75 - (r - 1.0) ** 2, 0.5 * (r - 0.5) ** 2])
            dw = self.inv_dx * ti.Matrix.rows([r - 1.5, -2.0 * (r - 1.0), r - 0.5])
        return base, w, dw

    @ti.kernel
    def p2g(self):
        for p in range(self.count):
            base, w, dw = self.position(p)
            s = self.sigma[p] * self.volume[p]
            for a, b in ti.static(ti.ndrange(self.width, self.width)):
                g = ti.Vector([dw[a, 0] * w[b, 1], w[a, 0] * dw[b, 1]])
                i, w_ip = base + ti.Vector([a, b]), w[a, 0] * w[b, 1]
                self.node_mass[i] += w_ip * self.mass
                self.node_v[i] += w_ip * self.mass * self.v[p]
                self.node_f[i] -= ti.Vector([s[0] * g[0] + s[2] * g[1], s[2] * g[0] + s[1] * g[1]])

    @ti.kernel
    def update_nodes(self):
        for i in ti.grouped(self.node_mass):
            if self.node_mass[i] > 1e-12:
                dv = self.dt * self.node_f[i] / self.node_mass[i]
                self.node_v[i] = self.node_v[i] / self.node_mass[i] + dv
                self.node_f[i] = dv

    @ti.kernel
    def g2p(self):
        for p in range(self.count):
            base, w, dw = self.position(p)
            v_pic, dv, L = ti.Vector([0.0, 0.0]), ti.Vector([0.0, 0.0]), ti.Matrix([[0.0, 0.0], [0.0, 0.0]])
            for a, b in ti.static(ti.ndrange(self.width, self.width)):
                g = ti.Vector([dw[a, 0] * w[b, 1], w[a, 0] * dw[b, 1]])
                i, w_ip = base + ti.Vector([a, b]), w[a, 0] * w[b, 1]
                v_pic += w_ip * self.node_v[i]
                dv += w_ip * self.node_f[i]
                L += self.node_v[i].outer_product(g)
            self.x[p] += self.dt * v_pic
            self.v[p] += dv
            self.update_stress(p, L)

    @ti.func
    def update_stress(self, p, L):
        xx_, yy_, xy_ = L[0, 0] * self.dt, L[1, 1] * self.dt, 0.5 * (L[0, 1] + L[1, 0]) * self.dt
        w, tr = 0.5 * (L[1, 0] - L[0, 1]) * self.dt, xx_ + yy_
        self.volume[p] *= 1 + tr
        s = self.sigma[p]
        xx = s[0] - 2 * w * s[2] + self.lam * tr + 2 * self.mu * xx_
        yy = s[1] + 2 * w * s[2] + self.lam * tr + 2 * self.mu * yy_
        xy = s[2] + w * (s[0] - s[1]) + 2 * self.mu * xy_
        zz = s[3] + self.lam * tr
        mean, radius = 0.5 * (xx + yy), ti.sqrt(0.25 * (xx - yy) ** 2 + xy * xy)
        s1, s3 = ti.max(mean + radius, zz), ti.min(mean - radius, zz)
        if s1 >= TENSILE or 0.5 * (s1 - s3) >= self.c_cos - 0.5 * (s1 + s3) * self.sin:
            self.failed[p] = 1
            xx = ti.min((xx + yy + zz) / 3, 0.0)
            yy, zz, xy = xx, xx, 0.0
        self.sigma[p] = ti.Vector([xx, yy, xy, zz])
