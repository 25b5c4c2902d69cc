"""The rock that the scenes with directional cracks share: brittle sandstone, weak in tension."""

from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import LinearSoftening
from rsmpm_ti.units import GPa, MPa, mm


def lab_rock(
    *,
    G_f_I: float = 5.0,
    G_f_II: float = 240.0,
    residual_friction_angle: float = 30.0,
    length: float = 1.0 * mm,
) -> Rock:
    """Elasticity and strength of the paper's rock (its sec. 4), with cracks that cost energy and a material length.

    G_f_I, G_f_II: energy per crack area in tension and in shear [J/m^2]; residual_friction_angle [degrees]; length: of
    the mean stress that decides on tension [m]. The paper gives none of them.

    G_f_I: Zhang (2002), Int. J. Rock Mech. Min. Sci. 39:401, sigma_t = 6.88 K_Ic (MPa, MPa sqrt(m)), so that
    K_Ic = 0.29 MPa sqrt(m) and, in plane strain, G_f_I = K_Ic^2 (1 - nu^2)/E = 4.9 J/m^2. G_f_II = 48 G_f_I: of
    intact granite, under pressure, 1.7 to 8.6 kJ/m^2 by Moore & Lockner (1995), J. Struct. Geol. 17:95, which is 29 to
    143 times a G_f of 60 J/m^2. From there on the peak of a flawed specimen rises no more with it (docs/validation.md).
    Raises SceneError for values that the laws refuse.
    """
    softening = LinearSoftening(G_f_I=G_f_I, G_f_II=G_f_II)
    return Rock(
        density=2600.0,
        elasticity=Hooke(E=17.0 * GPa, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95 * MPa, friction_angle=40.0, tensile_strength=2.0 * MPa),
        after_failure=Directional(residual_friction_angle=residual_friction_angle, softening=softening),
        nonlocal_mean=Nonlocal(length=length),
    )
