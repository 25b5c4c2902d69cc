"""How velocity goes from particles to nodes and back. `v_pic` is sum w_ip v_i, `dv` is sum w_ip (v_i - v_i_old)."""

from dataclasses import dataclass
from typing import Annotated

import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import Remedy, checked


@ti.data_oriented
@checked("transfer")
@dataclass(frozen=True, kw_only=True)
class PicFlip:
    """v_p <- v_pic + flip (v_p + dv - v_pic).  flip = 1 FLIP (no damping), flip = 0 PIC.

    Zhu & Bridson (2005), sec. 4; Brackbill & Ruppel (1986) for FLIP.
    """

    flip: Annotated[float, Interval(ge=0.0, le=1.0), Remedy("1 is FLIP (no damping), 0 is PIC")] = 1.0

    affine = False  # no velocity gradient is carried by the particle

    @ti.func
    def to_particle(self, v_p, v_pic, dv):
        return v_pic + self.flip * (v_p + dv - v_pic)


@ti.data_oriented
@checked("transfer")
@dataclass(frozen=True, kw_only=True)
class Apic:
    """v_p <- v_pic with the affine matrix C = B D^-1.  Jiang, Schroeder, Selle, Teran & Stomakhin (2015), eq. 8-10.

    D is summed from the weights, so it holds for every shape function and beside walls. Angular momentum is kept.
    """

    affine = True

    @ti.func
    def to_particle(self, v_p, v_pic, dv):
        return v_pic
