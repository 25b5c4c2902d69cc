"""The rocks of a scene: its own, and those of bodies that have another. What one scene may hold is checked here.

A rock is known by its values: two bodies with equal rocks are of one rock. Index 0 is the scene's.
"""

import itertools

from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Absorbing
from rsmpm_ti.spec.confinement import check_confined_rock
from rsmpm_ti.spec.loading_start import Affine

MAX_ROCKS = 8
"""Every kernel that sees particles holds code for each rock."""


def rocks_of(scene) -> tuple[Rock, ...]:
    """All rocks of a `Scene`, each once: the scene's, then others in the order of bodies."""
    found = [scene.rock]
    for body in scene.bodies:
        if body.rock is not None and body.rock not in found:
            found.append(body.rock)
    return tuple(found)


def rock_indices(scene) -> list[int]:
    """Index in `Scene.rocks` of the rock of each body."""
    return [scene.rocks.index(scene.rock_of(body)) for body in scene.bodies]


def named_rocks(scene) -> list[tuple[str, Rock]]:
    """Each rock with the name by which a message tells of it: `rock`, or that of the first body of it."""
    first = {index: k for k, index in reversed(list(enumerate(rock_indices(scene))))}
    return [(f"bodies[{first[k]}].rock" if k else "rock", rock) for k, rock in enumerate(scene.rocks)]


def check_each_rock(scene, check) -> None:
    """Call check(rock) for each rock; a refusal of a body's rock then names the body."""
    for name, rock in named_rocks(scene):
        try:
            check(rock)
        except SceneError as error:
            raise error if name == "rock" else SceneError(f"{name}: {error}") from None


def check_rocks(scene) -> None:
    """Raise SceneError for a rock that this scene cannot hold, and for rocks that it cannot hold together."""
    if len(scene.rocks) > MAX_ROCKS:
        allowed = f"of at most {MAX_ROCKS} different rocks, not {len(scene.rocks)}"
        raise refuse("scene.bodies", scene.bodies, allowed, "what varies from place to place is rock.heterogeneity")
    if 0 not in rock_indices(scene):
        remedy = "leave out the rock of one body at least, or give its rock to the scene"
        raise refuse("scene.rock", scene.rock, "that of a body", remedy)
    check_each_rock(scene, lambda rock: _check_rock(scene, rock))
    if len(scene.rocks) > 1:
        _check_together(scene)


def _check_rock(scene, rock: Rock) -> None:
    if scene.dim == 3 and rock.elasticity.plane_stress:
        raise refuse("rock.elasticity.plane_stress", True, "False in 3D", "a plate is a 2D scene")
    if scene.domain.outside == "grow" and rock.nonlocal_mean.acts:
        remedy = "enlarge the domain: averages lie on a dense grid"
        raise refuse("domain.outside", "grow", "'stop' or 'drop' in rock with rock.nonlocal_mean", remedy)
    check_confined_rock(scene.loading.confinement, rock.elasticity)


def _check_together(scene) -> None:
    loading, named = scene.loading, named_rocks(scene)
    for name, rock in named[1:]:
        if rock.elasticity.plane_stress != scene.rock.elasticity.plane_stress:
            where = f"{name}.elasticity.plane_stress"
            allowed = f"{scene.rock.elasticity.plane_stress}, as in the scene's rock"
            raise refuse(where, rock.elasticity.plane_stress, allowed, "a specimen is a plate or it is not")
        if isinstance(loading.start, Affine) and rock.elasticity != scene.rock.elasticity:
            remedy = "rocks of different elasticity do not strain alike; use start = Ramp"
            raise refuse("loading.start", loading.start, f"no Affine where {name} has another elasticity", remedy)
        absorbing = next((boundary for boundary in loading.boundaries if isinstance(boundary, Absorbing)), None)
        if absorbing is not None and (rock.elasticity, rock.density) != (scene.rock.elasticity, scene.rock.density):
            remedy = "it takes the waves of the scene's rock; give all bodies its elasticity and density"
            raise refuse("loading.boundaries", absorbing, f"none that absorbs where {name} has other waves", remedy)
        if rock.density == scene.rock.density:
            continue
        if loading.confinement > 0.0 and any(boundary.unilateral for boundary in loading.boundaries):
            allowed = f"{scene.rock.density:g} kg/m^3, that of the scene's rock, where platens that only push confine"
            remedy = "a static test does not feel it; or set pulls = True on the platens"
            raise refuse(f"{name}.density", rock.density, allowed, remedy)
        if loading.initial_stress is not None and loading.body_force is not None:
            if loading.body_force[loading.initial_stress.axis] != 0.0:
                allowed = f"{scene.rock.density:g} kg/m^3, that of the scene's rock, in the ground"
                remedy = "loading.initial_stress knows the weight of one rock; leave it out and let settle = True"
                raise refuse(f"{name}.density", rock.density, allowed, remedy)


def check_histories(scene) -> None:
    """Raise SceneError for laws after failure that remember different things by one name."""
    named = named_rocks(scene)
    laws = [(name, rock.after_failure) for name, rock in named if rock.criterion.breaks]
    for (_, law), (name, other) in itertools.combinations(laws, 2):
        for a, b in itertools.product(law.history, other.history):
            if a.name == b.name and (a.per_axis, a.whole) != (b.per_axis, b.whole):
                allowed = f"without a variable {a.name!r} of another kind than that of {type(law).__name__}"
                raise refuse(f"{name}.after_failure", other, allowed, "rename it in one of the laws")


def variables_of(scene) -> tuple:
    """What laws after failure remember of each particle, each name once, of rocks that may break."""
    found: dict[str, object] = {}
    for rock in scene.rocks:
        if rock.criterion.breaks:
            found = {variable.name: variable for variable in rock.after_failure.history} | found
    return tuple(found.values())
