"""Tensor algebra inside kernels: packing, principal stresses, finite rotation. No state.

A symmetric tensor is packed: in plane strain (xx, yy, zz, xy), in 3D (xx, yy, zz, xy, yz, zx); the first three are
always the normal components. This file is the one place that knows the packing; laws are written in its words.
"""

import taichi as ti

PACKED_LENGTH = {2: 4, 3: 6}
"""Stored stress components by dimension."""


@ti.func
def unpack(s: ti.template()):
    """Packed symmetric tensor -> 3x3."""
    if ti.static(s.n == 4):
        return ti.Matrix([[s[0], s[3], 0.0], [s[3], s[1], 0.0], [0.0, 0.0, s[2]]])
    else:
        return ti.Matrix([[s[0], s[3], s[5]], [s[3], s[1], s[4]], [s[5], s[4], s[2]]])


@ti.func
def pack(a, length: ti.template()):
    """3x3 symmetric tensor -> packed, `length` 4 (plane strain) or 6 (3D)."""
    if ti.static(length == 4):
        return ti.Vector([a[0, 0], a[1, 1], a[2, 2], a[0, 1]])
    else:
        return ti.Vector([a[0, 0], a[1, 1], a[2, 2], a[0, 1], a[1, 2], a[2, 0]])


@ti.func
def extreme_principals(s: ti.template()):
    """Largest and smallest of all three principal values of a packed symmetric tensor.

    Plane strain: centre +- hypot form, exact for repeated roots, then compared with zz. 3D: mean + radius x with
    x^3 - 3 x = 2 t, radius = sqrt(J2/3), t = J3 / (2 radius^3): the characteristic cubic of Smith (1961), Comm. ACM
    4:168, whose t is the cosine of three times the Lode angle. `_beyond_one` gives its outer roots.
    """
    if ti.static(s.n == 4):
        centre = 0.5 * (s[0] + s[1])
        half = 0.5 * (s[0] - s[1])
        radius = ti.sqrt(half * half + s[3] * s[3])
        return ti.Vector([ti.max(centre + radius, s[2]), ti.min(centre - radius, s[2])])
    else:
        mean = (s[0] + s[1] + s[2]) / 3.0
        a, b, c = s[0] - mean, s[1] - mean, s[2] - mean
        J2 = 0.5 * (a * a + b * b + c * c) + s[3] * s[3] + s[4] * s[4] + s[5] * s[5]
        J3 = a * (b * c - s[4] * s[4]) - s[3] * (s[3] * c - s[4] * s[5]) + s[5] * (s[3] * s[4] - b * s[5])
        radius = ti.sqrt(J2 / 3.0)
        # at radius 0 all roots are the mean and t does not matter
        t = ti.max(-1.0, ti.min(1.0, J3 / ti.max(2.0 * radius * radius * radius, 1e-30)))
        return ti.Vector([mean + radius * (1.0 + _beyond_one(t)), mean - radius * (1.0 + _beyond_one(-t))])


@ti.func
def _beyond_one(t):
    """How far the largest root of x^3 - 3 x = 2 t lies above 1: e in [0, 1] with e^2 (3 + e) = 2 (1 + t).

    Three Newton steps from a start within 0.5 % reach round-off of a 64-bit number, in less time than an arc cosine and
    two cosines. Near t = -1 the root is double: any way to it keeps half the digits of t.
    """
    s = 2.0 * (1.0 + t)
    e = ti.sqrt(s / (3.0 + 0.5 * ti.sqrt(s)))
    for _ in ti.static(range(3)):
        e -= (e * e * (3.0 + e) - s) / ti.max(3.0 * e * (2.0 + e), 1e-30)
    return e


@ti.func
def midpoint_gradient(G):
    """Displacement gradient of the step, referred to the middle of the step: G (1 + G/2)^-1, G = dt grad v.

    Hughes & Winget (1980), Int. J. Numer. Meth. Eng. 15:1862, eq. 19: a finite rotation becomes exactly skew.
    """
    return G @ (ti.Matrix.identity(float, G.n) + 0.5 * G).inverse()


@ti.func
def symmetric(G: ti.template()):
    """Packed symmetric part of a dim x dim gradient; out-of-plane components are 0 in plane strain."""
    if ti.static(G.n == 2):
        return ti.Vector([G[0, 0], G[1, 1], 0.0, 0.5 * (G[0, 1] + G[1, 0])])
    else:
        return ti.Vector(
            [
                G[0, 0],
                G[1, 1],
                G[2, 2],
                0.5 * (G[0, 1] + G[1, 0]),
                0.5 * (G[1, 2] + G[2, 1]),
                0.5 * (G[2, 0] + G[0, 2]),
            ]
        )


@ti.func
def rotate(s: ti.template(), G: ti.template()):
    """R s R^T of a packed tensor, R = (1 - W/2)^-1 (1 + W/2), W the skew part of the dim x dim increment G.

    Hughes & Winget (1980), eq. 25, in closed form. R is orthogonal to round-off for any W, so invariants are kept.
    """
    if ti.static(G.n == 2):
        half = 0.25 * (G[1, 0] - G[0, 1])  # tan of half the angle of rotation
        scale = 1.0 / (1.0 + half * half)
        cos, sin = (1.0 - half * half) * scale, 2.0 * half * scale
        centre, a, b = 0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1]), s[3]
        cos_2, sin_2 = cos * cos - sin * sin, 2.0 * cos * sin
        turned, shear = a * cos_2 - b * sin_2, b * cos_2 + a * sin_2
        return ti.Vector([centre + turned, centre - turned, s[2], shear])
    else:
        W = 0.5 * (G - G.transpose())
        square = W[0, 1] * W[0, 1] + W[1, 2] * W[1, 2] + W[2, 0] * W[2, 0]
        R = ti.Matrix.identity(float, 3) + (W + 0.5 * (W @ W)) / (1.0 + 0.25 * square)
        return pack(R @ unpack(s) @ R.transpose(), 6)


