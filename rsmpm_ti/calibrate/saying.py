"""What the command prints: the task, each evaluation, the result."""

import math

from rsmpm_ti.calibrate.evaluations import Evaluation
from rsmpm_ti.calibrate.fit import EDGE
from rsmpm_ti.calibrate.record import Calibration
from rsmpm_ti.calibrate.targets.measured import Curve, Wanted
from rsmpm_ti.calibrate.targets.parameter import own_value
from rsmpm_ti.calibrate.targets.reading import ASSUMED, described
from rsmpm_ti.lab.quantity import Quantity
from rsmpm_ti.lab.standard import Specimen
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.rock.sheet.reading import displayed

STARTED = 25.0
"""Of a run, what its process, kernels and records take of a core [s], on that of docs/speed.md."""

SLOWED = 2.0
"""Steps of a run over those of platens that nothing slows; about that in the tension of granite."""


def task(wanted: Wanted, sheet: DataSheet) -> str:
    """Parameters with their bounds and starts, targets with their errors."""
    lines = [f"rock: {sheet.name}"]
    for parameter in wanted.parameters:
        own = own_value(sheet, parameter.key)
        place = parameter.place(own)
        start = min(max(place, EDGE), 1.0 - EDGE)
        moved = "" if start == place else f", the start is {displayed(parameter.key, parameter.at(start))}"
        lines.append(f"  fit {described(parameter)}; the sheet has {displayed(parameter.key, own)}{moved}")
    for target in wanted.targets:
        lines.append(f"  to  {target.said()}{f' ({100.0 * ASSUMED:g} %: the file gives none)' * target.assumed}")
    for test, pressures in wanted.confinements.items():
        lines.append(f"  {test} at {', '.join(f'{1e-6 * p:g}' for p in pressures)} MPa")
    return "\n".join(lines)


def estimate(wanted: Wanted, plan: dict[str, list[list[Specimen]]], cores: int) -> str:
    """Specimens of an evaluation, and how long they take. cores: that work at a time."""
    from rsmpm_ti.run.forecast import solving_time

    lines, seconds = [], 0.0
    for seeds in plan.values():
        for one in (one for seed in seeds for one in seed):
            scene = one.scene
            count = sum(len(body.x) for body in scene.particles())
            seconds += STARTED + SLOWED * solving_time(scene, count, 1)
            lines.append(f"  run {one.label}: {count} particles, {scene.steps} steps")
    each = seconds / min(cores, len(lines))
    lines.append(
        f"an evaluation is {len(lines)} run{'s' * (len(lines) > 1)}, about {duration(each)} on {cores} free cores; "
        f"at most {wanted.runs} evaluations, {duration(each * wanted.runs)}"
    )
    return "\n".join(lines)


def duration(seconds: float) -> str:
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} s"


def evaluation_said(one: Evaluation, wanted: Wanted) -> str:
    """One line."""
    values = ", ".join(f"{key} {_short(key, value)}" for key, value in one.values.items())
    rms = math.sqrt(one.misfit / len(one.residuals))
    what = f"failed: {one.problem}" if one.problem else f"off by {rms:.3g} errors"
    took = "kept from before" if one.before else duration(one.found.seconds)
    return f"{one.number} of {wanted.runs}: {values}: {what} ({took})"


def _short(key: str, value: float) -> str:
    return displayed(key, float(f"{value:.4g}"))


def report(found: Calibration) -> str:
    """What was fitted, how well, and what the targets do not tell."""
    wanted, best = found.wanted, found.best
    lines = [f"{found.ended}; the best is evaluation {best.number}"]
    for parameter in wanted.parameters:
        key, value = parameter.key, best.values[parameter.key]
        line = f"  {key:<18} {_short(key, value):<18}"
        if found.uncertainty is not None:
            interval = found.uncertainty.intervals[key]
            line += f" 95 %: {_short(key, interval.lower)} to {_short(key, interval.upper)}"
            line += f"  NOT IDENTIFIABLE: {interval.why}" if interval.why else ""
        lines.append(line)
    for target, share in zip(wanted.targets, found.shares(), strict=True):
        verdict = "" if share <= 1.0 else "  NOT MET"
        lines.append(f"  {target.said()}: got {_got(target, best)}, off by {share:.2g} errors{verdict}")
    if found.uncertainty is None:
        lines.append("note: the budget had no differences left, so there are no intervals; raise [budget] runs")
    else:
        lines += [f"note: {sentence}" for sentence in found.uncertainty.unseen]
    return "\n".join(lines)


def _got(target, best: Evaluation) -> str:
    value = target.got(best.found)
    if isinstance(target, Curve):
        return f"{1e-6 * value:.3g} MPa rms"
    return " ".join(Quantity(name=target.name, unit=target.unit, value=value, about="").shown()).strip()
