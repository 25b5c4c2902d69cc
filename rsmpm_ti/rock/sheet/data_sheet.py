"""What a laboratory reports of a rock, checked, and what follows of it for the laws of a `Rock`.

What a sheet lacks comes from `DEFAULTS`, each with its source and its range, and is said in `derived`.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Interval, Len

from rsmpm_ti.checks import checked
from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.rock.after_failure import CompressionOnly
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.nonlocal_mean import MIN_CELLS, Local, Nonlocal
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import ExponentialSoftening, LinearSoftening
from rsmpm_ti.units import Angle, Density, FractureEnergy, Length, Pressure, Toughness

ZHANG = 6.88
"""sigma_t over K_Ic [1/sqrt(m)]: Zhang (2002), Int. J. Rock Mech. Min. Sci. 39:401."""

SHEAR_RATIO = 4.8
"""G_f_II over G_f: the square of K_IIc/K_Ic = 2.2, Al-Shayea (2005), Eng. Geol. 81:84."""

RESIDUAL_FRICTION = 30.0
"""Of broken rock [degrees]: Barton & Choubey (1977), Rock Mech. 10:1."""

AVERAGING_LENGTH = 1e-3
"""Of the mean stress that decides on tension [m]: that of `lab_rock`."""

DIRECT_OVER_BRAZILIAN = {"metamorphic": 0.9, "igneous": 0.8, "sedimentary": 0.7}
"""Direct over Brazilian tensile strength: Perras & Diederichs (2014), Geotech. Geol. Eng. 32:525."""

GRIFFITH = 8.0
"""Uniaxial compressive over tensile strength of a body with open cracks: Griffith (1924). Weak sandstones and mudstones
lie a little lower, so less is a doubt and no error."""

SPAN = 4.0
"""Lengths over which a Gaussian mean takes most of its weight."""

DEFAULTS = {
    "sigma_t": ("0.9, 0.8 or 0.7 BTS", "Perras & Diederichs (2014), metamorphic, igneous, sedimentary", "0.5 to 1 BTS"),
    "G_f": ("K_Ic^2 (1 - nu^2)/E", "Irwin (1957), plane strain", "exact where the process zone is small"),
    "K_Ic": ("sigma_t/6.88, MPa and m", "Zhang (2002)", "a factor of 2 either way"),
    "G_f_II": ("4.8 G_f", "K_IIc/K_Ic = 2.2: Al-Shayea (2005), limestone", "1 to 400 G_f, more under pressure"),
    "phi_r": ("30 degrees, at most phi", "Barton & Choubey (1977), basic friction", "25 to 35 degrees"),
    "averaging_length": ("1 mm, in a scene 2 cells or more", "a choice", "a grain to E' G_f/(4 sigma_t^2)"),
}  # fmt: skip
"""Key -> what is taken where a sheet lacks it, whose rule that is, and how far it may be off."""


@checked("sheet", recorded=False)
@dataclass(frozen=True, kw_only=True)
class DataSheet:
    """The data sheet of a rock, in SI and degrees; `reading.py` takes the same from texts with units.

    density [kg/m^3]; E [Pa], nu; phi: friction angle [degrees]; UCS: uniaxial compressive strength, or cohesion [Pa];
    sigma_t: direct tensile strength, or BTS: the Brazilian one with the rock's `kind` [Pa]; K_Ic [Pa sqrt(m)] or G_f
    [J/m^2]: of a crack in tension; G_f_II: of cohesion lost in shear [J/m^2]; phi_r: friction angle of broken rock;
    averaging_length [m]. What may be left out: `DEFAULTS`.
    law: "lab" is rock with a fracture energy and directional cracks, 2D; "paper" is the paper's rule, which uses none
    of the energies; by default a scene's rock keeps the rule of the scene, and is "lab" without one. softening: see
    `softening.py`. estimated: keys that the source does not give; sources: (key, text).

    Raises SceneError for values that no rock has, and for strengths that contradict each other.
    """

    name: Annotated[str, Len(1, 60)] = "rock"
    density: Annotated[Density, Interval(ge=500.0, le=8000.0)]
    E: Annotated[Pressure, Interval(ge=0.1e9, le=200e9)]
    nu: Annotated[float, Interval(ge=0.0, le=0.49)]
    phi: Annotated[Angle, Interval(ge=5.0, le=70.0)]
    UCS: Annotated[Pressure, Interval(ge=0.1e6, le=1000e6)] | None = None
    cohesion: Annotated[Pressure, Interval(ge=0.02e6, le=300e6)] | None = None
    sigma_t: Annotated[Pressure, Interval(ge=0.01e6, le=100e6)] | None = None
    BTS: Annotated[Pressure, Interval(ge=0.01e6, le=100e6)] | None = None
    kind: Literal["igneous", "metamorphic", "sedimentary"] | None = None
    K_Ic: Annotated[Toughness, Interval(ge=0.01e6, le=10e6)] | None = None
    G_f: Annotated[FractureEnergy, Interval(ge=0.1, le=5000.0)] | None = None
    G_f_II: Annotated[FractureEnergy, Interval(ge=0.1, le=1e5)] | None = None
    phi_r: Annotated[Angle, Interval(ge=0.0, le=60.0)] | None = None
    averaging_length: Annotated[Length, Interval(ge=1e-5, le=0.1)] | None = None
    law: Literal["lab", "paper"] | None = None
    softening: Literal["linear", "exponential"] = "linear"
    source: str = ""
    estimated: tuple[str, ...] = ()
    sources: tuple[tuple[str, str], ...] = ()

    def __post_init__(self):
        self._one_of("UCS", "cohesion", "UCS = 2 cohesion cos(phi)/(1 - sin(phi))", needed=True)
        self._one_of("sigma_t", "BTS", "sigma_t is the strength in direct tension, BTS the Brazilian one", needed=True)
        self._one_of("K_Ic", "G_f", "they say the same, G_f = K_Ic^2 (1 - nu^2)/E", needed=False)
        if self.BTS is not None and self.kind is None:
            ratios = ", ".join(f"{ratio:g} {kind}" for kind, ratio in DIRECT_OVER_BRAZILIAN.items())
            remedy = f"by it sigma_t is BTS times {ratios} (Perras & Diederichs 2014); or give sigma_t"
            raise refuse("kind", None, "'igneous', 'metamorphic' or 'sedimentary' where BTS is given", remedy)
        if self.phi_r is not None and self.phi_r > self.phi:
            raise refuse("phi_r", self.phi_r, f"at most phi = {self.phi:g} degrees", "rock that broke is no stronger")
        self._check_tension()

    def _one_of(self, first: str, second: str, relation: str, *, needed: bool) -> None:
        given = [name for name in (first, second) if getattr(self, name) is not None]
        if len(given) == 2 or (needed and not given):
            raise SceneError(
                f"{first} and {second}: give one of them{'' if given else ', neither is there'}; {relation}"
            )

    def _check_tension(self) -> None:
        """Mohr-Coulomb ends at c cot(phi): tensile strength beyond it, or above that in compression, is no rock's."""
        key = "sigma_t" if self.BTS is None else "BTS"
        said = f"{self.tensile_strength / 1e6:.4g} MPa"
        if self.tensile_strength >= self.compressive_strength:
            allowed = f"below the compressive strength, {self.compressive_strength / 1e6:.4g} MPa"
            raise refuse(key, said, allowed, "rock has a tenth of it; are the two exchanged?")
        apex = self.shear_strength / math.tan(math.radians(self.phi))
        if self.tensile_strength > apex:
            # c cot(phi) = UCS (1 - sin(phi))/(2 sin(phi)), which is sigma_t at this phi
            widest = math.degrees(math.asin(1.0 / (1.0 + 2.0 * self.tensile_strength / self.compressive_strength)))
            allowed = (
                f"at most {apex / 1e6:.4g} MPa, where Mohr-Coulomb of this strength and phi = {self.phi:g} degrees ends"
            )
            remedy = f"with this UCS and sigma_t, phi is at most {math.floor(10.0 * widest) / 10.0:g} degrees"
            raise refuse(key, said, allowed, remedy)

    @property
    def shear_strength(self) -> float:
        """Cohesion c = UCS (1 - sin(phi))/(2 cos(phi)) [Pa]."""
        phi = math.radians(self.phi)
        return self.cohesion or self.UCS * (1.0 - math.sin(phi)) / (2.0 * math.cos(phi))

    @property
    def compressive_strength(self) -> float:
        """UCS = 2 c cos(phi)/(1 - sin(phi)) [Pa]."""
        phi = math.radians(self.phi)
        return self.UCS or 2.0 * self.cohesion * math.cos(phi) / (1.0 - math.sin(phi))

    @property
    def tensile_strength(self) -> float:
        """Of direct tension [Pa]."""
        return self.sigma_t or self.BTS * DIRECT_OVER_BRAZILIAN[self.kind]

    @property
    def toughness(self) -> float:
        """K_Ic [Pa sqrt(m)], in plane strain where G_f is given."""
        if self.G_f is not None:
            return math.sqrt(self.G_f * self.E / (1.0 - self.nu**2))
        return self.K_Ic or self.tensile_strength / ZHANG

    @property
    def tension_energy(self) -> float:
        """G_f_I [J/m^2]."""
        return self.G_f or self.toughness**2 * (1.0 - self.nu**2) / self.E

    @property
    def shear_energy(self) -> float:
        """G_f_II [J/m^2]."""
        return self.G_f_II or SHEAR_RATIO * self.tension_energy

    @property
    def residual_friction(self) -> float:
        """[degrees]."""
        return min(RESIDUAL_FRICTION, self.phi) if self.phi_r is None else self.phi_r

    def length(self, dx: float | None) -> float:
        """Of the mean stress [m], in cells of dx [m] where they are known."""
        return self.averaging_length or max(AVERAGING_LENGTH, MIN_CELLS * (dx or 0.0))

    @property
    def zones(self) -> tuple[float, float]:
        """Lengths over which strength is lost in tension and in shear [m]: E' G_f/sigma_t^2 and mu G_f_II/c^2."""
        mu = self.E / (2.0 * (1.0 + self.nu))
        tension = (self.toughness / self.tensile_strength) ** 2
        return tension, mu * self.shear_energy / self.shear_strength**2

    def laws(self, dx: float | None = None) -> dict:
        """Keywords of a `Rock`; dx: cell size of the scene [m], of which a length that is not given is two at least."""
        rock = {
            "density": self.density,
            "elasticity": Hooke(E=self.E, nu=self.nu),
            "criterion": MohrCoulomb(
                cohesion=self.shear_strength, friction_angle=self.phi, tensile_strength=self.tensile_strength
            ),
        }
        if self.law == "paper":
            return rock | {"after_failure": CompressionOnly(), "nonlocal_mean": Local()}
        kind = LinearSoftening if self.softening == "linear" else ExponentialSoftening
        softening = kind(G_f_I=self.tension_energy, G_f_II=self.shear_energy)
        law = Directional(residual_friction_angle=self.residual_friction, softening=softening)
        return rock | {"after_failure": law, "nonlocal_mean": Nonlocal(length=self.length(dx))}

    def derived(self, dx: float | None = None) -> list[str]:
        """What the rock gets that the sheet does not hold as it is, and why; one short line each."""
        lines = []
        if self.cohesion is None:
            lines.append(f"cohesion {self.shear_strength / 1e6:.4g} MPa from UCS and phi")
        else:
            lines.append(f"UCS {self.compressive_strength / 1e6:.4g} MPa from cohesion and phi")
        if self.BTS is not None:
            ratio = DIRECT_OVER_BRAZILIAN[self.kind]
            lines.append(f"sigma_t {self.tensile_strength / 1e6:.4g} MPa: {ratio:g} BTS (Perras & Diederichs 2014)")
        if self.law == "paper":
            return [*lines, "the paper's rule: no fracture energy, no length; loads at flaws follow the cell size"]
        if self.G_f is None:
            known = self.K_Ic is not None
            why = "" if known else ", that of sigma_t by Zhang (2002), within a factor of 2"
            lines.append(f"G_f {self.tension_energy:.4g} J/m2 from K_Ic {self.toughness / 1e6:.4g} MPa*m^0.5{why}")
        if self.G_f_II is None:
            lines.append(f"G_f_II {self.shear_energy:.4g} J/m2: {SHEAR_RATIO:g} G_f (Al-Shayea 2005)")
        if self.phi_r is None:
            lines.append(f"phi_r {self.residual_friction:g} degrees (Barton & Choubey 1977)")
        if self.averaging_length is None:
            cells = "" if self.length(dx) == AVERAGING_LENGTH else ", two cells"
            lines.append(f"averaging_length {1e3 * self.length(dx):.4g} mm: a choice{cells}")
        tension, shear = self.zones
        return [*lines, f"strength is lost over {1e3 * tension:.3g} mm in tension, {1e3 * shear:.3g} mm in shear"]

    def doubts(self, dx: float | None = None) -> list[str]:
        """What is hard to believe, one sentence each."""
        ratio = self.compressive_strength / self.tensile_strength
        said = []
        if ratio < GRIFFITH:
            known = f"open cracks alone make it {GRIFFITH:g} (Griffith 1924)"
            said.append(f"UCS over sigma_t is {ratio:.3g}, and {known}; is sigma_t that of direct tension?")
        if self.law != "paper":
            said += self._energies_said(1e3 * self.length(dx))
        return [f"rock {self.name}: {sentence}" for sentence in said]

    def _energies_said(self, length: float) -> list[str]:
        """length: of the mean [mm]."""
        tension, shear = (1e3 * zone for zone in self.zones)
        said = []
        if self.shear_energy < self.tension_energy:
            energies = f"G_f_II = {self.shear_energy:.4g} J/m2 is below G_f = {self.tension_energy:.4g} J/m2"
            said.append(f"{energies}; shear costs more")
        in_shear = "G_f_II too small (granite under pressure: 1700 to 8600 J/m2, Moore & Lockner 1995)?"
        for zone, mode, cause in ((tension, "tension", "G_f too small?"), (shear, "shear", in_shear)):
            if zone < SPAN * length:
                mean = f"the mean over averaging_length = {length:.4g} mm spans {SPAN * length:.4g} mm"
                remedy = f"use smaller cells and a smaller length, or is {cause}"
                said.append(f"strength is lost over {zone:.3g} mm in {mode}, and {mean}: tips are robbed; {remedy}")
        return said
