"""The half disc's finite elements are those of its setup's numbers."""

import pytest

from rsmpm_ti.setups.semicircular import NOTCH_RATIO, STIFFNESS


def test_stiffness_of_the_setup_is_that_of_finite_elements():
    pytest.importorskip("skfem", reason="scikit-fem is missing: pip install -e '.[reference]'")
    from rsmpm_ti.verify.reference.half_disc import stiffness, toughness_ratio

    # a roller takes whole nodes of its edge: its width is known to a quarter, and stiffness goes with its logarithm
    assert stiffness(NOTCH_RATIO) == pytest.approx(STIFFNESS, rel=0.02)
    assert toughness_ratio() == pytest.approx(0.962, abs=0.01)
