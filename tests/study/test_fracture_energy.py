"""A strip pulled in two through a weak seam, a block that slides on one: what each costs is its fracture energy."""

import pytest

from rsmpm_ti.study.fracture_energy import SEAM_WIDTH, pull_seam, slide_seam

SLOW = [pytest.param(*case, marks=pytest.mark.validation) for case in ((0.5e-3, 56.3), (1e-3, 45.0), (0.5e-3, 45.0))]
pytestmark = pytest.mark.usefixtures("taichi_f64")


@pytest.mark.validation
@pytest.mark.parametrize("jittered", [False, True])
def test_crack_costs_its_fracture_energy_in_straight_rows_and_across_rows(jittered):
    """On jittered particles a crack steps between rows of cells; by each row's own opening it cost 27 % too much."""
    result = pull_seam(dx=1e-3, jittered=jittered)
    assert result["dissipated"][-1] / SEAM_WIDTH == pytest.approx(float(result["energy"]), rel=0.05)
    # the zone in which strength is lost, E G_f/f_t^2, is 21 mm long: a cell is 5 % of it
    # the strip is in two, so nothing is left to be lost
    assert abs(result["stress"][-1]) < 0.05 * result["stress"].max()


@pytest.mark.parametrize("dx, angle", [(1e-3, 56.3), *SLOW])
def test_slip_costs_its_fracture_energy_at_every_cell_size_and_direction(dx, angle):
    """Without friction, once all cohesion is gone. By each particle's own slip it cost 25 to 36 % too much, and more
    the farther it slid: rows at the edge of a band kept what those in its middle had lost."""
    result = slide_seam(dx=dx, angle=angle)
    assert float(result["lost"]) == pytest.approx(float(result["energy"]), rel=0.1)
