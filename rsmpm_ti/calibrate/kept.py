"""Evaluations on disk: one file each, by a digest of all that its numbers depend on."""

import dataclasses
import hashlib
import json
from pathlib import Path

import numpy as np

from rsmpm_ti import __version__
from rsmpm_ti.calibrate.experiment import laboratory
from rsmpm_ti.calibrate.targets.measured import Found, Wanted
from rsmpm_ti.records.files import write_json
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.rock.sheet.reading import ABOUT
from rsmpm_ti.spec.library.places import PACKAGE
from rsmpm_ti.study.runs import sources

FOLDER = "evaluations"
MAX_BYTES = 2**22


def code() -> str:
    """Digest of the code that an evaluation's numbers depend on: the solver's, the scenes', the laboratory's."""
    digest = hashlib.sha256(sources(laboratory).encode())
    for file in sorted((PACKAGE / "lab").glob("*.py")):
        digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()


def key_of(sheet: DataSheet, wanted: Wanted, code: str) -> str:
    """Name of an evaluation: by the rock with its values, the tests, pressures and seeds, and the code. Targets and
    bounds have no part in it: with others what is kept is used again."""
    rock = {name: value for name, value in dataclasses.asdict(sheet).items() if name not in ABOUT}
    pressures = {test: list(values) for test, values in sorted(wanted.confinements.items())}
    whole = {"rock": rock, "tests": sorted(wanted.tests), "confinements": pressures, "seeds": wanted.seeds,
             "version": __version__, "code": code}  # fmt: skip
    return hashlib.sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()[:20]


def keep(folder: Path, key: str, values: dict[str, float], found: Found) -> None:
    """values: of the parameters, for the reader."""
    curves = {test: {"strain": strain.tolist(), "stress_Pa": stress.tolist()}
              for test, (strain, stress) in found.curves.items()}  # fmt: skip
    write_json(folder / f"{key}.json", {
        "parameters": values, "quantities": found.quantities, "curves": curves, "problem": found.problem,
        "seconds": found.seconds,
    })  # fmt: skip


def kept(folder: Path, key: str) -> Found | None:
    """None where there is no such evaluation, or none that can be read: it is then run again."""
    path = folder / f"{key}.json"
    try:
        if path.stat().st_size > MAX_BYTES:
            return None
        file = json.loads(path.read_text(encoding="utf-8"))
        quantities = {test: {name: np.nan if value is None else float(value) for name, value in names.items()}
                      for test, names in file["quantities"].items()}  # fmt: skip
        curves = {test: (_numbers(curve["strain"]), _numbers(curve["stress_Pa"]))
                  for test, curve in file["curves"].items()}  # fmt: skip
        problem = str(file["problem"])
        return Found(quantities=quantities, curves=curves, problem=problem, seconds=float(file["seconds"]))
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None


def _numbers(values: list) -> np.ndarray:
    return np.array([np.nan if value is None else value for value in values], dtype=float)
