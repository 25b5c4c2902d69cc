"""The particles of all bodies of a scene, checked against each other and against what loads them."""

import numpy as np

from rsmpm_ti.errors import SceneError
from rsmpm_ti.spec.holes.excavation import check_excavations, filled
from rsmpm_ti.spec.holes.pressure import check_walls
from rsmpm_ti.spec.review.memory import check_memory, check_seeding
from rsmpm_ti.spec.review.placement import check_flaws, check_overlap, check_platens
from rsmpm_ti.spec.review.slit_check import Turn, check_cuts
from rsmpm_ti.spec.seeding import Seeds


def seeds_of(scene) -> list[Seeds]:
    """Initial positions and volumes of each body's particles; refuses empty bodies, two in one place, tied slits,
    and platens within a body."""
    check_seeding(scene)
    check_flaws(scene)
    origin = np.array(scene.domain.lower, dtype=float)
    turn = Turn(np.array(scene.domain.middle), scene.domain.turn) if scene.domain.turn else None
    seeds = []
    for k, body in enumerate(scene.bodies):
        check_cuts(body, scene.shape, scene.domain.dx, origin, turn)
        seeds.append(filled(scene, body))
        if len(seeds[-1].x) == 0:
            raise SceneError(f"bodies[{k}].region holds no particle: it is smaller than dx = {scene.domain.dx} m")
    check_memory(scene, sum(len(body.x) for body in seeds))
    check_overlap(scene, seeds)
    check_platens(scene, seeds)
    check_walls(scene, seeds)
    check_excavations(scene, seeds)
    return seeds
