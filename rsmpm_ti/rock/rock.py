"""What rock does: elasticity, failure criteria, laws after failure, artificial viscosity.

Sign convention, stated once: tension positive, sigma is Cauchy stress [Pa], sigma_1 >= sigma_3. A pressure p is
compression positive. J = det F is tracked from the start of the run, so an opened crack carries nothing until its
faces meet again.
"""

import math
from dataclasses import dataclass
from typing import Annotated

import taichi as ti

from rsmpm_ti.checks import ByType, Positive, checked
from rsmpm_ti.rock.after_failure import Clipped, CompressionOnly, Void
from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.curved.fairhurst import Fairhurst
from rsmpm_ti.rock.curved.hoek_brown import HoekBrown
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.heterogeneity import Uniform, Weibull
from rsmpm_ti.rock.nonlocal_mean import Local, Nonlocal
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.rock.sheet.reading import from_keywords, warn_of
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.viscosity import BulkViscosity, NoViscosity
from rsmpm_ti.units import Density


@ti.data_oriented
@checked("rock")
@dataclass(frozen=True, kw_only=True)
class Rock:
    """One rock: density [kg/m^3], the four laws it is made of, and how its strength varies from place to place."""

    density: Annotated[Density, Positive]
    elasticity: Annotated[Hooke, ByType]
    criterion: Annotated[MohrCoulomb | HoekBrown | Fairhurst | Unbreakable, ByType]
    after_failure: Annotated[CompressionOnly | Void | Clipped | Directional, ByType] = CompressionOnly()
    viscosity: Annotated[BulkViscosity | NoViscosity, ByType] = BulkViscosity()
    nonlocal_mean: Annotated[Local | Nonlocal, ByType] = Local()
    heterogeneity: Annotated[Uniform | Weibull, ByType] = Uniform()

    @classmethod
    def from_lab(cls, *, dx: float | None = None, **given) -> "Rock":
        """The rock of a data sheet: density, E, nu, phi, UCS or cohesion, sigma_t or BTS with kind, K_Ic or G_f, and
        more, as numbers [SI, degrees] or texts ("55 GPa"): see `DataSheet`, which also says what may be left out.

        dx: cell size of the scene [m]: without averaging_length the rock then has one of two cells at least. Warns, by
        RockWarning, of what is hard to believe. Raises SceneError.
        """
        return cls.from_sheet(from_keywords(**given), dx=dx)

    @classmethod
    def from_sheet(cls, sheet: DataSheet, *, dx: float | None = None) -> "Rock":
        """The rock of a `DataSheet`, for a scene with cells of dx [m]; warns by RockWarning, raises SceneError."""
        warn_of(sheet, dx)
        return cls(**sheet.laws(dx))

    def wave_speed(self, time_scale: float = 1.0) -> float:
        """Speed of the fastest wave, c_p unless in plane stress [m/s], with the density scaled by time_scale^2."""
        return math.sqrt(self.elasticity.p_wave_modulus / self.density) / time_scale
