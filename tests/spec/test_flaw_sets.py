"""Sets of flaws, turned regions, and regions of a scene's own: looked up, checked and measured as all others are."""

import json
import re
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hostile import clear

from rsmpm_ti import (
    AtRest,
    Body,
    Box,
    Difference,
    Disc,
    Domain,
    Lattice,
    Loading,
    Scene,
    Schedule,
    Segments,
    Slit,
    Turned,
    Union,
    load_scene,
)
from rsmpm_ti.errors import SceneError
from rsmpm_ti.spec.regions import cuts_of, filled, slits_of
from rsmpm_ti.spec.review.placement import measure
from rsmpm_ti.spec.review.sentences import review
from rsmpm_ti.spec.scene_json import from_plain, to_plain

DX = 1e-3
PLATE = Box(lower=(0.0, 0.0), upper=(0.04, 0.06))
TRACES = ((0.008, 0.010, 0.020, 0.016), (0.030, 0.030, 0.030, 0.044, 4e-3), (0.012, 0.045, 0.004, 0.050))


def scene(*regions, dim: int = 2) -> Scene:
    """Bodies in a box of 60 x 80 mm (20 mm deep), in cells of 1 mm."""
    return Scene(
        title="flaws",
        domain=Domain(lower=(-0.01, -0.01, 0.0)[:dim], upper=(0.05, 0.07, 0.02)[:dim], dx=DX),
        bodies=tuple(Body(region=region, seeding=Lattice()) for region in regions),
        rock=load_scene("intact").rock,
        loading=Loading(start=AtRest()),
        schedule=Schedule(t_end=1e-5),
    )


def cut(*removed, whole=PLATE) -> Difference:
    return Difference(whole=whole, removed=removed)


def refused(make) -> str:
    with pytest.raises(SceneError) as caught:
        make()
    assert clear(str(caught.value)), caught.value
    return str(caught.value)


# --- sets of flaws


def test_set_of_flaws_is_the_slits_of_its_rows():
    flaws = Segments(traces=TRACES, width=3e-3)
    slits = slits_of(cut(flaws))
    assert slits == slits_of(cut(*flaws.slits))
    assert [slit.width for slit in slits] == [3e-3, 4e-3, 3e-3]
    ends = [(slit.centre - 0.5 * slit.length * slit.direction).tolist() for slit in slits]
    np.testing.assert_allclose(ends, [row[:2] for row in TRACES], atol=1e-12)
    x = np.random.default_rng(1).uniform((0.0, 0.0), (0.04, 0.06), (20_000, 2))
    np.testing.assert_array_equal(flaws.contains(x), np.any([slit.contains(x) for slit in slits], axis=0))
    one, other = (scene(cut(*parts)).particles()[0].x for parts in ((flaws,), slits))
    np.testing.assert_array_equal(one, other)
    assert flaws == Segments(traces=[list(row) for row in TRACES], width=3e-3)
    made = scene(cut(flaws))
    assert from_plain(json.loads(json.dumps(to_plain(made)))) == made


def test_set_of_flaws_goes_through_the_thickness():
    block = Box(lower=(0.0, 0.0, 0.0), upper=(0.04, 0.06, 0.01))
    made = scene(cut(Segments(traces=TRACES, width=3e-3), whole=block), dim=3)
    assert len(made.particles()[0].x) < 80 * 120 * 20


def test_each_flaw_of_a_set_is_checked():
    thin = Segments(traces=(*TRACES, (0.010, 0.030, 0.020, 0.030, 0.4e-3)), width=3e-3)
    assert re.search(r"slit\.width = 0\.0004 m is refused: at 0 degrees", refused(scene(cut(thin)).particles))
    assert "segments.traces[0]" in refused(lambda: Segments(traces=TRACES[:1], width=0.02))
    assert "segments.width" in refused(lambda: Segments(traces=TRACES[:1]))
    assert "segments.traces" in refused(lambda: Segments(traces=((0.0, 0.0, 1.0),), width=1e-3))
    assert "segments.traces[0]" in refused(lambda: Segments(traces=((0.1, 0.1, 0.1, 0.1),), width=1e-3))


