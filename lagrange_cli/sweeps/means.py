"""The mean rates of many motions, from the means over a period of two parts of psi' (4,7).

Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..arithmetic.bounded import (
    Bounded,
    best,
    choose,
    relative_errors,
    root_of,
    size_of,
    sqrt,
    unit_of,
)
from ..arithmetic.pairs import DoubleDouble
from .gaps import Gaps

_STEPS = 11


def mean_rates(of: Any) -> tuple[Bounded, Bounded]:
    """Return the mean rates of spin (6,3) and precession (7,3) from some `ArrayNumbers`."""
    if of.steady:
        return of["r0"] - of["psidot0"] * of["u0"] * (not of.vertical), of["psidot0"]
    if of.plane:  # a half turn at each passage of a pole
        half, turns = of["pi"] / of["T_nutation"], of.over_top
        return choose(turns, Bounded(0.0), half), choose(turns, 2.0 * half, half)
    r0, b, k_prime, gaps = (of[name] for name in ("r0", "b", "k_prime", "gaps"))
    if of.regime is not None:  # released: at u1 without precession
        south, north = mean_parts(gaps, k_prime, gaps.rise, gaps.fall)
        return r0 + b * (south - north), b * (south + north)
    south, north = mean_parts(gaps, k_prime, *of["momenta"])
    if of.pairs:
        ends, past = (gaps.below_u1, gaps.below_u2), gaps.far + of["a"] * of["below_u0"]
        south = best(south, lambda: part_next_to(ends, k_prime, past, of["beta_plus_b"], -b))
        ends, past = (gaps.above_u1, gaps.above_u2), gaps.a_above_u3
        north = best(north, lambda: part_next_to(ends, k_prime, past, of["beta_minus_b"], b))
    return r0 + south - north, south + north


def mean_parts(gaps: Gaps, k_prime: Bounded, x: Bounded, y: Bounded) -> list[Bounded]:
    """Return the means over a period of the partial fractions of psi' (4,7) at both poles,

        south = (beta - b u)/(2 (1 + u)),    north = (beta - b u)/(2 (1 - u)),

    from x and y, beta - b u at u1 and u2.  Then psi' = south + north, phi' = r0 + south - north.

    If x and y have one sign, a relative error is at most that of x, y and d = 1 +- u, twice that of
    k' (which changes the weight of each time), and ten roundings for each step, which only adds
    numbers of one sign.  Otherwise it is relative to the mean of the sizes.
    """
    ends = [(gaps.below_u1, gaps.below_u2), (gaps.above_u1, gaps.above_u2)]
    values, steps = _means(
        k_prime.value, [(d1.value, d2.value) for d1, d2 in ends], x.value, y.value
    )
    unit, positive = unit_of(k_prime.value), x.positive and y.positive
    of_momenta = np.maximum(relative_errors(x), relative_errors(y))
    mixed = np.flatnonzero(x.doubles * y.doubles < 0)
    found = []
    for (d1, d2), value in zip(ends, values, strict=True):
        rho = np.maximum(relative_errors(d1), relative_errors(d2)) + 2 * relative_errors(k_prime)
        rho = rho + 10 * unit * ((_STEPS if positive else steps) + 1)
        if positive and not np.ndim(rho + of_momenta):
            found.append(Bounded(value, None, rho + of_momenta, positive=True) * 0.5)
            continue
        error = (rho + of_momenta) * size_of(value)
        if mixed.size:
            k, *d = (v.doubles[mixed] for v in (k_prime, d1, d2))
            sizes = (v.error[mixed] + rho[mixed] * v.size[mixed] for v in (x, y))
            error[mixed] = _means(k, [d], *sizes)[0][0]
        found.append(Bounded(value, error, positive=positive) * 0.5)
    return found


def part_next_to(
    ends: tuple[Bounded, Bounded], k_prime: Bounded, past: Bounded, momentum: Bounded, b: Bounded
) -> Bounded:
    """Return a part of `mean_parts` as b/2 and the mean of c/(2 d), c = beta -+ b, next to a pole.

    By f(+-1), c^2 = d1 d2 `past`, where `past` is the size of a (u3 -+ 1).  So the mean of |c|/d is
    the root of `past` times a function of k' and r, the root of the smaller one of d1/d2 and d2/d1.
    Its relative derivative by log k' is at most 2, and that by log r is at most 1 and at most
    1.9 r/k', as an integral over tan(x)/r shows.
    """
    d1, d2 = ends
    c = sqrt(d1 * d2 * past).value
    (value,), steps = _means(k_prime.value, [(d1.value, d2.value)], c, c)
    ratio = d1.doubles / d2.doubles
    weight = np.minimum(1.0, 2.0 * np.sqrt(np.minimum(ratio, 1 / ratio)) / k_prime.doubles)
    of_ends = relative_errors(d1) + relative_errors(d2)
    relative = 0.5 * (relative_errors(past) + weight * of_ends) + 2 * relative_errors(k_prime)
    relative = relative + 10 * unit_of(value) * (steps + 1)
    known = (of_ends < 0.01) & momentum.is_not_0()
    size = Bounded(value, np.where(known, relative * size_of(value), np.inf))
    return 0.5 * (size * np.sign(momentum.doubles) + b)


def _means(k_prime: Any, ends: Sequence[Any], x: Any, y: Any) -> tuple[list[Any], Any]:
    """Return the means over a period of (x cn^2 + y sn^2)/(d1 cn^2 + d2 sn^2) for each (d1, d2) of
    `ends`, and the number of steps of each top, on which its neighbours have no influence.

    It is Bulirsch's cel(k', p, x, y)/K (DLMF 19.2.11), p = k'^2 d2/d1, over d1.  Each step is
    Bartky's transformation (Bulirsch 1969), which keeps it and squares the distance of m from g.
    A mean that needs too many steps is NaN.
    """
    close_to = 2.0**-52 if isinstance(k_prime, DoubleDouble) else 2.0**-26
    m, g, mc, states = 0.0 * k_prime + 1.0, k_prime, k_prime * k_prime, []
    for d1, d2 in ends:
        p = root_of(mc * d2 / d1)
        states.append((x / d1, y * mc / d1 / p, p))
    values, going = [v * np.nan for v, _, _ in states], np.ones(size_of(k_prime).shape, np.bool_)
    steps = np.zeros(going.shape)
    for _ in range(_STEPS):
        product = m * g
        for i, (v, w, p) in enumerate(states):
            q = product / p
            states[i] = (v + w / p) * 0.5, (w + v * q) * 0.5, (p + q) * 0.5
        still = going & (size_of(m - g) > close_to * size_of(m))
        m, g = (m + g) * 0.5, root_of(product)
        steps += going
        if (done := going & ~still).any():
            pick = DoubleDouble.choose if isinstance(m, DoubleDouble) else np.where
            last = [(v * m + w) / (m + p) for v, w, p in states]
            values = [pick(done, new, old) for new, old in zip(last, values, strict=True)]
        going = still
        if not going.any():
            break
    return values, steps
