"""The order in which a table shows the keys of a record, and how it names each of them."""

from __future__ import annotations

from typing import NamedTuple


class Line(NamedTuple):
    """The line of a key in a table: symbol, name, unit and the equation that it comes from."""

    key: str
    symbol: str
    name: str
    unit: str = ""
    equation: str = ""


_TOP: dict[str, list[Line]] = {
    "Inputs": [
        Line("m", "m", "mass", "mass"),
        Line("A", "A", "equatorial moment", "mass len²"),
        Line("C", "C", "polar moment", "mass len²"),
        Line("s", "s", "pivot to mass centre", "len"),
        Line("g", "g", "gravity", "len/time²"),
        Line("r0", "r0", "spin", "rad/time"),
        Line("theta0", "ϑ0", "tilt at the start", "angle"),
        Line("thetadot0", "ϑ'0", "nutation rate at start", "rad/time"),
        Line("psidot0", "ψ'0", "precession rate at start", "rad/time"),
    ],
    "Constants": [
        Line("regime", "", "regime"),
        Line("path", "", "path of the axis"),
        Line("a", "a", "2mgs/A", "1/time²", "(4,4)"),
        Line("b", "b", "C r0/A", "1/time", "(4,5)"),
    ],
    "Roots": [
        Line("u1", "u1", "cos ϑ, highest", "", "(4,9)"),
        Line("u2", "u2", "cos ϑ, lowest", "", "(4,11)"),
        Line("u3", "u3", "third root", "", "(4,11)"),
    ],
    "Moduli and integrals": [
        Line("k", "k", "modulus", "", "(4,19)"),
        Line("k_prime", "k'", "complementary modulus", "", "(4,21)"),
        Line("modular_angle", "arcsin k", "modular angle", "angle", "(4,19)"),
        Line("nome", "q", "nome", "", "(2,4)"),
        Line("K", "K", "first kind, k", "", "(5,1)"),
        Line("K_prime", "K'", "first kind, k'", "", "(2,4)"),
        Line("E", "E", "second kind, k", "", "(7,3)"),
        Line("amplitude", "am α", "amplitude of α", "angle", "(7,2)"),
        Line("alpha", "α", "parameter", "", "(1,6)"),
    ],
    "Periods": [
        Line("T_nutation", "T", "of the nutation", "time", "(5,1)"),
        Line("T_spin", "Tφ", "of the mean spin", "time", "§8"),
        Line("T_precession", "Tψ", "of the mean precession", "time", "§8"),
    ],
    "Mean rates": [
        Line("mean_spin_rate", "φ' mean", "spin", "rad/time", "(6,3)"),
        Line("mean_precession_rate", "ψ' mean", "precession", "rad/time", "(7,3)"),
    ],
    "Turning points and rates": [
        Line("u_quarter", "u(T/4)", "cos ϑ at T/4", "", "(5,2)"),
        Line("theta_min", "ϑ min", "least tilt", "angle", "(4,9)"),
        Line("theta_max", "ϑ max", "greatest tilt", "angle", "(4,9)"),
        Line("spin_rate_start", "φ'(0)", "spin", "rad/time", "(6,2)"),
        Line("spin_rate_half", "φ'(T/2)", "spin", "rad/time", "(6,2)"),
        Line("precession_rate_start", "ψ'(0)", "precession", "rad/time", "(4,7)"),
        Line("precession_rate_half", "ψ'(T/2)", "precession", "rad/time", "(4,7)"),
    ],
}

_JACOBI: dict[str, list[Line]] = {
    "Moduli": [
        Line("k", "k", "modulus"),
        Line("k_prime", "k'", "complementary modulus"),
        Line("modular_angle", "arcsin k", "modular angle", "angle"),
        Line("nome", "q", "nome", "", "(3.1.6)"),
        Line("nome_prime", "q'", "nome of k'", "", "(3.1.6)"),
    ],
    "Complete integrals": [
        Line("K", "K", "first kind, k", "", "(3.1.2)"),
        Line("K_prime", "K'", "first kind, k'", "", "(3.1.2)"),
        Line("E", "E", "second kind, k"),
        Line("E_prime", "E'", "second kind, k'"),
    ],
}

_ETA: dict[str, list[Line]] = {
    "Roots": [
        Line("delta", "δ", "upper end of the band", "", "(3.2.1)"),
        Line("delta_star", "δ*", "lower end of the band", "", "(3.2.1)"),
        Line("p", "p'", "middle of the outer roots", "", "(3.2.1)"),
        Line("q", "q'", "half their distance", "", "(3.2.1)"),
        Line("outer_root", "", "the finite outer root"),
        Line("layout", "", "outer roots"),
        Line("g", "g", "-2 α1 c²", "1/time²", "(3.2.1)"),
    ],
    "Constants": [
        Line("m_prime", "m'", "at δ", "", "(3.2.3)"),
        Line("m_double_prime", 'm"', "at δ*", "", "(3.2.3)"),
        Line("k", "k", "modulus of (3.2.4)", "", "(3.2.5)"),
        Line("k1", "k1", "modulus", "", "(3.2.8)"),
        Line("k1_prime", "k1'", "complementary modulus"),
        Line("K1", "K1", "first kind, k1", "", "(3.2.8)"),
        Line("sigma1", "σ1", "rate of the argument", "1/time", "(3.2.8)"),
        Line("s", "s", "amplitude of sn", "", "(3.2.12)"),
        Line("d", "d", "of the denominator", "", "(3.2.12)"),
        Line("gamma", "γ", "shift", "", "(3.2.12)"),
        Line("period", "T", "of η, 4 K1/σ1", "time", "(3.2.10)"),
    ],
}

LAYOUTS = {"top": _TOP, "jacobi": _JACOBI, "eta": _ETA}
"""The groups of lines by kind of record: of a top, of a modulus, of a quadrature."""
