"""Complete integrals, the nome, places within a period and R_F, against mpmath.

Each is computed for arrays of doubles, of pairs of doubles, and as balls.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest

from lagrange_cli.arithmetic.arrays import ARRAYS, PAIRS
from lagrange_cli.arithmetic.ball import balls
from lagrange_cli.arithmetic.pairs import DoubleDouble
from lagrange_cli.elliptic import complete
from lagrange_cli.elliptic.carlson import carlson_rf

COMPLEMENTS = [1e-7, 0.01, 0.3, 0.70710678, 0.99, 1.0]
RATIOS = [(0.0, 1.0), (1e-60, 1.0), (0.3, 0.7), (2.0, 1e-30), (1.0, 0.0)]
"""Numbers s2 : c2, as sn^2 : cn^2."""


def _place(m: Any, s2: Any, c2: Any) -> Any:
    """Return pi F(phi, m) for the amplitude with tan^2 phi = s2/c2."""
    return mpmath.pi * mpmath.ellipf(mpmath.atan2(mpmath.sqrt(s2), mpmath.sqrt(c2)), m)


def _squares(k: Any) -> dict[str, Any]:
    return {"m": (1 - k) * (1 + k), "k_prime": k}


def _mean_there(k: Any) -> Any:
    """(2 cn^2 + 3 sn^2)/(cn^2 + p sn^2) is (a + (b - a) sn^2)/(1 - n sn^2), n = 1 - p."""
    share = mpmath.ellippi(0.625, 1 - k * k) / mpmath.ellipk(1 - k * k)
    return share * mpmath.mpf(18) / 5 - mpmath.mpf(8) / 5


OF_A_COMPLEMENT: dict[str, tuple[Callable[..., Any], Callable[..., Any]]] = {
    "agm": (lambda ar, k: complete.agm(ar, 1, k), lambda k: mpmath.agm(1, k)),
    "K": (complete.complete_k, lambda k: mpmath.ellipk(1 - k * k)),
    "E": (complete.complete_e, lambda k: mpmath.ellipe(1 - k * k)),
    "mean": (lambda ar, k: complete.period_mean(ar, k, 0 * k + 0.375, 2, 3), _mean_there),
    "nome": (
        lambda ar, k: complete.nome(ar, **_squares(k)),
        lambda k: mpmath.qfrom(m=1 - k * k),
    ),
    "R_F": (
        lambda ar, k: carlson_rf(ar, 0 * k, k, 5 + k),
        lambda k: mpmath.elliprf(0, k, 5 + k),
    ),
    "place": (
        lambda ar, k: complete.place(ar, **_squares(k), sn=0 * k + 0.5, cn2=0 * k + 0.75),
        lambda k: _place(1 - k * k, 1, 3) / mpmath.ellipk(1 - k * k) / 2,
    ),
}
"""Functions of ar and k', and the same by mpmath."""


def check(ours: Callable[..., Any], exact: list[Any], inputs: Sequence[tuple[float, ...]]) -> None:
    """Compare a function of ar and numbers, for all inputs at once or one by one, with mpmath."""
    columns = [np.array(column) for column in zip(*inputs, strict=True)]
    double = ours(ARRAYS, *columns)
    pair = ours(PAIRS, *map(DoubleDouble, columns))
    for i, (numbers, true) in enumerate(zip(inputs, exact, strict=True)):
        assert abs(mpmath.mpf(double[i]) - true) <= 2e-15 * abs(true), numbers
        both = mpmath.mpf(pair.high[i]) + mpmath.mpf(pair.low[i])
        assert abs(both - true) <= 1e-29 * abs(true), numbers
        with balls(50) as ar:
            ball = ours(ar, *(ar.convert(Fraction(x)) for x in numbers)).x
            middle = mpmath.mpf(ball.mid().str(70, radius=False))
            assert abs(middle - true) <= float(ball.rad()) + 1e-60, numbers
            assert float(ball.rad()) <= 1e-38 * max(abs(true), 1e-40), numbers


@pytest.mark.parametrize("name", OF_A_COMPLEMENT)
def test_functions_of_a_complement(name: str) -> None:
    ours, theirs = OF_A_COMPLEMENT[name]
    usual = COMPLEMENTS[:-1] if name == "nome" else COMPLEMENTS  # q of k = 0 is 0
    with mpmath.workdps(70):
        check(ours, [theirs(mpmath.mpf(k)) for k in usual], [(k,) for k in usual])


@pytest.mark.parametrize("part", [0, 1])
@pytest.mark.parametrize("imaginary", [False, True])
def test_places(imaginary: bool, part: int) -> None:
    """Cosine and sine of x = pi u/2K and, hyperbolic, of y = pi v/2K."""
    function = complete.cosine_and_sine
    if imaginary:
        function = complete.hyperbolic_cosine_and_sine
    inputs = [(k, *ratio) for k in (0.25, 0.75) for ratio in RATIOS]

    def ours(ar: Any, k: Any, s2: Any, c2: Any) -> Any:
        return function(ar, **_squares(k), s2=s2, c2=c2)[part]

    def theirs(k: Any, s2: Any, c2: Any) -> Any:
        m = 1 - k * k
        x = _place(1 - m if imaginary else m, s2, c2) / (2 * mpmath.ellipk(m))
        functions = (mpmath.cosh, mpmath.sinh) if imaginary else (mpmath.cos, mpmath.sin)
        return mpmath.mpf(0) if not (imaginary or part or c2) else functions[part](x)

    with mpmath.workdps(70):
        check(ours, [theirs(*map(mpmath.mpf, numbers)) for numbers in inputs], inputs)
