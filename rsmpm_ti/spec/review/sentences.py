"""All that is said about a scene before it runs."""

from rsmpm_ti.spec.review.placement import areas_said, flaws_said, platens_said
from rsmpm_ti.spec.review.plausible import implausible
from rsmpm_ti.spec.seeding import Seeds


def review(scene, seeds: list[Seeds]) -> list[str]:
    """What is hard to believe in a scene, one sentence each; seeds: `scene.particles()`."""
    return [*implausible(scene), *flaws_said(scene), *platens_said(scene, seeds), *areas_said(scene, seeds)]
