"""What a case of validation is: a case of the harness that declares what it was given and what judges it."""

from dataclasses import dataclass

from rsmpm_ti.cases.case import Case


@dataclass(frozen=True)
class Input:
    """One number that a prediction starts from. fitted_on: keys of the measured numbers that it was made of, none for
    what its source measured by other tests."""

    name: str
    value: float
    unit: str
    source: str
    fitted_on: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Experiment(Case):
    """A case, the numbers that its rock is made of, and keys of all measured numbers that judge it.

    Raises ValueError where a number would judge what it was fitted to.
    """

    inputs: tuple[Input, ...]
    judged: tuple[str, ...] = ()

    def __post_init__(self):
        used = {key for given in self.inputs for key in given.fitted_on}
        if used & set(self.judged):
            raise ValueError(
                f"{self.name} is judged by what it was fitted on: {', '.join(sorted(used & set(self.judged)))}"
            )
