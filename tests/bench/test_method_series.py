"""The look of methods in pictures: no two alike, for any kind of colour vision."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from colour_vision import VISIONS, seen

from lagrange_cli.bench.measure import all_methods
from lagrange_cli.bench.pictures import HUES, method_looks
from lagrange_cli.plot.style import LIGHT


@pytest.mark.parametrize("vision", VISIONS)
def test_the_hues_of_the_families_differ_for_everybody(vision: str) -> None:
    """Least distance seen: 27 (the ink and the darkest green, protan)."""
    colours = [seen(colour, VISIONS[vision]) for colour in (*HUES.values(), LIGHT.paper)]
    assert min(np.linalg.norm(p - q) for p, q in combinations(colours, 2)) > 20


def test_no_two_methods_look_alike() -> None:
    found = method_looks(all_methods(1))
    assert len({x[1:] for x in found.values()}) == len(found)  # without any colour
    assert {x.family for x in found.values()} == set(HUES)


def test_forms_of_an_integrator_share_a_mark_and_schemes_of_an_engine_do_not() -> None:
    found = method_looks(
        ["mujoco-euler", "mujoco-rk4", "RK45-euler", "RK45-quaternion", "lagtop", "x"]
    )
    assert next(iter(found)) == "lagtop"
    assert found["RK45-euler"].mark == found["RK45-quaternion"].mark
    assert [name for name, x in found.items() if x.is_dashed] == ["RK45-euler"]
    assert found["mujoco-euler"].mark != found["mujoco-rk4"].mark
    assert found["x"].look()["color"] == LIGHT.quiet
