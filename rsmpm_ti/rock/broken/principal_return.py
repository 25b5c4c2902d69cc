"""Return of principal stresses to the Mohr-Coulomb pyramid by plastic flow with a dilation angle.

de Souza Neto, Peric & Owen (2008), Computational Methods for Plasticity, sec. 8.2: planes and edges in principal
stresses, with a strength that stays during the step. Their apex is not needed here: the mean stress that comes in is no
greater than c cot(phi), and flow makes it smaller.
"""

import taichi as ti


@ti.func
def excess_shear(s_1, s_3, sin_phi, c_cos_phi):
    """By how much two principal stresses exceed Mohr-Coulomb [Pa]."""
    return 0.5 * (s_1 - s_3) + 0.5 * (s_1 + s_3) * sin_phi - c_cos_phi


@ti.func
def mohr_coulomb_return(s: ti.template(), sin_phi, sin_psi, c_cos_phi, lam, mu):
    """(principal stresses, slip) within Mohr-Coulomb from trial stresses s_1 >= s_2 >= s_3, [3] in Pa.

    Each plane flows by the strains ((1 + sin(psi))/2, 0, -(1 - sin(psi))/2) of its two stresses per slip, an
    engineering shear strain; at an edge two planes do.
    """
    out, slip = s, 0.0
    excess = excess_shear(s[0], s[2], sin_phi, c_cos_phi)
    if excess > 0.0:
        aside = lam * sin_psi  # what a plane's flow takes from the three stresses per slip
        large, small = aside + mu * (1.0 + sin_psi), aside - mu * (1.0 - sin_psi)
        up, down = 0.5 * (1.0 + sin_phi), 0.5 * (1.0 - sin_phi)
        own = up * large - down * small  # and from the excess on it
        slip = excess / own
        out = s - slip * ti.Vector([large, aside, small])
        # at an edge two planes are reached: own a + cross b = excess, cross a + own b = second, and slip = a + b
        if out[0] < out[1]:  # the edge where the two larger are equal
            cross, second = up * aside - down * small, excess_shear(s[1], s[2], sin_phi, c_cos_phi)
            slip = (excess + second) / (own + cross)
            pressed, other = s[2] - slip * small, 0.5 * (s[0] + s[1] - slip * (large + aside))
            out = ti.Vector([other, other, pressed])
        elif out[1] < out[2]:  # the two smaller
            cross, second = up * large - down * aside, excess_shear(s[0], s[1], sin_phi, c_cos_phi)
            slip = (excess + second) / (own + cross)
            pulled, other = s[0] - slip * large, 0.5 * (s[1] + s[2] - slip * (small + aside))
            out = ti.Vector([pulled, other, other])
        if not (out[0] >= out[1] and out[1] >= out[2]):  # so near the tip that round-off decides
            mean = (s[0] + s[1] + s[2]) / 3.0
            slip = (s[0] - s[2]) / (2.0 * mu)
            out = ti.Vector([mean, mean, mean])
    return out, slip
