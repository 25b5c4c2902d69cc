"""A static start: bodies come to rest under what loads them at time 0, before the clock starts.

What loads them: body force, force field, initial stress, confinement, and platens that a force moves, by as much as
their `start` gives at time 0. Platens that have a speed stand still. How it is done: `run/settling.py`.
"""

from rsmpm_ti.errors import refuse


def check_settling(scene) -> None:
    """Raises SceneError where bodies that move at the start are to come to rest first. An Affine start will do: it sets
    bodies in motion afterwards."""
    if scene.loading.settle and any(body.velocity is not None or body.spin != 0.0 for body in scene.bodies):
        remedy = "bodies that fly do not come to rest"
        raise refuse("loading.settle", True, "False where a body has a velocity or a spin", remedy)
