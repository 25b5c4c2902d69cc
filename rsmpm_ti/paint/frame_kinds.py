"""What each kind of frame shows: its colours, its words, and the value by which intact rock is coloured."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.paint.frame_axes import Wording
from rsmpm_ti.paint.palette import Palette, crack_palette, cracking_palette, margin_palette, stress_palette
from rsmpm_ti.records.snapshot import INTACT, SHEAR, Snapshot

BEGUN = 0.6
"""Fraction of its tint with which rock that has just begun to crack stands out from intact rock at once."""

MARGIN_TICKS = tuple(
    (position, f"{1.0 - abs(position):g}" + {-1.0: "  shear", 1.0: "  tension"}.get(position, ""))
    for position in (-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0)
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Look:
    """One kind of frame. `value`: a Snapshot -> what the palette's ramp shows, [n], None where it has one colour."""

    palette: Palette
    wording: Wording
    value: Callable[[Snapshot], np.ndarray | None]


def stress_look(limit: float, title: str | None, convention: str, inset: dict[str, str]) -> Look:
    """Largest principal stress up to a limit [Pa] of either sign."""
    palette = stress_palette(limit)
    wording = Wording(
        title=title or "Maximum principal stress $\\sigma_1$, total",
        bar=f"total $\\sigma_1$ [MPa]   ({convention})",
        legend=(*_failed(palette), ("void", palette.void)),
        **inset,
    )
    return Look(palette=palette, wording=wording, value=lambda snapshot: snapshot.sigma_1)


def crack_look(title: str | None, inset: dict[str, str]) -> Look:
    """Failure modes, for rock that loses its strength at once."""
    palette = crack_palette()
    legend = (*_failed(palette), ("intact", _colour(palette, 0)))
    wording = Wording(title=title or "Crack growth", bar=None, legend=legend, **inset)
    return Look(palette=palette, wording=wording, value=lambda snapshot: None)


def cracking_look(title: str | None, inset: dict[str, str]) -> Look:
    """Failure modes, and damage up to half, for rock that loses its strength while it cracks."""
    palette = cracking_palette()
    legend = (
        *_failed(palette),
        ("cracking in tension", _colour(palette, -1)),
        ("cracking in shear", _colour(palette, 0)),
        ("intact", _colour(palette, len(palette.ramp) // 2)),
    )
    wording = Wording(title=title or "Crack growth", bar=None, legend=legend, **inset)
    return Look(palette=palette, wording=wording, value=cracking)


def margin_look(title: str | None, inset: dict[str, str]) -> Look:
    """How near rock is to failure, and to which."""
    palette = margin_palette()
    wording = Wording(
        title=title or "Margin to failure",
        bar="margin to failure  (1 unloaded, 0 fails)",
        legend=(*_failed(palette), ("void", palette.void)),
        ticks=MARGIN_TICKS,
        **inset,
    )
    return Look(palette=palette, wording=wording, value=signed_load)


def cracking(snapshot: Snapshot) -> np.ndarray:
    """Tint of each particle, [n]: 0 intact, 1 when half of its strength is lost; negative for shear."""
    tint = BEGUN + (1.0 - BEGUN) * np.minimum(2.0 * snapshot.damage, 1.0)
    begun = (snapshot.damage > 0.0) & (snapshot.failure_mode == INTACT)
    return np.where(begun, _side(snapshot) * tint, 0.0)


def signed_load(snapshot: Snapshot) -> np.ndarray:
    """1 - margin, [n]; negative where shear governs; 0 in rock that does not break."""
    return _side(snapshot) * np.nan_to_num(1.0 - snapshot.margin)


def _side(snapshot: Snapshot) -> np.ndarray:
    return np.where(snapshot.governs == SHEAR, -1.0, 1.0)


def _failed(palette: Palette) -> tuple[tuple[str, tuple[int, int, int]], ...]:
    return ("failed in tension", palette.tension), ("failed in shear", palette.shear)


def _colour(palette: Palette, k: int) -> tuple[int, int, int]:
    return tuple(int(c) for c in palette.ramp[k])
