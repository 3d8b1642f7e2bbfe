"""Motions of many tops in pairs of doubles, for their angles, and for how long to trust them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arithmetic.arrays import PAIRS
from ..arithmetic.double_double import DoubleDouble
from ..arithmetic.points import MAX_TIME
from ..arithmetic.types import Array, Mask
from ..motion.gaps import Gaps, State, gaps_from_rest
from ..motion.kinds import Nutating
from ..motion.regime import Facts, Regime
from .start_arrays import EPS, StartArrays, pair_state
from .top_arrays import TopArrays

_SMALL = 2.0**-56
"""Error of a phase, or of a constant, that is far below a unit of the angles."""


class Start(NamedTuple):
    """Where tops are at t = 0, by sn^2 and cn^2 of their argument w there."""

    sn2: DoubleDouble
    cn2: DoubleDouble
    direction: Array
    """Sign of the nutation rate."""


class PairMotions(NamedTuple):
    """Motions of many nutating tops in pairs of doubles, and how far they can be trusted."""

    motion: Nutating[DoubleDouble]
    start: Start | None
    """None where all tops start at the top of the nutation."""
    noise: Array
    """Bound of the relative errors of the gaps."""
    rate_size: Array
    """Size of what is added up to give the mean rates."""
    sure: Mask

    def part(self, rows: NDArray[np.intp]) -> PairMotions:
        """Return some of the motions, with what is known of them."""
        whole, facts = self.motion, self.motion.facts
        signs = {name: getattr(facts, name)[rows] for name in ("sign_plus", "sign_minus")}
        state, gaps = State(*(x[rows] for x in whole.state)), Gaps(*(x[rows] for x in whole.gaps))
        motion = Nutating(whole.ar, facts.replace(**signs), state, gaps)
        known = {name: x[rows] for name, x in vars(whole).items() if isinstance(x, DoubleDouble)}
        vars(motion).update(known)
        start = self.start
        return PairMotions(
            motion,
            start and Start(start.sn2[rows], start.cn2[rows], start.direction[rows]),
            self.noise[rows],
            self.rate_size[rows],
            self.sure[rows],
        )

    def hyperbolic(self) -> Mask:
        """Return where K > K', so that the series run in the nome of the complement."""
        return self.motion.m.high > 0.5

    def reach(self) -> Array:
        """Return the longest times at which the angles are trusted; NaN where none is."""
        with PAIRS.working():
            period = self.motion.T_nutation.high
            reach = _SMALL / self.noise / (self.rate_size + 8 / period)
            usable = self.sure & (self.noise < _SMALL) & np.isfinite(reach) & (period > 0)
            return np.where(usable, np.minimum(reach, MAX_TIME), np.nan)


def released(tops: TopArrays) -> PairMotions:
    """Return the motions of regular tops released from rest."""
    with PAIRS.working():
        state = pair_state(tops)
        state = state.replace(
            sleep=(state.b * state.b).scaled(0.5) - state.a,
            spin_drift=state.r0 - state.b.scaled(0.5),
        )
        sign = DoubleDouble(np.where(tops.r0 < 0, -1.0, 1.0))
        facts = Facts(
            regime=Regime.REGULAR,
            at_rest=True,
            steady=False,
            free=False,
            spins=True,
            cusp=True,
            sign_plus=sign,
            sign_minus=-sign,
        )
        motion = Nutating(PAIRS, facts, state, gaps_from_rest(PAIRS, state))
        parts = np.maximum(state.a.high, state.b.high**2 / 2)
        noise = EPS * (1 + parts / abs(state.sleep.high))  # lambda - 1 is what cancels
        size = abs(tops.r0) + abs(motion.mean_precession_rate.high)
        return PairMotions(motion, None, noise, size, np.isfinite(noise))


def started(tops: TopArrays) -> PairMotions:
    """Return the motions of tops that start with any rates."""
    starts = StartArrays(tops)
    with PAIRS.working():
        fine = starts.fine
        state, gaps = fine.state, fine.gaps
        signs, sure = [], starts.errors.small
        for momentum in (gaps.beta_plus_b, gaps.beta_minus_b):
            signs.append(DoubleDouble(np.where(momentum.high < 0, -1.0, 1.0)))
            terms = 2 * (abs(state.psi_rate.high) + abs(state.b.high))
            sure = sure & (abs(momentum.high) > _SMALL * terms)
        facts = Facts(
            regime=Regime.REGULAR,
            at_rest=False,
            steady=False,
            free=False,
            spins=True,
            sign_plus=signs[0],
            sign_minus=signs[1],
        )
        motion = Nutating(PAIRS, facts, state, gaps)
        # sn^2 w = (u1 - u)(u3 - u2)/((u3 - u)(u1 - u2)), (4,22)
        sn2, cn2 = gaps.u1_u * gaps.a_u3_u2, gaps.a_u3_u1 * gaps.u_u2
        size = starts.precession_size + abs(state.r0.high)
        start = Start(sn2, cn2, np.where(state.theta_rate.high < 0, -1.0, 1.0))
        return PairMotions(motion, start, starts.noise, size, sure)
