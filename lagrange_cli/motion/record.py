"""The keys of a record, in their order: one entry each, from which tables and helps are made."""

# Annotations are evaluated here: as texts, the named tuples would compile each at start-up.

from typing import NamedTuple


class Key(NamedTuple):
    """One key of the record and how it is shown; the unit `angle` stands for degrees or radians."""

    name: str
    group: str
    symbol: str
    meaning: str
    unit: str = ""
    equation: str = ""
    cancels: bool = False
    """A difference of numbers that may be as good as equal: only a proved zero is 0."""


INPUTS = [
    Key("m", "Inputs", "m", "mass", "mass"),
    Key("A", "Inputs", "A", "equatorial moment", "mass len²"),
    Key("C", "Inputs", "C", "polar moment", "mass len²"),
    Key("s", "Inputs", "s", "pivot to mass centre", "len"),
    Key("g", "Inputs", "g", "gravity", "len/time²"),
    Key("r0", "Inputs", "r0", "spin", "rad/time"),
    Key("theta0_deg", "Inputs", "ϑ0", "tilt at the start", "angle"),
    Key("thetadot0", "Inputs", "ϑ'0", "nutation rate at start", "rad/time"),
    Key("psidot0", "Inputs", "ψ'0", "precession rate at start", "rad/time"),
]

_ROOTS, _MODULI, _TURNING = "Roots", "Moduli and integrals", "Turning points and rates"

NUMBERS = [
    Key("a", "Constants", "a", "2mgs/A", "1/time²", "(4,4)"),
    Key("b", "Constants", "b", "C r0/A", "1/time", "(4,5)"),
    Key("u1", _ROOTS, "u1", "cos ϑ, highest", "", "(4,9)", cancels=True),
    Key("u2", _ROOTS, "u2", "cos ϑ, lowest", "", "(4,11)", cancels=True),
    Key("u3", _ROOTS, "u3", "third root", "", "(4,11)"),
    Key("k", _MODULI, "k", "modulus", "", "(4,19)"),
    Key("k_prime", _MODULI, "k'", "complementary modulus", "", "(4,21)"),
    Key("modular_angle_deg", _MODULI, "arcsin k", "modular angle", "angle", "(4,19)"),
    Key("nome", _MODULI, "q", "nome", "", "(2,4)"),
    Key("K", _MODULI, "K", "first kind, k", "", "(5,1)"),
    Key("K_prime", _MODULI, "K'", "first kind, k'", "", "(2,4)"),
    Key("E", _MODULI, "E", "second kind, k", "", "(7,3)"),
    Key("amplitude_deg", _MODULI, "am α", "amplitude of α", "angle", "(7,2)"),
    Key("alpha", _MODULI, "α", "parameter", "", "(1,6)"),
    Key("T_nutation", "Periods", "T", "of the nutation", "time", "(5,1)"),
    Key("T_spin", "Periods", "Tφ", "of the mean spin", "time", "§8", cancels=True),
    Key("T_precession", "Periods", "Tψ", "of the mean precession", "time", "§8", cancels=True),
    Key("u_quarter", _TURNING, "u(T/4)", "cos ϑ at T/4", "", "(5,2)", cancels=True),
    Key("theta_min_deg", _TURNING, "ϑ min", "least tilt", "angle", "(4,9)"),
    Key("theta_max_deg", _TURNING, "ϑ max", "greatest tilt", "angle", "(4,9)"),
    Key("mean_spin_rate", "Mean rates", "φ' mean", "spin", "rad/time", "(6,3)", cancels=True),
    Key("mean_precession_rate", "Mean rates", "ψ' mean", "precession", "rad/time", "(7,3)", True),
    Key("spin_rate_start", _TURNING, "φ'(0)", "spin", "rad/time", "(6,2)", cancels=True),
    Key("spin_rate_half", _TURNING, "φ'(T/2)", "spin", "rad/time", "(6,2)", cancels=True),
    Key("precession_rate_start", _TURNING, "ψ'(0)", "precession", "rad/time", "(4,7)"),
    Key("precession_rate_half", _TURNING, "ψ'(T/2)", "precession", "rad/time", "(4,7)", True),
]
"""The numbers of a record, in its order; `path` and `remark` follow them, `regime` precedes."""

NUMBER_KEYS = [key.name for key in NUMBERS]
CANCELLING = {key.name for key in NUMBERS if key.cancels}


def unit_name(name: str, *, radians: bool) -> str:
    """Return the name of a key in the unit of angles in use: its `_deg` becomes `_rad`."""
    return f"{name.removesuffix('_deg')}_rad" if radians and name.endswith("_deg") else name


def record_keys(*, radians: bool = False) -> list[str]:
    """Return all keys of a record in their order."""
    named = [key.name for key in INPUTS], ["regime"], NUMBER_KEYS, ["path", "remark"]
    return [unit_name(name, radians=radians) for names in named for name in names]
