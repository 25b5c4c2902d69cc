"""What unit tests share: every variant of a strategy, found in its module, and Taichi functions on NumPy rows."""

import dataclasses
import typing

import numpy as np
import taichi as ti

from rsmpm_ti.checks import members

REQUIRED = {
    "Hooke": {"E": 17e9, "nu": 0.14},
    "HoekBrown": {"intact_strength": 25e6, "m": 10.0, "tensile_strength": 2e6},
    "Fairhurst": {"compressive_strength": 25e6, "tensile_strength": 2e6},
    "MohrCoulomb": {"cohesion": 5.95e6, "friction_angle": 40.0, "tensile_strength": 2e6},
    "Clipped": {"tension_limit": 1e6, "compression_limit": 30e6},
    "PicFlip": {"flip": 0.3},  # neither of its two ends
    "Platen": {"axis": 0, "side": "lower", "position": 0.0, "speed": 1.0},
    "Wall": {"axis": 0, "side": "lower", "position": 0.0},
    "Absorbing": {"axis": 0, "side": "lower", "position": 0.0},
    "Fixed": {"axis": 0, "side": "lower", "position": 0.0},
}
"""Example arguments of classes that cannot be built without any, or not well."""


def build(kind: type):
    """An example of a class, by its defaults or by REQUIRED."""
    needed = [
        f.name
        for f in dataclasses.fields(kind)
        if f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING
    ]
    assert not needed or kind.__name__ in REQUIRED, (
        f"{kind.__name__} has required fields {needed}: give example arguments in REQUIRED of tests/harness.py"
    )
    return kind(**REQUIRED.get(kind.__name__, {}))


def variants(owner: type, field: str) -> list:
    """An example of every class that a field of scene data may hold, by its annotation."""
    kinds = [k for k in members(typing.get_type_hints(owner)[field]) if dataclasses.is_dataclass(k)]
    assert kinds, f"{owner.__name__}.{field} holds no strategy"
    return [build(kind) for kind in kinds]


def unit(angle: float) -> np.ndarray:
    """Unit vector at an angle from +x [rad], [2]."""
    return np.array([np.cos(angle), np.sin(angle)])


def name_of(value) -> str:
    """Test ids: the class of a strategy."""
    return type(value).__name__ if dataclasses.is_dataclass(value) else str(value)


@ti.func
def vector(a: ti.template(), p, first: ti.template(), n: ti.template()):
    """Entries [first, first + n) of row p."""
    v = ti.Vector.zero(float, n)
    for k in ti.static(range(n)):
        v[k] = a[p, first + k]
    return v


@ti.func
def matrix(a: ti.template(), p, first: ti.template(), n: ti.template()):
    """n x n matrix from row p, row by row."""
    m = ti.Matrix.zero(float, n, n)
    for d, e in ti.static(ti.ndrange(n, n)):
        m[d, e] = a[p, first + n * d + e]
    return m


@ti.func
def flat(m: ti.template()):
    """A matrix as a vector, row by row."""
    v = ti.Vector.zero(float, m.n * m.m)
    for d, e in ti.static(ti.ndrange(m.n, m.m)):
        v[m.m * d + e] = m[d, e]
    return v


def on_rows(function, rows, length: int, real=ti.f64) -> np.ndarray:
    """function(a, p) -> vector of `length`, a Taichi function, for every row p of `rows`, computed in `real`."""

    @ti.kernel
    def run(a: ti.types.ndarray(), out: ti.types.ndarray()):
        for p in range(a.shape[0]):
            v = function(a, p)
            for k in ti.static(range(length)):
                out[p, k] = v[k]

    rows = np.ascontiguousarray(rows, dtype=dtype_of(real))
    out = np.full((len(rows), length), np.nan, dtype=rows.dtype)
    run(rows, out)
    return out.astype(np.float64)


def dtype_of(real):
    return np.float64 if real == ti.f64 else np.float32


def rounded(values, real) -> np.ndarray:
    """Values as a computation in `real` sees them, in float64 for the reference."""
    return np.asarray(values, dtype=dtype_of(real)).astype(np.float64)


def epsilon(real) -> float:
    """Unit round-off of a precision, 2.2e-16 or 1.2e-7."""
    return float(np.finfo(dtype_of(real)).eps)
