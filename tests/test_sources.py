"""The registers are complete: every numbered equation of both sources is in one of them."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest
from equations import PLACE, Register

CHRAPAN = {1: 8, 2: 11, 3: 8, 4: 34, 5: 3, 6: 6, 7: 5}
"""Number of the last equation of each section, (1,1) to (7,5)."""

AKSENOV = {"3.1": 8, "3.2": 12}
"""Number of the last equation of each section, (3.1.1) to (3.2.12)."""

NUMBERED = [
    *(f"({section},{i})" for section, last in CHRAPAN.items() for i in range(1, last + 1)),
    *(f"({section}.{i})" for section, last in AKSENOV.items() for i in range(1, last + 1)),
]

UNNUMBERED = [
    "section 3.1: definitions of sn, cn, dn",
    *(f"section 3.1: property {i}" for i in range(1, 6)),
    "section 3.1: table 2",
]
"""What has no number in the source and is asked for by name."""

MODULES = {
    *("elliptic/test_aksenov", "elliptic/test_chrapan_functions"),
    *("motion/test_chrapan_solution", "motion/test_chrapan_angles"),
}
"""The modules with a register."""


@pytest.fixture
def registered(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Return the places of all equations that are in a register."""
    places: set[str] = set()
    for module in sorted(MODULES):
        folder, name = module.split("/")
        monkeypatch.syspath_prepend(Path(__file__).parent / folder)
        found = vars(import_module(name)).values()
        places.update(*(x.holds for x in found if isinstance(x, Register)))
    return places


def test_every_equation_of_the_sources_is_in_a_register(registered: set[str]) -> None:
    assert len(NUMBERED) == 95
    assert [place for place in [*NUMBERED, *UNNUMBERED] if place not in registered] == []


def test_no_register_has_a_number_that_the_sources_do_not_have(registered: set[str]) -> None:
    numbers = {place for place in registered if PLACE.fullmatch(place) and place[0] == "("}
    assert numbers == set(NUMBERED)


def test_an_equation_without_a_place_is_refused() -> None:
    for name in ("Legendre's relation", "(3,8", "section: nothing", "section 4 d:"):
        with pytest.raises(AssertionError, match="does not begin with a place"):
            Register().equation(name)(lambda: iter(()))
