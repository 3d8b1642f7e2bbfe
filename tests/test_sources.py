"""The registers are complete: every numbered equation of both sources is in one of them."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest
from equations import Register

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
