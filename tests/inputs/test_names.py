"""Lists of names are refused in the same way everywhere."""

from __future__ import annotations

from typing import Any

import pytest
from conftest import Lagtop
from lagtop import LagtopError, sweep

from lagrange_cli.inputs.names import check_names, split_names

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
        (["alpha", ""], "got ''"),
        ([1], "got 1"),
        (["x" * 5000], f"got '{'x' * 77}...'"),
        ("alpha", "keys must be a list of names, got 'alpha'"),
        (5, "keys must be a list of names, got 5"),
        (None, "keys must be a list of names, got None"),
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


WHERE = {
    "sweep --keys": "r0",
    "table --columns": "theta",
    "bench --n 3 --methods": "lagtop",
    "stability --kinds": "slow-spin",
}


@pytest.mark.parametrize("command", WHERE)
def test_lists_of_names_are_refused_everywhere(command: str, lagtop: Lagtop) -> None:
    known, option = WHERE[command], command.rsplit(maxsplit=1)[-1]
    for names, message in {
        "": "must be among ",
        ",": "must be among ",
        f"{known},": "must be among ",
        f",{known}": "must be among ",
        f"{known},x": "must be among ",
        f"{known} {known}": "must be among ",
        f"{known}, {known}": f"must not repeat a name, got '{known}' twice",
    }.items():
        result = lagtop(*command.split(), names)
        assert (result.exit_code, result.stdout) == (2, "")
        assert result.stderr.startswith(f"Error: {option} {message}"), (names, result.stderr)


@pytest.mark.parametrize("keys", [5, "k", "T_nutation", ["k", "k"], [], ["x"]])
def test_keys_of_the_library(keys: Any) -> None:
    with pytest.raises(LagtopError, match="keys must "):
        sweep(keys=keys)
