"""Published numbers: the exact values beside them, by a reference that shares no formula."""

from __future__ import annotations

import mpmath
import pytest
from published import PRINTED, Printed, error, exact, quaternion
from record_reference import State


def name(x: Printed) -> str:
    return f"{x.source}: {x.quantity}"


@pytest.mark.parametrize("x", PRINTED, ids=name)
def test_exact_value(x: Printed) -> None:
    """All digits of the table, and three more, are those of the reference."""
    ours, checked = exact(x), exact(x, by_reference=True)
    assert abs(ours - checked) <= 1e-21 * abs(checked)


def test_the_frame_of_the_prints_is_still_at_the_start() -> None:
    half = mpmath.pi / 2
    parts = map(float, quaternion(State(half, 0, 0, 0, 0, 0)))
    assert list(parts) == pytest.approx([1, 0, 0, 0], abs=1e-12)


def test_what_is_found_of_the_prints() -> None:
    """The finest step of RK67 is not the best, and OTTR is off in the third digit."""
    off = {name(x): abs(float(error(x)[0])) for x in PRINTED}
    test = "EXUDYN explicitLieGroupIntegratorTest, RK67"
    assert off[f"{test}, step 1e-4: omega_y"] < off[f"{test}, step 1e-5: omega_y"]
    assert off["OTTR test_heavy_top: u0"] > 1e-3
    assert max(value for key, value in off.items() if key.startswith("Kynema")) < 2e-6
    right = {name(x) for x in PRINTED if error(x)[1]}
    assert "EXUDYN heavyTop, RK4 in MATLAB: q0" in right
    assert "Kinon and Betsch, steady spin: mean_spin_rate" in right