def test_traces_may_leave_the_specimen_but_not_all_of_them():
    leaving = Segments(traces=(*TRACES, (0.035, 0.02, 0.048, 0.02), (0.045, 0.01, 0.049, 0.01)), width=3e-3)
    made = scene(cut(leaving))
    (said,) = [line for line in review(made, made.particles()) if "flaws of a set" in line]
    assert said.startswith("2 of the 5 flaws")
    outside = Segments(traces=((0.045, 0.01, 0.049, 0.01), (0.045, 0.02, 0.049, 0.02)), width=1.5e-3)
    assert "segments.traces" in refused(scene(cut(outside)).particles)


def test_table_of_traces_is_read(tmp_path):
    table = tmp_path / "traces.csv"
    table.write_text("x1,y1,x2,y2,width\n# mapped by hand\n8,10,20,16,\n\n30,30,30,44,4\n12,45,4,50\n")
    assert Segments.from_csv(table, width=3e-3, scale=1e-3).traces == tuple(map(pytest.approx, TRACES))
    for text, words in (
        ("1,2,3\n", "line 1 has 3 numbers"), ("1,2,3,4\n1,2,x,4\n", "line 2"), ("", "holds no trace"),
        ("1,2,nan,4\n", "segments.traces"),
    ):  # fmt: skip
        table.write_text(text)
        assert words in refused(lambda: Segments.from_csv(table, width=3e-3))
    table.write_bytes(b"\xff\xfe\x00")
    assert "is no table" in refused(lambda: Segments.from_csv(table, width=3e-3))
    assert "segments.file" in refused(lambda: Segments.from_csv("/dev/zero", width=3e-3))
    table.write_text("1;2;3;4\n")
    assert Segments.from_csv(table, width=0.1).traces == ((1.0, 2.0, 3.0, 4.0),)


def test_a_time_scale_is_estimated_with_a_set_of_flaws():
    shipped = load_scene("cube", quick=True)
    slit = slits_of(shipped.bodies[0].region)[0]
    half = 0.5 * slit.length * slit.direction
    trace = (*(slit.centre - half).tolist(), *(slit.centre + half).tolist())
    region = cut(Segments(traces=(trace,), width=slit.width), whole=shipped.bodies[0].region.whole)
    settings = {"loading.time_scale": "auto"}
    auto = load_scene("cube", quick=True, settings=settings)
    assert replace(auto, bodies=(Body(region=region),)).time_scale == pytest.approx(auto.time_scale, rel=1e-6)


# --- turned regions


def test_turned_box_is_an_inclined_specimen():
    turned = Turned(region=Box(lower=(0.0, 0.0), upper=(0.02, 0.04)), angle=30.0)
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    half = np.array([0.01 * c + 0.02 * s, 0.01 * s + 0.02 * c])
    np.testing.assert_allclose(turned.bounds(), [np.array([0.01, 0.02]) - half, np.array([0.01, 0.02]) + half])
    assert measure(turned) == pytest.approx(0.02 * 0.04)
    (seeds,) = scene(turned).particles()
    assert seeds.volume.sum() == pytest.approx(0.02 * 0.04, rel=0.01)
    made = scene(turned)
    assert from_plain(json.loads(json.dumps(to_plain(made)))) == made


def test_bounds_of_a_turned_region_are_no_larger_than_they_must_be():
    disc, slit = Disc(centre=(0.02, 0.03), radius=0.01), Slit(centre=(0.02, 0.03), length=0.01, width=2e-3, angle=20.0)
    np.testing.assert_allclose(Turned(region=disc, angle=45.0).bounds(), disc.bounds())
    np.testing.assert_allclose(Turned(region=slit, angle=25.0).bounds(), replace(slit, angle=45.0).bounds())
    twice = Turned(region=Turned(region=PLATE, angle=45.0), angle=-45.0)
    np.testing.assert_allclose(twice.bounds(), PLATE.bounds(), atol=1e-12)
    pair = Union(parts=(disc, PLATE))
    turned = Turned(region=pair, angle=90.0, centre=(0.02, 0.03))
    np.testing.assert_allclose(turned.bounds(), [[-0.01, 0.01], [0.05, 0.05]], atol=1e-12)


