"""A round inclusion of another rock in a block under uniaxial compression: cracks start where the two rocks meet.

A soft inclusion strains more than the block and pulls the rock above and below it apart, as a hole does (Goodier
1933): with `contrast=0.1` the tension at its poles is 0.69 of the load. Cracks grow from there along the load, through
the inclusion too, and at last shear failure beside it, where the load is 2.5 times as large, splits the block.
`contrast=4 strength=3` is a stiff and strong one. Experiments: Janeiro & Einstein (2010), Int. J. Fract. 164:83.
"""

from dataclasses import replace

from rsmpm_ti import (
    Body,
    Box,
    Difference,
    Disc,
    Domain,
    Jittered,
    Length,
    Loading,
    Platen,
    Ramp,
    Scene,
    Schedule,
    lab_rock,
    mm,
)

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 1.0 * mm, "length": 2.0 * mm}


def scene(
    *,
    radius: Length = 10.0 * mm,
    contrast: float = 0.1,  # modulus of the inclusion over that of the block
    strength: float = 0.5,  # the same of cohesion and tensile strength
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    seed: int = 1,
    strain_end: float = 1.2e-3,
    time_scale: float = 16.0,
) -> Scene:
    width, height, room = 60.0 * mm, 100.0 * mm, 10.0 * mm
    rock = lab_rock(length=length)
    criterion = replace(
        rock.criterion,
        cohesion=strength * rock.criterion.cohesion,
        tensile_strength=strength * rock.criterion.tensile_strength,
    )
    inner = replace(rock, elasticity=replace(rock.elasticity, E=contrast * rock.elasticity.E), criterion=criterion)
    disc = Disc(centre=(0.5 * width, 0.5 * height), radius=radius)
    block = Difference(whole=Box(lower=(0.0, 0.0), upper=(width, height)), removed=(disc,))
    seeding = Jittered(seed=seed, fitted=True)
    return Scene(
        title="Uniaxial compression of a block with an inclusion",
        domain=Domain(lower=(-room, 0.0), upper=(width + room, height), dx=dx),
        bodies=(
            Body(region=block, seeding=seeding),
            Body(region=disc, seeding=seeding, rock=inner),
        ),
        rock=rock,
        loading=Loading(
            boundaries=(
                Platen(axis=1, side="lower", position=0.0, speed=2.5e-3),
                Platen(axis=1, side="upper", position=height, speed=-2.5e-3),
            ),
            start=Ramp(time=6e-3),  # two rocks do not strain alike: no start of uniform straining
            time_scale=time_scale,
            width=width,
        ),
        schedule=Schedule(strain_end=strain_end),
    )
