"""How a table shows the keys of a record: their order, and a name for each of them."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple


class Line(NamedTuple):
    """The line of a key in a table: symbol, name, unit and the equation that it comes from."""

    key: str
    symbol: str
    name: str
    unit: str = ""
    equation: str = ""


Layout = Mapping[str, Sequence[Line]]
"""Groups of lines by name."""

JACOBI: Layout = {
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


def in_parts(layout: Layout, keys: Collection[str]) -> Layout:
    """Return a layout of complex numbers, each as a line of its real and its imaginary part.

    Only lines whose keys are among `keys` are there.
    """
    return {
        group: [
            line._replace(key=f"{line.key}_{part}", symbol=f"{sign} {line.symbol}")
            for line in lines
            for part, sign in (("re", "Re"), ("im", "Im"))
            if f"{line.key}_{part}" in keys
        ]
        for group, lines in layout.items()
    }


ETA: Layout = {
    "Roots": [
        Line("delta", "δ", "upper end of the band", "", "(3.2.1)"),
        Line("delta_star", "δ*", "lower end of the band", "", "(3.2.1)"),
        Line("p", "p'", "middle of the outer roots", "", "(3.2.1)"),
        Line("q", "q'", "half their distance", "", "(3.2.1)"),
        Line("q_imag", "q'/i", "of a complex pair", "", "(3.2.1)"),
        Line("outer_root", "", "the finite outer root"),
        Line("layout", "", "outer roots"),
        Line("kind", "", "radicand"),
        Line("g", "g", "-2 α1 c²", "1/time²", "(3.2.1)"),
    ],
    "Constants": [
        Line("m_prime", "m'", "at δ", "", "(3.2.3)"),
        Line("m_double_prime", 'm"', "at δ*", "", "(3.2.3)"),
        Line("k", "k", "modulus of (3.2.4)", "", "(3.2.5)"),
        Line("k_imag", "k/i", "imaginary modulus of (3.2.4)", "", "(3.2.5)"),
        Line("k1", "k1", "modulus", "", "(3.2.8)"),
        Line("k1_imag", "k1/i", "imaginary modulus", "", "(3.2.8)"),
        Line("k1_prime", "k1'", "complementary modulus"),
        Line("K1", "K1", "first kind, k1", "", "(3.2.8)"),
        Line("sigma1", "σ1", "rate of the argument", "1/time", "(3.2.8)"),
        Line("s", "s", "amplitude of sn", "", "(3.2.12)"),
        Line("d", "d", "of the denominator", "", "(3.2.12)"),
        Line("gamma", "γ", "shift", "", "(3.2.12)"),
        Line("period", "T", "of η, 4 K1/σ1", "time", "(3.2.10)"),
        Line("tau3", "τ3", "c3 - K1/σ1", "time", "(3.2.10)"),
    ],
}
