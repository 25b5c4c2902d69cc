"""A run that is stopped in the middle of breaking and goes on."""

import io

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, at_least, at_most
from rsmpm_ti.hardcases.failing import specimen
from rsmpm_ti.hardcases.pieces import DX, Piece
from rsmpm_ti.run.checkpoint import restore, take
from rsmpm_ti.solver.history import History
from rsmpm_ti.solver.readout import read_events

ROW = 10
"""Steps of a history row."""


def saved(arrays: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """What comes back from a checkpoint's file."""
    file = io.BytesIO()
    np.savez(file, **arrays)
    file.seek(0)
    with np.load(file, allow_pickle=False) as kept:
        return {name: kept[name] for name in kept.files}


def run_on(piece: Piece, history: History, rows: int) -> None:
    for _ in range(rows):
        piece.drive.advance(ROW)
        history.record(piece.drive.survey)


def restart(full: bool) -> Outcome:
    """18: stopped once failure has begun and run on from a checkpoint, it is the same run bit for bit."""
    piece = specimen(hole=1.6 * DX)
    history = History(piece.sim, piece.clock, piece.drive.survey)
    rows = piece.clock.total // ROW
    before = 0
    while len(read_events(piece.sim)) < 8 and before < rows:
        run_on(piece, history, 1)
        before += 1
    middle, failed = saved(take(piece.drive, history, {}, {})), len(read_events(piece.sim))
    after = min(60, rows - before)
    run_on(piece, history, after)
    whole, failed_whole = take(piece.drive, history, {}, {}), len(read_events(piece.sim))

    piece.start(0.25, 0.0)
    history = History(piece.sim, piece.clock, piece.drive.survey)
    restore(middle, piece.drive, history)
    run_on(piece, history, after)
    again = take(piece.drive, history, {}, {})
    differing = [name for name in whole if whole[name].tobytes() != again[name].tobytes()]
    why = "one thread takes the same sums in the same order"
    return Outcome(
        (
            at_most("arrays that differ in any bit", float(len(differing)), 0.0, why),
            at_least("failures after the stop", float(failed_whole - failed), 10.0, "enough to differ in"),
            at_least("arrays compared", float(len(whole)), 20.0, "particles, ledger, events, history, clock"),
        )
    )


CASES = (Case("restart", "18: stopped while it breaks, and run on", restart),)
