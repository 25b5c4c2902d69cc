"""Where particles start, and whether the two faces of a slit really separate."""

import re

import numpy as np
import pytest
from harness import name_of, variants

from rsmpm_ti.errors import SceneError
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.spec.regions import Box, Difference, Disc, Slit, Union, slits_of
from rsmpm_ti.spec.review import slit_check
from rsmpm_ti.spec.review.slit_check import Tie, check_cuts, check_slit, slit_tie
from rsmpm_ti.spec.scene import Body
from rsmpm_ti.spec.seeding import Jittered, Lattice

DX = 0.5e-3
ORIGIN = np.zeros(2)
BLOCK = Box(lower=(0.0, 0.0), upper=(0.05, 0.1))
every_seeding = pytest.mark.parametrize("seeding", variants(Body, "seeding"), ids=name_of)


def slit(width: float, angle: float = 45.0) -> Slit:
    return Slit(centre=(0.025, 0.05), length=0.015, width=width, angle=angle)


def cut(flaw: Slit) -> Difference:
    return Difference(whole=BLOCK, removed=(flaw,))


@every_seeding
def test_block_holds_four_particles_per_cell(seeding):
    x = seeding.fill(BLOCK, ORIGIN, DX).x
    assert len(x) == 80_000
    assert BLOCK.contains(x).all()
    cells = np.floor(x / DX).astype(int)
    counts = np.bincount(cells[:, 0] * 1000 + cells[:, 1])
    assert counts[counts > 0].mean() == pytest.approx(4.0, rel=1e-12 if isinstance(seeding, Lattice) else 0.05)


@every_seeding
@pytest.mark.parametrize("width, removed", [(0.25e-3, 42), (0.5e-3, 128), (1.0e-3, 212), (1.5e-3, 382), (2.0e-3, 468)])
def test_slit_at_45_degrees_removes_the_published_number_of_particles(seeding, width, removed):
    assert len(seeding.fill(cut(slit(width)), ORIGIN, DX).x) == 80_000 - removed


@pytest.mark.parametrize("spacing, count", [(0.5e-3, 31_428), (0.25e-3, 125_676)])
def test_disc_counts_lattice_points_of_a_circle(spacing, count):
    disc = Disc(centre=(0.05, 0.05), radius=0.05)
    assert len(Lattice().fill(disc, ORIGIN, 2.0 * spacing).x) == count


def test_lattice_sits_at_the_centres_of_sub_cells_in_2d_and_3d():
    x = Lattice(particles_per_axis=3).fill(Box(lower=(0.0,) * 3, upper=(2.0, 1.0, 1.0)), np.zeros(3), 1.0).x
    assert len(x) == 54
    np.testing.assert_allclose(np.unique(x[:, 0].round(9)), (np.arange(6) + 0.5) / 3.0, atol=1e-9)
    shifted = Lattice().fill(Box(lower=(0.1, 0.1), upper=(1.1, 1.1)), np.array([0.1, -0.9]), 0.5).x
    np.testing.assert_allclose(np.unique(shifted.round(9)), 0.1 + (np.arange(4) + 0.5) / 4.0, atol=1e-9)


def test_jitter_is_fixed_by_its_seed_and_its_count_by_none():
    region = cut(slit(1.0e-3))
    runs = [Jittered(seed=seed).fill(region, ORIGIN, DX).x for seed in (1, 1, 2)]
    np.testing.assert_array_equal(runs[0], runs[1])
    assert runs[0].shape == runs[2].shape
    assert np.mean(np.abs(runs[0] - runs[2]).max(axis=1) > 1e-9) > 0.99


@pytest.mark.parametrize("amount", [0.0, 0.1, 0.49])
def test_jitter_moves_every_particle_by_at_most_its_amount_and_fills_it(amount):
    region = cut(slit(1.0e-3))
    lattice, moved = Lattice().fill(region, ORIGIN, DX).x, Jittered(amount=amount).fill(region, ORIGIN, DX).x
    fraction = np.abs(moved - lattice) / (0.5 * DX)
    assert fraction.max() <= amount + 1e-9
    assert fraction.max() >= 0.99 * amount
    assert fraction.mean() == pytest.approx(0.5 * amount, rel=0.02)  # uniform; 1.6e5 draws, and edges that stay


@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0])
def test_fitted_edges_keep_the_area_of_what_is_cut(angle):
    """16 samples per axis place an edge to 1/32 of a sub-cell, the same everywhere along an edge of such an angle."""
    region, spacing = cut(slit(1.3e-3, angle)), 0.5 * DX
    area = 0.05 * 0.1 - 1.3e-3 * 15e-3
    seeds = Lattice(fitted=True).fill(region, ORIGIN, DX)
    assert seeds.volume.sum() == pytest.approx(area, abs=spacing / 32 * 2 * 16.3e-3)
    assert seeds.volume.max() < 1.6 * spacing**2  # a whole sub-cell with two slivers of 0.3 at most
    assert seeds.volume.min() >= 0.3 * spacing**2 * (1 - 1e-9)
    assert region.contains(seeds.x).all()


