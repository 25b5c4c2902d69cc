"""Break the solver on purpose, in a copy: at least one verification case must miss. `pytest -m validation -k mutation`.

Each entry says what is broken, by which edits, and which case must notice.
"""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

MUTATIONS = {
    "wrong sign of spin": (
        [("rock/tensors.py", "n = 0.25 * (G[1, 0] - G[0, 1])  # d x tan", "n = 0.25 * (G[0, 1] - G[1, 0])  # d x tan")],
        "spin",
    ),
    "failure criterion in the plane only": (
        [
            (
                "rock/tensors.py",
                "return ti.Vector([ti.max(centre + radius, s[2]), ti.min(centre - radius, s[2])])",
                "return ti.Vector([centre + radius, centre - radius])",
            )
        ],
        "envelope",
    ),
    "explicit Jaumann rate": (
        [
            (
                "rock/tensors.py",
                "turned, shear = a * cos_2 - b * sin_2, b * cos_2 + a * sin_2\n        return ti.Vector("
                "[centre + turned, centre - turned, s[2], shear]), ti.Vector(",
                "w = G[1, 0] - G[0, 1]\n        turned, shear = a - b * w, b + a * w\n        return ti.Vector("
                "[centre + turned, centre - turned, s[2], shear]), ti.Vector(",
            )
        ],
        "spin",
    ),
    "pressure after failure from a rate": (
        [
            (
                "rock/after_failure.py",
                "return isotropic(-self.pressure(bulk, sim.particles.J[p]), sim.particles.sigma.n), 0.0",
                "s = sim.particles.sigma[p]\n"
                "        return isotropic(ti.min((s[0] + s[1] + s[2]) / 3.0, 0.0), sim.particles.sigma.n), 0.0",
            )
        ],
        "failed_cell",
    ),
    "crushed rock free to slip out of the plane": (
        [
            (
                "rock/broken/crushed_rock.py",
                "return found\n\n\n@ti.func\ndef flow_in_plate",
                "found[2] = z\n    return found\n\n\n@ti.func\ndef flow_in_plate",
            )
        ],
        "cracked_cell",
    ),
    "what boundaries stop booked nowhere": (
        [("mpm/nodes.py", "sim.ledger.stopped[0] += ti.cast(lost, ti.f64)", "pass")],
        "cracked_cell",
    ),
    "usl in place of musl": (
        [
            ("mpm/stepper.py", '"musl": musl,', '"musl": usl,'),
            ("fields/nodes.py", 'self.remap = scene.order == "musl"', "self.remap = False"),
        ],
        "vibration",
    ),
    "forgotten strength factor": (
        [("rock/criteria.py", "return extremes / strength_factor(sim, p)", "return extremes")],
        "weibull_size",
    ),
    "confined rock without stress out of the plane": (
        [
            (
                "fields/state.py",
                "-pressure * np.ones((len(x), 3))",
                "-pressure * np.array([[1.0, 1.0, 0.0]] * len(x))",
            )
        ],
        "triaxial",
    ),
    "work of a weight as if it fell freely": (
        [("mpm/g2p.py", "return ti.cast(dt * v_middle.dot(b)", "return ti.cast(dt * (v_middle - 0.5 * dt * b).dot(b)")],
        "gravity",
    ),
    "platens that stay where they were": (
        [
            (
                "fields/geometry.py",
                "        self.followed = tuple(d for d in range(dim) if ",
                "        self.followed = tuple(d for d in () if ",
            )
        ],
        "lab_platens",
    ),
    "platens that pull": (
        [
            ("spec/boundaries.py", "return not (self.bonded or self.pulls)", "return False"),
            ("spec/boundaries.py", "elif ti.static(self.pulls) or pressing > 0.0:", "else:"),
        ],
        "lab_platens",
    ),
    "friction without the confining pressure": (
        [("mpm/contact.py", "taken = dt * sim.confinement", "taken = 0.0 * dt * sim.confinement")],
        "lab_friction",
    ),
    "load of the first platen of a side alone": (
        [("spec/load_cell.py", "(b.axis, b.side) == (axis, name))", "(b.axis, b.side) == (axis, name))[:1]")],
        "lab_bending",
    ),
    "slits that separate by mass alone": (
        [
            (
                "spec/review/slit_check.py",
                "return self.passed <= TIED_FRACTION and self.highest <= TIP_FRACTION",
                "return True",
            )
        ],
        "open_slit",
    ),
    "forgotten stress out of the plane": (
        [
            (
                "rock/elasticity.py",
                "return rotated + self.load(d_eps)",
                "out = rotated + self.load(d_eps)\n        out[2] = 0.0\n        return out",
            )
        ],
        "envelope",
    ),
}


@pytest.mark.validation
@pytest.mark.parametrize("name", MUTATIONS)
def test_mutation_is_noticed(name, tmp_path):
    edits, case = MUTATIONS[name]
    for folder in ("rsmpm_ti", "scenes"):
        shutil.copytree(ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("__pycache__"))
    command = [sys.executable, "-m", "rsmpm_ti.verify", case, "--out", str(tmp_path / "out")]
    for file, old, new in edits:
        path = tmp_path / "rsmpm_ti" / file
        text = path.read_text(encoding="utf-8")
        assert text.count(old) == 1, f"{file} has changed: mend the mutation {name!r}"
        path.write_text(text.replace(old, new), encoding="utf-8")
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=900)
    print(done.stdout)
    assert done.returncode == 1 and "MISS" in done.stdout and "broke" not in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("name", MUTATIONS)
def test_mutation_still_fits_the_code(name):
    for file, old, _ in MUTATIONS[name][0]:
        assert (ROOT / "rsmpm_ti" / file).read_text(encoding="utf-8").count(old) == 1
