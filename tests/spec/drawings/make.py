"""Makes the drawings in this folder, by gmsh and Pillow: `python tests/spec/drawings/make.py`."""

from pathlib import Path

import gmsh
import numpy as np
from PIL import Image

HERE = Path(__file__).parent


def sizes(least: float, most: float) -> None:
    gmsh.option.setNumber("Mesh.MeshSizeMin", least)
    gmsh.option.setNumber("Mesh.MeshSizeMax", most)


def plate() -> None:
    """40 x 80 mm, in metres, and in its middle an inclusion of radius 8 mm: two physical groups."""
    gmsh.model.add("plate")
    occ = gmsh.model.occ
    whole, disc = occ.addRectangle(0.0, 0.0, 0.0, 0.04, 0.08), occ.addDisk(0.02, 0.04, 0.0, 0.008, 0.008)
    parts, children = occ.fragment([(2, whole)], [(2, disc)])
    occ.synchronize()
    inner = children[1][0][1]
    gmsh.model.addPhysicalGroup(2, [tag for _, tag in parts if tag != inner], name="granite")
    gmsh.model.addPhysicalGroup(2, [inner], name="inclusion")
    sizes(0.006, 0.008)
    gmsh.model.mesh.generate(2)
    gmsh.write(str(HERE / "plate.msh"))


def outline() -> None:
    """40 x 80 mm, in millimetres, flat, with a notch of 10 x 4 mm in its left side."""
    gmsh.model.add("outline")
    occ = gmsh.model.occ
    occ.cut([(2, occ.addRectangle(0.0, 0.0, 0.0, 40.0, 80.0))], [(2, occ.addRectangle(-5.0, 35.0, 0.0, 15.0, 4.0))])
    occ.synchronize()
    sizes(40.0, 60.0)
    gmsh.model.mesh.generate(2)
    gmsh.write(str(HERE / "outline.stl"))


def core() -> None:
    """A cylinder of 16 x 20 mm, in millimetres, with a cavity of 8 mm in its middle: its surface, and tetrahedra."""
    gmsh.model.add("core")
    occ = gmsh.model.occ
    occ.cut([(3, occ.addCylinder(0, 0, 0, 0, 0, 20, 8))], [(3, occ.addSphere(0, 0, 10, 4))])
    occ.synchronize()
    sizes(2.5, 5.0)
    gmsh.model.mesh.generate(2)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.write(str(HERE / "core.stl"))
    gmsh.option.setNumber("Mesh.Binary", 0)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(HERE / "core.msh"))


def section() -> None:
    """50 x 90 pixels: rock of grey 60 with a pore of 230 and a vein of 120, in white resin."""
    y, x = np.mgrid[0:90, 0:50]
    grey = np.full((90, 50), 255, dtype=np.uint8)
    grey[5:85, 5:45] = 60
    grey[60:64, 5:45] = 120
    grey[np.hypot(x - 24.5, y - 29.5) < 8] = 230
    Image.fromarray(grey).save(HERE / "section.png", optimize=True)


if __name__ == "__main__":
    gmsh.initialize()
    for make in (plate, outline, core, section):
        make()
    gmsh.finalize()
