"""Closed values of a top without torque: its axis circles the angular momentum L uniformly.

Nothing of the paper and nothing of the program is used.  With L at the angle Theta to the vertical
and the axis at the angle chi to L, the axis goes round once in 2 pi A/|L|, between the tilts
|Theta - chi| and Theta + chi.  Precession grows by a whole turn where that circle goes round the
vertical, and not at all otherwise; the spin follows from the top's own turning about its axis.
"""

from __future__ import annotations

from typing import Any

from mpmath import mp, mpf

Truth = dict[str, mpf | None]


def free_record(top: Any, digits: int = 60) -> Truth:
    """Return the numbers of the record; None for those a motion without torque does not have."""
    with mp.workdps(digits):
        same = {"a": mpf(0), "k": mpf(0), "k_prime": mpf(1), "nome": mpf(0), "K": mp.pi / 2}
        same |= {"modular_angle_deg": mpf(0), "E": mp.pi / 2}
        absent = dict.fromkeys(("u3", "K_prime", "amplitude_deg", "alpha"))
        moves = top.thetadot0 or top.psidot0
        record = same | absent | (_circle(top) if moves else _at_rest(top))
        noise = mpf(10) ** (10 - digits)
        return {key: x if x is None or abs(x) > noise else mpf(0) for key, x in record.items()}


def _at_rest(top: Any) -> Truth:
    """Return what a top released from rest does: it turns about its own axis, which stands."""
    theta, b = mp.radians(mpf(top.theta0_deg)), mpf(top.C) * mpf(top.r0) / mpf(top.A)
    r0, absent = mpf(top.r0), ("u_quarter", "spin_rate_half", "precession_rate_half")
    return dict.fromkeys(absent) | {
        "b": b,
        "u1": mp.cos(theta),
        "u2": mp.cos(theta),
        "T_nutation": _period(b),
        "theta_min_deg": mpf(top.theta0_deg),
        "theta_max_deg": mpf(top.theta0_deg),
        "mean_spin_rate": r0,
        "spin_rate_start": r0,
        "T_spin": _period(r0),
        "mean_precession_rate": mpf(0),
        "precession_rate_start": mpf(0),
        "T_precession": None,
    }


def _circle(top: Any) -> Truth:
    """Return what a top with other rates does, if no tilt of it is 0 or 180 degrees."""
    A, C, r0 = mpf(top.A), mpf(top.C), mpf(top.r0)
    nutation, precession = mpf(top.thetadot0), mpf(top.psidot0)
    theta = mp.radians(mpf(top.theta0_deg))
    u0, around, b = mp.cos(theta), precession * mp.sin(theta), C * r0 / A
    rate = mp.sqrt(nutation**2 + around**2 + b**2)  # |L|/A
    vertical = around * mp.sin(theta) + b * u0  # L_z/A
    chi, big = mp.acos(b / rate), mp.acos(vertical / rate)
    own = r0 - b  # spin beside the circling, r0 (1 - C/A)
    low, high = abs(big - chi), min(big + chi, 2 * mp.pi - big - chi)
    turns_up, turns_down = big < chi, mp.pi - big < chi
    mean_precession = rate * (int(turns_up) - int(turns_down))
    mean_spin = own + rate * (0 if turns_up != turns_down else (-1 if turns_up else 1))
    u_half = 2 * mp.cos(big) * mp.cos(chi) - u0
    half = (vertical - b * u_half) / (1 - u_half**2)
    starts_highest = not nutation and u0 > u_half
    return {
        "b": b,
        "u1": mp.cos(low),
        "u2": mp.cos(high),
        "u_quarter": mp.cos(big) * mp.cos(chi) if starts_highest else None,
        "T_nutation": _period(rate),
        "theta_min_deg": mp.degrees(low),
        "theta_max_deg": mp.degrees(high),
        "mean_spin_rate": mean_spin,
        "mean_precession_rate": mean_precession,
        "T_spin": _period(mean_spin),
        "T_precession": _period(mean_precession),
        "spin_rate_start": r0 - precession * u0,
        "precession_rate_start": precession,
        "spin_rate_half": r0 - half * u_half,
        "precession_rate_half": half,
    }


def _period(rate: mpf) -> mpf | None:
    """Return the time of a whole turn, or None where nothing turns."""
    return 2 * mp.pi / abs(rate) if rate else None