def test_fitted_particle_sits_at_the_centroid_of_what_is_left():
    """A box that ends at a quarter and at 0.6 of a sub-cell: both cuts fall on sample lines or within 1/16 of one."""
    seeds = Lattice(particles_per_axis=1, fitted=True).fill(Box(lower=(0.25, 0.0), upper=(2.0, 0.6)), np.zeros(2), 1.0)
    assert len(seeds.x) == 2
    cut_cell = seeds.x[:, 0].argmin()
    np.testing.assert_allclose(seeds.x[cut_cell], [0.625, 0.3], atol=1.0 / 16.0)
    assert seeds.volume[cut_cell] == pytest.approx(0.75 * 0.6, rel=0.05)


def test_fitted_edges_of_a_lattice_box_change_nothing():
    whole, fitted = (Lattice(fitted=f).fill(BLOCK, ORIGIN, DX) for f in (False, True))
    np.testing.assert_array_equal(whole.x, fitted.x)
    np.testing.assert_allclose(whole.volume, fitted.volume, rtol=1e-12)


def test_fitted_disc_has_the_area_and_the_second_moment_of_a_disc():
    radius, spacing = 0.05, 0.5e-3
    seeds = Lattice(fitted=True).fill(Disc(centre=(0.05, 0.05), radius=radius), ORIGIN, 2.0 * spacing)
    # samples err by at most 1/32 of a sub-cell, at random along the rim: 1e-5; stairs err by 5e-4
    assert seeds.volume.sum() == pytest.approx(np.pi * radius**2, rel=2e-5)
    moment = np.sum(seeds.volume * np.sum((seeds.x - 0.05) ** 2, axis=1))
    # particles have no moment of their own, spacing^2/6 each: 3.3e-5, more where slivers were joined
    assert moment == pytest.approx(0.5 * np.pi * radius**4, rel=1e-4)


@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0, 90.0])
def test_jitter_never_enters_a_slit_nor_leaves_the_body(angle):
    flaw = slit(1.0e-3, angle)
    x = Jittered(amount=0.49).fill(cut(flaw), ORIGIN, DX).x
    assert not flaw.contains(x).any()
    assert BLOCK.contains(x).all()


APART = [(Linear(), 2.0, 2.5), (Gimp(), 2.0, 2.5), (QuadraticBSpline(), 3.0, 3.0)]
"""Cells across a slit along the grid, and at any angle, that part its faces on a lattice of two particles per axis."""


@pytest.mark.parametrize("angle", [0.0, 20.0, 30.0, 45.0, 90.0])
@pytest.mark.parametrize("shape, along_grid, turned", APART, ids=str)
def test_wide_slit_is_a_flaw(angle, shape, along_grid, turned):
    flaw = slit((turned if angle % 90.0 else along_grid) * DX, angle)
    check_slit(cut(flaw), flaw, Lattice(), shape, DX, ORIGIN)


def remedy(flaw, seeding, shape) -> float:
    """The width that the refusal of a slit names [m]."""
    with pytest.raises(SceneError, match=r"slit\.width = .* is refused") as refused:
        check_slit(cut(flaw), flaw, seeding, shape, DX, ORIGIN)
    return float(re.search(r"a width of at least (\S+) m", str(refused.value))[1])


@pytest.mark.parametrize(
    "flaw, shape",
    [
        (slit(0.25e-3), Linear()),
        (slit(0.5e-3), Linear()),
        (slit(0.5e-3, 90.0), Linear()),
        (slit(1.0e-3), Linear()),
        (slit(1.0e-3, 0.0), QuadraticBSpline()),
        (slit(1.0e-3, 90.0), QuadraticBSpline()),
        (slit(1.0e-3), QuadraticBSpline()),
        (slit(0.5e-3), QuadraticBSpline()),
        (slit(0.5e-3), Gimp()),
        (slit(1.0e-3), Gimp()),
    ],
    ids=str,
)
@every_seeding
def test_narrow_slit_is_refused_with_a_width_that_passes(flaw, shape, seeding):
    width = remedy(flaw, seeding, shape)
    assert flaw.width < width <= 2.5e-3
    better = slit(width, flaw.angle)
    check_slit(cut(better), better, seeding, shape, DX, ORIGIN)


def test_finer_cells_tie_a_flaw_of_as_many_cells_more():
    """What springs of a layer of cells hold back is what a longer crack would let go: kappa pi a/dx."""
    tie = {}
    for dx in (1e-3, 0.5e-3):
        flaw = slit(2.0 * dx, 0.0)
        seeds = Lattice().fill(cut(flaw), ORIGIN, dx)
        tie[dx] = slit_tie(seeds, flaw, QuadraticBSpline(), dx, ORIGIN).passed
    springs = {dx: passed / (1.0 - passed) for dx, passed in tie.items()}
    assert springs[0.5e-3] == pytest.approx(2.0 * springs[1e-3], rel=0.02)  # ends of the strips: a cell of 30


