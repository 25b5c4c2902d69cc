"""Measured strengths, those that a criterion was made of, its curve, and what runs gave."""

from collections.abc import Iterable, Sequence

from rsmpm_ti.units import MPa


def draw_points(axes, points: Iterable[tuple[float, float]], style: str, **how) -> None:
    """(x, y) in Pa, drawn in MPa."""
    found = list(points)
    if found:
        axes.plot([x / MPa for x, _ in found], [y / MPa for _, y in found], style, **how)


def draw_envelope(axes, *, fitted, judged, curves: dict[str, Sequence], runs: dict[str, Sequence]) -> None:
    """Everything as (x, y) in Pa; curves and runs by name."""
    draw_points(axes, fitted, "ks", markersize=5, label="measured, fitted on")
    draw_points(axes, judged, "ko", markerfacecolor="none", markersize=6, label="measured, judges")
    for number, (name, curve) in enumerate(curves.items()):
        draw_points(axes, curve, "-", color=f"C{number}", linewidth=1.0, label=name)
    for number, (name, run) in enumerate(runs.items()):
        draw_points(axes, run, "x", color=f"C{number}", markersize=7, label=f"runs, {name}")
    axes.legend(fontsize="small")
