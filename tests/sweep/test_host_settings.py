"""Results do not depend on the NumPy errstate or the decimal context of the host program."""

from __future__ import annotations

import decimal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from lagtop import sweep

EXTREME: dict[str, Any] = {
    "theta0_deg": [0, 1e-150, 1e-9, 180, 179.9999999, 30],
    "r0": [[1e-30], [0], [1e30], [50]],
}
MOVING = EXTREME | {"psidot0": 1.5, "thetadot0": [[[0.0]], [[1e-40]], [[3.0]]]}
FEW = {"theta0_deg": [0, 1e-9, 30], "r0": [[0], [50]], "psidot0": [[[0]], [[1]]]}


@contextmanager
def hostile() -> Iterator[None]:
    """Make every rounding of decimals and every exception of NumPy an error."""
    context = decimal.Context(prec=1, Emin=-1, Emax=1, traps=[decimal.Inexact, decimal.Rounded])
    with np.errstate(all="raise"), decimal.localcontext(context):
        yield


def same(compute: Callable[[], Any]) -> None:
    """Assert that a result is the same to the last bit with hostile settings."""
    usual = compute()
    with hostile():
        result = compute()
    for one, other in zip(usual, result, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(
    "inputs", [FEW, *(pytest.param(x, marks=pytest.mark.slow) for x in (EXTREME, MOVING))]
)
def test_sweep(inputs: dict[str, Any]) -> None:
    same(lambda: sweep(**inputs).values())
    same(lambda: sweep(**inputs, keys=["steady_rate_fast", "f_upright", "Lz"]).values())
