"""Lists of names are refused in the same way everywhere."""

from __future__ import annotations

from typing import Any

import pytest
from conftest import Lagtop, assert_one_line
from lagtop import LagtopError

from lagrange_cli.names import check_names, split_names

KNOWN = ["alpha", "beta", "T_nutation"]


def test_names_that_are_fine() -> None:
    assert check_names("keys", ("beta", "alpha"), KNOWN) == ["beta", "alpha"]
    assert check_names("keys", dict.fromkeys(KNOWN), KNOWN) == KNOWN  # type: ignore[arg-type]
    assert split_names("alpha, bottom pass,beta") == ["alpha", "bottom pass", "beta"]


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["gamma"], "keys must be among alpha, beta, T_nutation, got 'gamma'"),
        (["T_nutatoin"], "got 'T_nutatoin' (did you mean 'T_nutation'?)"),
        (["alpha", "alpha"], "keys must not repeat a name, got 'alpha' twice"),
        ([], "keys must be among alpha, beta, T_nutation, got an empty list"),
        ("alpha", "keys must be a list of names, got 'alpha'"),
    ],
)
def test_names_that_are_not(names: Any, message: str) -> None:
    with pytest.raises(LagtopError) as refused:
        check_names("keys", names, KNOWN)
    assert message in str(refused.value)
    assert len(str(refused.value)) < 200
    assert refused.value.key == "keys"


def test_a_long_list_comes_after_the_name_that_was_meant_and_is_cut() -> None:
    known = [f"name{i}" for i in range(66)]
    with pytest.raises(LagtopError) as refused:
        check_names("keys", ["nam7"], known)
    assert str(refused.value) == (
        "keys must be among 66 names, got 'nam7' (did you mean 'name7'?): name0, name1, name2, "
        "name3, name4, name5, name6, name7, name8, name9, name10, name11 and 54 more"
    )


@pytest.mark.parametrize("words", ["sweep --keys r0", "table --columns theta"])
def test_commands_name_the_option_of_a_wrong_list(words: str, lagtop: Lagtop) -> None:
    known, option = words.rsplit(maxsplit=1)[-1], words.split()[1]
    for names in ("", f"{known},", f"{known},x", f"{known} {known}", f"{known},{known}"):
        result = lagtop(*words.split()[:-1], names)
        assert_one_line(result, 2, f"{option} must ")