@pytest.mark.parametrize("shape", [Linear(), Gimp(), QuadraticBSpline()], ids=name_of)
@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0])
def test_faces_without_a_node_in_common_are_free(shape, angle):
    flaw = slit(4.5 * DX, angle)  # corners of a stencil reach 1.5 sqrt(2) = 2.1 cells on both sides
    assert slit_tie(Lattice().fill(cut(flaw), ORIGIN, DX), flaw, shape, DX, ORIGIN) == Tie(0.0, 0.0)


def test_tie_through_one_row_of_nodes_by_hand():
    """Two cells along the grid, B-splines: rows at 1.25 cells from the axis reach its nodes with w' = 1/4 per cell.

    Held at the next nodes, a unit apart, the middle stays: strain 1/8 in the rows, half a cell deep on both sides,
    whose modulus is lambda + 2 mu. Energy per length: 2 x 1/2 x 1/2 x M/64.
    """
    flaw = slit(2.0 * DX, 0.0)
    x = Lattice().fill(cut(flaw), ORIGIN, DX)
    frame = flaw.frame(x.x)
    near = (np.abs(frame[:, 0]) < 0.5 * flaw.length) & (np.abs(frame[:, 1]) < 1.4 * DX)  # the row of both faces alone
    strips = slit_check._Strips(x.x[near], x.volume[near] / DX**2, QuadraticBSpline(), DX, ORIGIN)
    across = flaw.frame(strips.nodes)[:, 1]
    apart = 0.5 * np.sign(np.round(across / DX))[:, None] * np.array([0.0, 1.0])
    energy, stress = strips.moved(np.abs(across) > 0.5 * DX, apart)
    nu = slit_check.POISSON
    modulus = (1.0 - nu) * (1.0 - nu**2) / ((1.0 + nu) * (1.0 - 2.0 * nu))  # over E'
    # the rows' ends give way sideways over a cell or two of 30
    assert energy / (flaw.length / DX) == pytest.approx(0.5 * modulus / 64.0, rel=0.05)
    assert stress == pytest.approx(modulus / 8.0, rel=0.05)


@pytest.mark.parametrize("axis", [0, 1])
def test_box_cut_out_like_a_slit_is_held_to_the_same(axis):
    def notched(width: float) -> Body:
        edges = [0.5 * width, 7.5e-3] if axis == 0 else [7.5e-3, 0.5 * width]
        low, high = (tuple(c + side * e for c, e in zip((0.025, 0.05), edges, strict=True)) for side in (-1.0, 1.0))
        return Body(region=Difference(whole=BLOCK, removed=(Box(lower=low, upper=high),)))

    with pytest.raises(SceneError, match=r"box\.upper = .* its width = 0\.001 m is refused.* at least 0\.001375 m"):
        check_cuts(notched(1.0e-3), QuadraticBSpline(), DX, ORIGIN)
    check_cuts(notched(1.5e-3), QuadraticBSpline(), DX, ORIGIN)
    edge = Difference(whole=BLOCK, removed=(Box(lower=(0.0, 0.02), upper=(0.5e-3, 0.06)),))  # it has one face only
    check_cuts(Body(region=edge), QuadraticBSpline(), DX, ORIGIN)


def test_slits_are_found_however_nested():
    first, second = slit(1.0e-3), slit(1.0e-3, 0.0)
    inner = cut(first)
    outer = Difference(whole=Union(parts=(inner, Disc(centre=(0.2, 0.2), radius=0.01))), removed=(second,))
    assert slits_of(outer) == (first, second)
    assert slits_of(BLOCK) == ()


@pytest.mark.parametrize(
    "field, make",
    [
        ("seeding.particles_per_axis", lambda: Lattice(particles_per_axis=0)),
        ("seeding.particles_per_axis", lambda: Lattice(particles_per_axis=2.0)),
        ("seeding.particles_per_axis", lambda: Jittered(particles_per_axis=9)),
        ("seeding.amount", lambda: Jittered(amount=0.5)),
        ("seeding.amount", lambda: Jittered(amount=-0.1)),
        ("seeding.amount", lambda: Jittered(amount=float("nan"))),
        ("seeding.seed", lambda: Jittered(seed=-1)),
        ("slit.width", lambda: slit(0.0)),
        ("slit.width", lambda: slit(float("nan"))),
        ("slit.width", lambda: slit(0.02)),
        ("slit.angle", lambda: slit(1e-3, float("inf"))),
        ("slit.length", lambda: Slit(centre=(0.0, 0.0), length=-1.0, width=1.0, angle=0.0)),
        ("disc.radius", lambda: Disc(centre=(0.0, 0.0), radius=0.0)),
        ("box.upper", lambda: Box(lower=(0.0, 0.0), upper=(1.0, 0.0))),
        ("box.upper", lambda: Box(lower=(0.0, 0.0), upper=(1.0, 1.0, 1.0))),
    ],
)
def test_impossible_geometry_is_refused_by_field(field, make):
    with pytest.raises(SceneError, match=rf"^{re.escape(field)} = .* is refused: it must be "):
        make()
