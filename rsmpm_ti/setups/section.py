"""Bodies from an image: a rock for each of its greys."""

from collections.abc import Mapping

from rsmpm_ti.errors import refuse
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.drawings.mask import Mask
from rsmpm_ti.spec.scene import Body
from rsmpm_ti.spec.seeding import Jittered, Lattice


def mask_bodies(
    *,
    image: str,
    mm_per_pixel: float,
    rocks: Mapping[float | tuple[float, float], Rock | None],
    origin: tuple[float, float] = (0.0, 0.0),
    seeding: Lattice | Jittered | None = None,
) -> tuple[Body, ...]:
    """A body for each grey of an image that is rock, in the order of `rocks`; see `Mask` for images and greys.

    rocks: grey, or (lowest, highest) grey -> rock; None: the scene's. Pixels of other greys are left out. origin: the
    lower left corner of the image [m]; seeding: of all bodies, Lattice() by default. Raises SceneError.
    """
    if not isinstance(rocks, Mapping) or not rocks:
        raise refuse("rocks", rocks, "a dict of greys, or ranges of them, and rocks", "{60: None, (100, 140): vein}")
    bodies = []
    for greys, rock in rocks.items():
        pair = greys if isinstance(greys, tuple) else (greys, greys)
        region = Mask(image=image, mm_per_pixel=mm_per_pixel, greys=pair, origin=origin)
        bodies.append(Body(region=region, rock=rock, seeding=seeding or Lattice()))
    return tuple(bodies)
