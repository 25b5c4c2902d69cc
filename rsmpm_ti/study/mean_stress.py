"""python -m rsmpm_ti.study.mean_stress: where, at which angle and load the mean stress first cracks a flawed specimen.

By finite elements, for the flaw as it is, a slot with round ends in elastic rock: P2 triangles on a graded mesh, the
Gaussian mean of the stress over the rock around each place, and its largest principal value. Nothing of the material
point method is in it. Needs the extra `reference`; the results are kept beside this file.
"""

import json
from importlib.metadata import version
from pathlib import Path

import numpy as np
from scipy.ndimage import gaussian_filter

from rsmpm_ti.analysis.wing_cracks import crack_directions
from rsmpm_ti.records.files import write_json
from rsmpm_ti.spec.regions import Slit
from rsmpm_ti.verify.reference.finite_elements import solve
from rsmpm_ti.verify.reference.meshing import Disc, Plate, Spacing

MESH = Spacing(corner=0.1, end=0.05, face=0.2, load_edge=0.2, far=2.0, growth=0.15, load_growth=0.2)
"""Edge lengths [mm]; halved, with PIXEL, loads change by at most 0.4 % and angles by half a degree."""

PIXEL = 0.1
"""Distance of the places at which stress is sampled and averaged [mm]."""

AROUND = 12.0
"""Stress is sampled up to this far from the flaw's ends [mm], several lengths of the mean farther than it cracks."""

KEPT = Path(__file__).with_suffix(".json")
"""Results for ANGLES of both specimens, with HALF, WIDTH, LENGTH and TENSILE."""

ANGLES = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)
"""Angles of the flaw [degrees]: from the platens in the cube, from the line of the load in the disc."""

HALF = {"cube": 7.5e-3, "disc": 15e-3}
"""Half the length of the flaw [m]."""

WIDTH, LENGTH, TENSILE = 3e-3, 1e-3, 2e6
"""Width of the flaw and length of the mean [m], tensile strength [Pa]: those of `flaw_cracks` and `rocks.lab_rock`."""


def first_crack(*, specimen: str, angle: float, mesh: Spacing = MESH, pixel: float = PIXEL) -> dict[str, float]:
    """Nominal stress [Pa] at which the mean stress over LENGTH first reaches TENSILE beside the flaw.

    Also `along`: the place along the flaw from its middle, over half its length; `first`: angle between the flaw's
    plane, outwards, and the crack [degrees].
    """
    half = HALF[specimen]
    upright = angle if specimen == "cube" else 90.0 - angle
    centre = {"cube": (25.0, 50.0), "disc": (50.0, 50.0)}[specimen]
    slit = Slit(centre=centre, length=2e3 * half, width=1e3 * WIDTH, angle=upright, rounded=True)
    body = {"cube": Plate, "disc": Disc}[specimen](slit=slit)
    reach = 1e3 * half + AROUND
    ticks = np.arange(-reach, reach + 0.5 * pixel, pixel)
    along, across = np.meshgrid(ticks, ticks, indexing="ij")
    t = slit.direction
    x = np.array(centre) + along[..., None] * t + across[..., None] * np.array([-t[1], t[0]])
    flat = x.reshape(-1, 2)
    rock = ~slit.contains(flat) & (body.depth(flat) > 0.0)
    stress = np.zeros((len(flat), 4))
    stress[rock] = solve(body, "round", mesh).at(flat[rock])[:, 2:]
    # Gaussian mean over the rock there is
    blurred = [gaussian_filter(field.reshape(along.shape), 1e3 * LENGTH / pixel) for field in (*stress.T, rock * 1.0)]
    weight = np.where(rock.reshape(along.shape), blurred[4], np.inf)
    xx, yy, xy = (blurred[k] / weight for k in (0, 1, 3))
    largest = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
    beside = np.hypot(np.maximum(np.abs(along) - 1e3 * half, 0.0), across) < 0.5 * AROUND
    k = np.unravel_index(np.where(beside, largest, -np.inf).argmax(), largest.shape)
    normal = 0.5 * np.arctan2(2.0 * xy[k], xx[k] - yy[k]) - np.radians(upright)
    position = np.array([[along[k], across[k]]])
    return {
        "stress": float(TENSILE / largest[k]),
        "along": float(abs(along[k]) / (1e3 * half)),
        "first": float(crack_directions(position, np.array([normal]), 1e3 * (half - 0.5 * WIDTH))[0]),
    }


def kept() -> dict[str, dict[float, dict[str, float]]]:
    """Specimen -> angle of the flaw [degrees] -> what `first_crack` found."""
    found = json.loads(KEPT.read_text(encoding="utf-8"))
    return {specimen: {float(angle): crack for angle, crack in found[specimen].items()} for specimen in HALF}


def main() -> None:
    packages = ("scikit-fem", "gmsh", "numpy", "scipy")
    found = {
        "command": "python -m rsmpm_ti.study.mean_stress",
        "versions": {package: version(package) for package in packages},
        "meaning": "nominal stress [Pa], place along the flaw over half its length, angle from its plane [degrees]",
    }
    for specimen in HALF:
        found[specimen] = {f"{angle:g}": first_crack(specimen=specimen, angle=angle) for angle in ANGLES}
    write_json(KEPT, found)


if __name__ == "__main__":
    main()
