"""Drawings that tests make specimens of, and a scene around a region."""

import numpy as np
import pytest
from hostile import DRAWINGS, clear, quickly

from rsmpm_ti import Body, Domain, Lattice, Loading, Scene, Schedule, load_scene
from rsmpm_ti.errors import SceneError

SECTION = str(DRAWINGS / "section.png")  # 50 x 90 pixels of 1 mm: rock of grey 60 with a pore of 230, a vein of 120
PLATE = str(DRAWINGS / "plate.msh")  # 40 x 80 mm in metres, by gmsh: groups granite and, of radius 8 mm, inclusion
OUTLINE = str(DRAWINGS / "outline.stl")  # 40 x 80 mm in millimetres, a notch of 10 x 4 mm in its left side, flat
CORE = str(DRAWINGS / "core.stl")  # a cylinder of 16 x 20 mm with a cavity of 8 mm in its middle, a closed surface
CORE_TETRA = str(DRAWINGS / "core.msh")  # the same as tetrahedra


def scene(*regions, dx: float = 1e-3, seeding=None) -> Scene:
    """Bodies in their own box."""
    low, high = (np.array(bound) for bound in zip(*(region.bounds() for region in regions), strict=True))
    low, high = low.min(axis=0) - 2 * dx, high.max(axis=0) + 2 * dx
    return Scene(
        title="drawn",
        domain=Domain(lower=tuple(low.tolist()), upper=tuple((low + dx * np.ceil((high - low) / dx)).tolist()), dx=dx),
        bodies=tuple(Body(region=region, seeding=seeding or Lattice()) for region in regions),
        rock=load_scene("intact").rock,
        loading=Loading(),
        schedule=Schedule(t_end=1e-5),
    )


def refused(make, *words: str) -> None:
    """In one line that says these words."""
    with quickly(), pytest.raises(SceneError) as caught:
        make()
    message = str(caught.value)
    assert clear(message) and all(word in message for word in words), message
