"""Guards of `Top`: what is refused, with which message, and that there is no way around them."""

from __future__ import annotations

import copy
import decimal
import json
import pickle
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from lagtop import LagtopError, Top, solve

from lagrange_cli.arithmetic.enclosures import text_of
from lagrange_cli.top.ranges import EvenPoints
from lagrange_cli.top.values import parse_values


@pytest.mark.parametrize("make", [Top, Top().replace])
def test_an_unknown_input_is_refused(make: Any) -> None:
    with pytest.raises(TypeError, match="theta0_deg"):
        make(theta0=30.0)
    with pytest.raises(TypeError):
        make(30, 50)


@pytest.mark.parametrize("value", [Decimal("0.1"), 2**60 + 1, np.int64(2**60 + 1)])
def test_numbers_that_are_not_doubles_are_not_rounded(value: Any) -> None:
    exact = Fraction(value if isinstance(value, Decimal) else int(value))
    third: Any = np.longdouble(1) / 3
    top = Top(r0=value, thetadot0=third)
    assert top.r0 == exact != float(value)
    assert isinstance(top.r0, Fraction)
    longer = np.finfo(np.longdouble).nmant > 52
    assert (top.thetadot0 != 1 / 3) == longer
    motion = solve(top)
    assert motion.record(digits=25, keys=["r0"])["r0"] == text_of(exact, 25)
    assert json.dumps(motion.record(keys=["r0"])) == json.dumps({"r0": float(exact)})


def test_no_way_around_the_guards() -> None:
    top = Top(theta0_deg=40)
    with pytest.raises(LagtopError, match="m must be > 0"):
        top.replace(m=-1)
    with pytest.raises(AttributeError):
        top.m = -1  # type: ignore[misc]
    assert not hasattr(top, "__dict__")
    assert Top(**top.as_dict()) == copy.deepcopy(top) == pickle.loads(pickle.dumps(top)) == top
    assert top.replace(r0=60) == Top(theta0_deg=40, r0=60)
    assert top.replace(theta0_rad=1) == Top(theta0_rad=1)


def test_what_was_given_cannot_be_changed() -> None:
    given: Any = Top(phidot0=60, psidot0="steady").given
    with pytest.raises(TypeError, match="does not support item assignment"):
        given["phidot0"] = 4


def test_nothing_depends_on_the_decimal_context_of_the_host() -> None:
    inputs: dict[str, Any] = {"theta0_deg": Fraction(100, 3), "r0": Fraction(1, 7), "psidot0": 0.1}
    record = solve(Top(**inputs)).record()
    points = parse_values("log:1:1e4:7").at(np.arange(7))
    with decimal.localcontext(decimal.Context(prec=1, Emax=1, Emin=-1)):
        with pytest.raises(LagtopError) as refused:
            Top(theta0_deg=180 + Fraction(1, 3))
        assert str(refused.value).endswith(f"got 180.{'3' * 47}")
        with pytest.raises(LagtopError, match=r"at most 1e9 rows, got 1.000e\+12"):
            EvenPoints(Fraction(0), Fraction(1), 10**12)
        assert solve(Top(**inputs)).record() == record
        assert parse_values("log:1:1e4:7").at(np.arange(7)).tolist() == points.tolist()