def test_flaws_turn_with_their_specimen():
    slit = Slit(centre=(0.02, 0.04), length=0.01, width=3e-3, angle=20.0)
    region = Turned(region=cut(slit, Segments(traces=TRACES[:1], width=3e-3)), angle=90.0)
    first, second = slits_of(region)
    np.testing.assert_allclose(first.centre, (0.01, 0.03))
    assert first.angle == pytest.approx(110.0) and second.length == pytest.approx(np.hypot(0.012, 0.006))
    x = np.random.default_rng(2).uniform(*region.bounds(), (20_000, 2))
    held = filled(region).contains(x) & ~first.contains(x) & ~second.contains(x)
    np.testing.assert_array_equal(region.contains(x), held)


def test_turned_slits_and_boxes_are_checked_as_flaws():
    slit = Slit(centre=(0.02, 0.03), length=0.01, width=3e-3, angle=0.0)
    ((_, part),) = cuts_of(cut(Turned(region=slit, angle=30.0)))
    assert part == replace(slit, angle=30.0)
    thin = Box(lower=(0.015, 0.0298), upper=(0.025, 0.0302))
    said = refused(scene(cut(Turned(region=thin, angle=30.0))).particles)
    assert said.startswith("box.upper = (0.025, 0.0302) (turned by 30 degrees): its width = 0.0004 m is refused: at 30")


def test_deep_nests_of_turned_regions_are_refused_and_shallow_ones_are_quick():
    region = PLATE
    for _ in range(18):
        region = Turned(region=region, angle=10.0)
    np.testing.assert_allclose(Turned(region=region, angle=180.0).bounds(), PLATE.bounds(), atol=1e-12)
    region = Turned(region=Turned(region=region, angle=10.0), angle=10.0)
    assert "nested at most 20 deep" in refused(lambda: Turned(region=region, angle=10.0))


# --- regions of a scene's own


@dataclass(frozen=True, kw_only=True)
class Ring:
    """Between two circles; `wrong` says which of its answers is none."""

    wrong: str = ""

    def contains(self, x):
        r = np.hypot(*(x - np.array([0.02, 0.03])).T[:2])
        found = (r > 0.005) & (r < 0.015)
        wrong = {
            "raises": lambda: 1 / 0, "not bool": lambda: found.astype(float), "too few": lambda: found[:-1],
            "one": lambda: True, "columns": lambda: found[:, None], "nothing": lambda: None,
            "empty": lambda: found if len(x) else found[0], "late": lambda: found if len(x) < 500 else found[:3],
        }  # fmt: skip
        return wrong[self.wrong]() if self.wrong in wrong else found

    def bounds(self):
        bounds = {
            "infinite": ((-np.inf, 0.0), (0.0, np.inf)), "nan": ((np.nan, 0.0), (1.0, 1.0)), "no pair": (1.0,),
            "crossed": ((0.035, 0.045), (0.005, 0.015)), "flat": ((0.0,), (1.0,)), "text": ("a", "b"),
            "4d": ((0,) * 4, (1,) * 4), "mixed": ((0.0, 0.0), (1.0, 1.0, 1.0)),
        }  # fmt: skip
        if self.wrong == "gone":
            raise RuntimeError("gone")
        return bounds.get(self.wrong, (np.array([0.005, 0.015]), np.array([0.035, 0.045])))


def test_any_object_that_answers_is_a_region():
    (seeds,) = scene(Ring()).particles()
    assert seeds.volume.sum() == pytest.approx(np.pi * (0.015**2 - 0.005**2), rel=0.02)
    made = scene(Turned(region=Difference(whole=Ring(), removed=(Disc(centre=(0.02, 0.03), radius=0.01),)), angle=10.0))
    (seeds,) = made.particles()
    assert seeds.volume.sum() == pytest.approx(np.pi * (0.015**2 - 0.01**2), rel=0.02)


WRONG = ("raises", "not bool", "too few", "one", "columns", "nothing", "empty", "infinite", "nan", "no pair", "crossed",
         "flat", "text", "4d", "mixed", "gone")  # fmt: skip


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("put", [scene, lambda ring: Union(parts=(PLATE, ring)), lambda ring: cut(ring),
                                 lambda ring: Turned(region=ring, angle=5.0)])  # fmt: skip
def test_wrong_answer_is_refused_when_it_is_put_in(put, wrong):
    assert "Ring." in refused(lambda: put(Ring(wrong=wrong)))


@pytest.mark.parametrize("region", [Ring(wrong="late"), Union(parts=(Ring(wrong="late"),))])
def test_wrong_answer_about_particles_is_refused(region):
    assert "Ring.contains(x) gave 'bool [3]'" in refused(scene(region).particles)
