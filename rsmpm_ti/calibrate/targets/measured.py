"""What is fitted to: measured numbers and curves, and how far what a simulation found is from them."""

import math
from dataclasses import dataclass, field

import numpy as np

from rsmpm_ti.calibrate.targets.parameter import Parameter
from rsmpm_ti.lab.quantity import Quantity


@dataclass(frozen=True, kw_only=True)
class Found:
    """What the tests of one evaluation found. problem: why there is nothing, "" where there is.

    quantities: test -> name -> value [unit of the report], NaN where it is not defined; curves: test -> strain and
    stress [Pa], each [rows].
    """

    quantities: dict[str, dict[str, float]] = field(default_factory=dict)
    curves: dict[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    problem: str = ""
    seconds: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Number:
    """A measured number. error: one standard deviation; both in the unit of the report. assumed: whether the file
    gave no error."""

    test: str
    name: str
    unit: str
    value: float
    error: float
    assumed: bool = False

    @property
    def label(self) -> str:
        return f"{self.test}.{self.name}"

    def got(self, found: Found) -> float:
        return found.quantities[self.test][self.name]

    def residuals(self, found: Found) -> np.ndarray:
        """(got - value)/error, [1]."""
        return np.array([(self.got(found) - self.value) / self.error])

    def said(self) -> str:
        """`ucs.UCS 160 ± 8 MPa`."""
        measured = Quantity(name=self.name, unit=self.unit, value=self.value, error=self.error, about="")
        return f"{self.label} {' '.join(measured.shown())}".rstrip()


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A measured curve: strain [1] and stress [Pa], each [rows]; error: one standard deviation of the stress [Pa]."""

    test: str
    file: str
    strain: np.ndarray
    stress: np.ndarray
    error: float
    assumed: bool = False

    name = "curve"
    unit = "Pa"

    @property
    def label(self) -> str:
        return f"{self.test}.curve"

    def residuals(self, found: Found) -> np.ndarray:
        """(got - stress)/error at the measured strains, over the root of their number: a curve counts as one number.

        Beyond its end the simulated curve keeps its last stress, [rows].
        """
        strain, stress = found.curves[self.test]
        return (np.interp(self.strain, strain, stress) - self.stress) / (self.error * math.sqrt(len(self.strain)))

    def got(self, found: Found) -> float:
        """Root mean square of the difference in stress [Pa]."""
        return self.error * float(np.linalg.norm(self.residuals(found)))

    def said(self) -> str:
        return f"{self.label} {len(self.strain)} points ± {1e-6 * self.error:.2g} MPa"


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A calibration as it was asked for. confinements: test -> pressures [Pa], of those that need any.

    runs: evaluations at most; seeds: specimens of each kind in every evaluation.
    """

    parameters: tuple[Parameter, ...]
    targets: tuple[Number | Curve, ...]
    confinements: dict[str, tuple[float, ...]] = field(default_factory=dict)
    runs: int
    seeds: int

    @property
    def tests(self) -> tuple[str, ...]:
        """Those that the targets need, each once."""
        return tuple(dict.fromkeys(target.test for target in self.targets))

    def residuals(self, found: Found) -> np.ndarray:
        """Of all targets, [rows]; NaN where something is not defined or did not run.

        Raises KeyError for a quantity that a report turned out not to have.
        """
        if found.problem:
            return np.full(self.rows, np.nan)
        return np.concatenate([target.residuals(found) for target in self.targets])

    @property
    def rows(self) -> int:
        return sum(1 if isinstance(target, Number) else len(target.strain) for target in self.targets)
