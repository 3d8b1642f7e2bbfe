"""The registers hold every numbered equation of both sources, and published numbers are right."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest
from equations import Register
from published import PRINTED, QUANTITIES, Printed, exact, motion
from record_reference import reference_columns

CHRAPAN = {"1": 8, "2": 11, "3": 8, "4": 34, "5": 3, "6": 6, "7": 5}
"""Number of the last equation of each section, (1,1) to (7,5)."""
AKSENOV = {"3.1": 8, "3.2": 12}
"""Number of the last equation of each section, (3.1.1) to (3.2.12)."""
NUMBERED = {
    f"({section}{mark}{i})"
    for mark, sections in ((",", CHRAPAN), (".", AKSENOV))
    for section, last in sections.items()
    for i in range(1, last + 1)
}
UNNUMBERED = 62
"""How many equations without a number of their own are in a register: none may be lost."""
MODULES = [
    *("elliptic/test_aksenov", "elliptic/test_chrapan_functions"),
    "solver/test_chrapan_motion",
]
"""The modules with a register."""


def test_every_equation_of_the_sources_is_in_a_register(monkeypatch: pytest.MonkeyPatch) -> None:
    places: set[str] = set()
    for module in MODULES:
        path = Path(__file__).parent / module
        monkeypatch.syspath_prepend(path.parent)
        found = vars(import_module(path.name)).values()
        places.update(*(x.holds for x in found if isinstance(x, Register)))
    assert NUMBERED - places == set()
    assert (len(NUMBERED), len(places - NUMBERED)) == (95, UNNUMBERED)


@pytest.mark.parametrize(
    "name", ["Legendre's relation", "(3,8", "section: nothing", "section 4 d:"]
)
def test_an_equation_without_a_place_is_refused(name: str) -> None:
    with pytest.raises(AssertionError, match="does not begin with a place"):
        Register(__name__).enter(f"{name} | 1 = 1")


# Published numbers: the exact values beside them, by a reference with other formulas


def name(x: Printed) -> str:
    return f"{x.source}: {x.quantity}"


@pytest.mark.parametrize("x", PRINTED, ids=name)
def test_exact_value(x: Printed) -> None:
    """All digits of the table, and three more, are those of the reference."""
    ours, checked = exact(x), exact(x, by_reference=True)
    assert abs(ours - checked) <= 1e-21 * abs(checked)


def test_the_frame_of_the_prints_is_still_at_the_start() -> None:
    start = reference_columns(motion("bruels-cardona-arnold").top.as_dict(), 0)
    names = ["q0", "q1", "q2", "q3", "u0", "u1", "u2", "Rot x", "Rot y", "Rot z"]
    parts = [float(QUANTITIES[name](start)) for name in names]
    assert parts == pytest.approx([1, *[0] * 9], abs=1e-12)