@ti.func
def hughes_winget(s: ti.template(), G: ti.template()):
    """(R s R^T, d_eps) of one step with displacement gradient G = dt grad v, dim x dim; d_eps is packed.

    Hughes & Winget (1980), eq. 19 and 25. In 2D the midpoint gradient G (1 + G/2)^-1 is M/d with
    M = G + det(G)/2 1 and d = det(1 + G/2), and everything follows from one division.
    """
    if ti.static(G.n == 2):
        q = G[0, 0] * G[1, 1] - G[0, 1] * G[1, 0]
        d = 1.0 + 0.5 * (G[0, 0] + G[1, 1]) + 0.25 * q
        n = 0.25 * (G[1, 0] - G[0, 1])  # d x tan of half the angle of rotation
        D, C, S = d * d + n * n, d * d - n * n, 2.0 * n * d
        inverse = 1.0 / (d * D * D)
        inv_d, inv_DD = inverse * D * D, inverse * d
        cos_2, sin_2 = (C * C - S * S) * inv_DD, 2.0 * C * S * inv_DD
        centre, a, b = 0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1]), s[3]
        turned, shear = a * cos_2 - b * sin_2, b * cos_2 + a * sin_2
        return ti.Vector([centre + turned, centre - turned, s[2], shear]), ti.Vector(
            [(G[0, 0] + 0.5 * q) * inv_d, (G[1, 1] + 0.5 * q) * inv_d, 0.0, 0.5 * (G[0, 1] + G[1, 0]) * inv_d]
        )
    else:
        middle = midpoint_gradient(G)
        return rotate(s, middle), symmetric(middle)


@ti.func
def rotated_vector(n: ti.template(), G: ti.template()):
    """A 2D unit vector turned as `hughes_winget` turns a stress, and of length 1 again."""
    q = G[0, 0] * G[1, 1] - G[0, 1] * G[1, 0]
    d = 1.0 + 0.5 * (G[0, 0] + G[1, 1]) + 0.25 * q
    half = 0.25 * (G[1, 0] - G[0, 1]) / d  # tan of half the angle of rotation
    cos, sin = 1.0 - half * half, 2.0 * half  # both times 1 + half^2
    return ti.Vector([cos * n[0] - sin * n[1], sin * n[0] + cos * n[1]]).normalized()


@ti.func
def material_normal(n: ti.template(), G: ti.template()):
    """Unit normal, after a step of displacement gradient G, of the material line whose normal n was [2]: F^-T n of
    length 1 again, F = 1 + G (Nanson's formula). A rotation turns it as `hughes_winget` turns a stress."""
    turned = ti.Vector([n[0] + G[1, 1] * n[0] - G[1, 0] * n[1], n[1] + G[0, 0] * n[1] - G[0, 1] * n[0]])
    return turned / ti.max(turned.norm(), 1e-30)


@ti.func
def in_frame(s: ti.template(), n: ti.template()):
    """A packed 2D stress in the frame whose first axis is the unit vector n: (nn, tt, zz, nt)."""
    cos_2, sin_2 = n[0] * n[0] - n[1] * n[1], 2.0 * n[0] * n[1]
    centre, a, b = 0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1]), s[3]
    turned_a, turned_b = a * cos_2 + b * sin_2, b * cos_2 - a * sin_2
    return ti.Vector([centre + turned_a, centre - turned_a, s[2], turned_b])


@ti.func
def out_of_frame(s: ti.template(), n: ti.template()):
    """The inverse of `in_frame`."""
    return in_frame(s, ti.Vector([n[0], -n[1]]))


@ti.func
def principal_angle(s: ti.template()):
    """Angle [rad] of the larger in-plane principal stress of a packed 2D stress from the first axis."""
    return 0.5 * ti.atan2(2.0 * s[3], s[0] - s[1])


@ti.func
def principal_normal(s: ti.template()):
    """Unit vector along the larger in-plane principal stress of a packed stress, [dim]; 0 in 3D, where none is told."""
    n = ti.Vector.zero(float, ti.static(2 if s.n == 4 else 3))
    if ti.static(s.n == 4):
        angle = principal_angle(s)
        n[0], n[1] = ti.cos(angle), ti.sin(angle)
    return n


@ti.func
def trace(s: ti.template()):
    """Trace of a packed tensor."""
    return s[0] + s[1] + s[2]


@ti.func
def double_contraction(a: ti.template(), b: ti.template()):
    """a : b of packed symmetric tensors."""
    total = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    for k in ti.static(range(3, a.n)):
        total += 2.0 * a[k] * b[k]
    return total


@ti.func
def isotropic(value, length: ti.template()):
    """value x identity, packed."""
    out = ti.Vector.zero(float, length)
    for d in ti.static(range(3)):
        out[d] = value
    return out
