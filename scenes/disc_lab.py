"""A Brazilian disc with an inclined central flaw in rock of the laboratory: wing cracks leave its tips for the load."""

from rsmpm_ti import Angle, Jittered, Length, MPa, Output, Scene, Slit, brazilian_test, lab_rock, mm

QUICK = {"dx": 1.0 * mm, "length": 2.0 * mm}  # a coarser rock: its mean is over two cells at least


def scene(
    *,
    flaw_angle: Angle = 45.0,
    flaw_length: Length = 30.0 * mm,
    flaw_width: Length = 3.0 * mm,
    arc: Angle = 90.0,  # half-angle of the loaded arc [degrees]; 90: every node in touch with the platen row
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    seed: int = 1,
    strain_end: float = 3.0e-4,
    time_scale: float | str = 16.0,
) -> Scene:
    flaws, what = (), "without a flaw"
    if flaw_length > 0.0:
        centre, what = (50.0 * mm, 50.0 * mm), "with an inclined flaw"
        flaws = (Slit(centre=centre, length=flaw_length, width=flaw_width, angle=flaw_angle, rounded=True),)
    return brazilian_test(
        title=f"Brazilian disc {what}: directional cracks and fracture energy",
        rock=lab_rock(length=length),
        flaws=flaws,
        seeding=Jittered(seed=seed, fitted=True),
        arc=arc,
        dx=dx,
        strain_end=strain_end,
        time_scale=time_scale,
        output=Output(stress_limit=4.0 * MPa),
    )
