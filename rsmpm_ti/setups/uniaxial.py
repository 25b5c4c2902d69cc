"""Uniaxial compression or tension of a plate between two smooth platens."""

from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.load_cell import LoadCell
from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.quasi_static.servo import Servo
from rsmpm_ti.spec.regions import Box, Difference, Region, Segments, Slit
from rsmpm_ti.spec.scene import Body, Loading, Output, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered, Lattice


def uniaxial_test(
    *,
    title: str,
    rock: Rock,
    dx: float,
    strain_end: float,
    flaws: tuple[Slit | Segments, ...] = (),
    outline: Region | None = None,
    seeding: Lattice | Jittered | None = None,
    width: float = 50e-3,
    height: float = 100e-3,
    room: float = 5e-3,
    turn: float = 0.0,
    transfer: PicFlip | Apic | None = None,
    speed: float = 2.5e-3,
    time_scale: float | str = 1.0,
    confinement: float = 0.0,
    servo: Servo | None = None,
    cfl: float = 0.5,
    cell: LoadCell | None = None,
    output: Output | None = None,
) -> Scene:
    """A plate of width x height [m], its lower left corner at the origin, loaded along y from uniform straining on.

    flaws: slits cut into it, in the plate's coordinates; outline: a specimen of this region in place of the plate, as
    wide and as high; seeding: Lattice() by default; room: empty grid on both sides
    [m], into which it may bulge and pieces may fly; turn: of the grid against the plate [degrees], whose platens then
    hold both ways (`Domain.turn`); speed: at which each platen closes in [m/s]; a negative one, with a negative
    strain_end, pulls: direct tension. servo: slows them while rock breaks. cell: what is measured; by default the force
    of both platens over the width.
    """
    plate = Box(lower=(0.0, 0.0), upper=(width, height)) if outline is None else outline
    glued = speed < 0.0 or turn != 0.0
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=speed, pulls=glued),
        Platen(axis=1, side="upper", position=height, speed=-speed, pulls=glued),
    )
    return Scene(
        title=title,
        domain=Domain(lower=(-room, 0.0), upper=(round(width + room, 12), height), dx=dx, turn=turn),
        bodies=(Body(region=Difference(whole=plate, removed=flaws) if flaws else plate, seeding=seeding or Lattice()),),
        rock=rock,
        loading=Loading(
            boundaries=platens, start=Affine(), time_scale=time_scale, width=width, confinement=confinement,
            servo=servo, cell=cell or LoadCell(),
        ),
        schedule=Schedule(strain_end=strain_end, cfl=cfl),
        transfer=transfer or PicFlip(),
        output=output or Output(),
    )  # fmt: skip
