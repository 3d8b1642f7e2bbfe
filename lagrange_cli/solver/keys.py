"""The keys: each number is declared once, with the formula that is printed and evaluated.

A line of the table is

    name | symbol | meaning | unit | equation | formula | condition | lacking

and a group of keys begins with `#`.  An indented line continues the line before.  To add a key, add
a line: `solve`, `explain`, sweeps and the READMEs take it from here.

The unit `cos` means a cosine, whose error counts as an angle does: relative to 1.  A motion lacks a
number if it lacks one that the evaluated formula names, if the condition is false, or if it is of a
kind among the `lacking`: steady, vertical, separatrix.

Formulas use names of keys and inputs, without the unit of an angle, and the functions of `numbers`.
`left = right` is an equation that the key satisfies.  If a limit needs another form than the
printed one, the form that is evaluated follows after `~`.  It uses the distances of the roots,
which are finite without torque, and exactly 0 if two roots coincide:

    height = u1 - u2,    wide = a (u3 - u2),    narrow = a (u3 - u1),    far = a (u3 - u0),
    rise = u1 - u0,    fall = u0 - u2,    above_u1 = 1 - u1,    below_u1 = 1 + u1  and so on

`where` names lines of the last group.  That group also has the numbers that only remarks and
`Motion.swing` need.  Equation numbers are Chrapan's, for release from rest.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from typing import Any

from ..names import Key
from ..top.derived import FAST, SLOW
from ..top.inputs import DECLARED, FORMS, NINE, TILT, declared
from ..top.units import DEGREES, Units, bare_name

_TEXT = """
# Constants
a | a | 2mgs/A | 1/time² | (4,4) | 2*m*g*s/A
b | b | C r0/A | 1/time | (4,5) | C*r0/A
# Roots
u1 | u1 | greatest cos ϑ | cos | (4,9)
   | (energy_constant - a*u1)*(1 - u1**2) = (momentum_constant - b*u1)**2 ~ roots[1]
u2 | u2 | least cos ϑ | cos | (4,9)
   | (energy_constant - a*u2)*(1 - u2**2) = (momentum_constant - b*u2)**2 ~ roots[0]
u3 | u3 | third root | | (4,9)
   | (energy_constant - a*u3)*(1 - u3**2) = (momentum_constant - b*u3)**2 ~ u2 + wide/a
   | if there is a torque | vertical
# Moduli and integrals
k | k | modulus | | (4,19) | sqrt((u1 - u2)/(u3 - u2)) ~ sqrt(m_k) | | vertical
k_prime | k' | complementary modulus | | (4,21)
   | sqrt((u3 - u1)/(u3 - u2)) ~ sqrt(m_k_prime) | | vertical
modular_angle_deg | arcsin k | modular angle | angle | (4,19) | asin(k) ~ atan2(k, k_prime)
nome | q | nome | | (2,4) | exp(-pi*K_prime/K) ~ nome_of(k, k_prime)
K | K | complete integral, first kind | | (5,1)
   | ellint_F(pi/2, k) ~ pi/(2*agm(1, k_prime)) | | separatrix
K_prime | K' | complementary integral, first kind | | (2,4)
   | ellint_F(pi/2, k_prime) ~ pi/(2*agm(1, k)) | if k > 0
E | E | complete integral, second kind | | (7,3) | ellint_E(pi/2, k) ~ complete_E(k_prime)
amplitude_deg | am α | amplitude of α | angle | (7,2)
   | asin(sqrt((u3 - u2)/(u3 + 1))) ~ atan2(sqrt(wide), sqrt(a*below_u2))
   | if the top is released from rest | steady separatrix
alpha | α | parameter of Chrapan's Π | | (1,6)
   | ellint_F(amplitude, k_prime) ~ integral_F(sqrt(wide), sqrt(a*below_u2), k)
   | if the top is released from rest | steady separatrix
# Periods
T_nutation | T | nutation period | time | (5,1) | 4*K/sqrt(a*(u3 - u2)) ~ 4*K/sqrt(wide)
   | if the top moves
T_spin | Tφ | mean spin period | time | §8 | 2*pi/abs(mean_spin_rate)
   | if the mean spin rate is not 0
T_precession | Tψ | mean precession period | time | §8 | 2*pi/abs(mean_precession_rate)
   | if the mean precession rate is not 0
# Turning points
u_quarter | u(T/4) | cos ϑ at T/4 | cos | (5,2)
   | u3 - sqrt(u3 - u1)*sqrt(u3 - u2) ~ V | if the start is at u1 | steady separatrix
theta_min_deg | ϑ min | least tilt | angle | (4,6)
   | acos(u1) ~ 2*atan2(sqrt(above_u1), sqrt(below_u1))
theta_max_deg | ϑ max | greatest tilt | angle | (4,6)
   | acos(u2) ~ 2*atan2(sqrt(above_u2), sqrt(below_u2))
# Mean rates
mean_spin_rate | φ' mean | mean spin rate | rad/time | (6,3)
   | r0 - b - (P - Q)/(2*K) where P, Q ~ means[0] | | separatrix
mean_precession_rate | ψ' mean | mean precession rate | rad/time | (7,3)
   | (P + Q)/(2*K) where P, Q ~ means[1] | | vertical separatrix
# Rates
spin_rate_start | φ'(0) | spin rate at the start | rad/time | (6,2) | r0 - psidot0*cos(theta0)
   | if the axis does not leave the vertical at the start
spin_rate_half | φ'(T/2) | spin rate at T/2 | rad/time | (6,2) | r0 - U*precession_rate_half where U
   | if the axis is not vertical half a period after the start
precession_rate_start | ψ'(0) | precession rate at the start | rad/time | (4,7) | psidot0
   | if the axis does not leave the vertical at the start | vertical
precession_rate_half | ψ'(T/2) | precession rate at T/2 | rad/time | (4,7)
   | (momentum_constant - b*U)/(1 - U**2) where U
   ~ (momentum + b*(fall - rise*wide/far))
   /((above_u1 + fall*narrow/far)*(below_u2 + rise*wide/far))
   | if the axis is not vertical half a period after the start | steady separatrix
# Constants of section 4
energy_without_spin | c1 | energy without the spin part | mass len²/time² | (4,2)
   | A*(thetadot0**2 + psidot0**2*sin(theta0)**2)/2 + m*g*s*cos(theta0)
Lz | c2 | vertical angular momentum | mass len²/time | (4,3)
   | A*psidot0*sin(theta0)**2 + C*r0*cos(theta0)
energy_constant | α₄ | energy c1 over A/2 | 1/time² | (4,4) | 2*energy_without_spin/A
momentum_constant | β | momentum c2 over A | 1/time | (4,5) | Lz/A
discriminant | D | discriminant, (a (u3 - u2))² | 1/time⁴ | (4,10) | (a*(u3 - u2))**2 ~ wide**2
f_upright | f(1) | f(u) = u'² at u = 1 | 1/time² | (4,9)
   | -(momentum_constant - b)**2 ~ -beta_minus_b**2
f_hanging | f(-1) | f(u) = u'² at u = -1 | 1/time² | (4,9)
   | -(momentum_constant + b)**2 ~ -beta_plus_b**2
f_slope_u1 | f'(u1) | slope of f(u) at u1 | 1/time² | (4,9)
   | -a*(u1 - u2)*(u3 - u1) ~ -height*narrow
u2_criterion | a u2 u3 | criterion for the sign of u2 | 1/time² | (4,12)
   | a*u2*u3 ~ u2*(wide + a*u2) | | vertical
spin_share | 1 - C/2A | factor of r0 in the mean spin rate | | (6,1) | 1 - C/(2*A)
# Angles after half a period and after a period
phi_half_deg | φ(T/2) | spin after half a period | angle | §6
   | integral(phidot, 0, T_nutation/2) ~ half[0]
   | if the top nutates, and the axis is not vertical half a period after the start
phi_period_deg | φ(T) | spin after a period | angle | §6 | mean_spin_rate*T_nutation
   | if the top nutates
psi_half_deg | ψ(T/2) | precession after half a period | angle | §7
   | integral(psidot, 0, T_nutation/2) ~ half[1]
   | if the top nutates, and the axis is not vertical half a period after the start
psi_period_deg | ψ(T) | precession after a period | angle | §7 | mean_precession_rate*T_nutation
   | if the top nutates
# Mean rates of the quarters
nutation_rate_upper | ϑ' 1st | mean nutation rate, quarter after u1 | rad/time | §5
   | 4*(acos(V) - theta_min)/T_nutation where V
   ~ 8*atan2(height*k_prime/(1 + k_prime), sine_V + sqrt(above_u1*below_u1))/T_nutation
   | if the top nutates
nutation_rate_lower | ϑ' 2nd | mean nutation rate, quarter before u2 | rad/time | §5
   | 4*(theta_max - acos(V))/T_nutation where V
   ~ 8*atan2(height/(1 + k_prime), sine_V + sqrt(above_u2*below_u2))/T_nutation
   | if the top nutates
spin_rate_upper | φ' 1st | mean spin rate, quarters at u1 | rad/time | §6
   | 4*integral(phidot, t1, t1 + T_nutation/4)/T_nutation ~ 4*quarter[0]/T_nutation
   | if the top nutates and does not pass over a pole
spin_rate_lower | φ' 2nd | mean spin rate, quarters at u2 | rad/time | §6
   | 2*mean_spin_rate - spin_rate_upper | if the top nutates and does not pass over a pole
precession_rate_upper | ψ' 1st | mean precession rate, quarters at u1 | rad/time | §7
   | 4*integral(psidot, t1, t1 + T_nutation/4)/T_nutation ~ 4*quarter[1]/T_nutation
   | if the top nutates and does not pass over a pole
precession_rate_lower | ψ' 2nd | mean precession rate, quarters at u2 | rad/time | §7
   | 2*mean_precession_rate - precession_rate_upper
   | if the top nutates and does not pass over a pole
# Steps of section 8 | if the top nutates after release from rest
roots_sum | u3 + u2 | sum of u2 and u3 | | (4,11) | b**2/a
roots_product | u3 u2 | product of u2 and u3 | | (4,12) | b**2*u1/a - 1
roots_sum_squared | (u3 + u2)² | square of the sum | | §8 | roots_sum**2
roots_product_fourfold | -4 u3 u2 | -4 times the product | | §8 | -4*roots_product
roots_gap_squared | (u3 - u2)² | square of the difference | | §8
   | roots_sum_squared + roots_product_fourfold
roots_gap | u3 - u2 | difference of u3 and u2 | | §8 | sqrt(roots_gap_squared)
u3_twice | 2 u3 | sum plus difference | | §8 | roots_sum + roots_gap
u2_twice | 2 u2 | sum minus difference | | §8 | roots_sum - roots_gap
k_squared | k² | square of the modulus | | (4,19) | (u1 - u2)/(u3 - u2) ~ m_k
comodular_angle_deg | arcsin k' | complementary modular angle | angle | (4,21)
   | asin(k_prime) ~ atan2(k_prime, k)
E_amplitude | E(am, k') | incomplete integral, second kind | | (7,1) | ellint_E(amplitude, k_prime)
# Steady precession and elementary theory
stability_factor | λ | stability factor C²r0²/(4Amgs) | | b²/2a | b**2/(2*a)
   | if there is a torque
r0_sleeping | r0 sleeping | least r0 of a stable upright top | rad/time | 2√(Amgs)/C
   | 2*sqrt(A*m*g*s)/C
steady_rate_slow | Ω slow | rate of slow steady precession | rad/time | ϑ'' = 0
   | m*g*s = C*r0*steady_rate_slow - A*cos(theta0)*steady_rate_slow**2 ~ steady_rates[0]
   | if |r0| >= r0_steady_min, and r0 is not 0 at 90 degrees
steady_rate_fast | Ω fast | rate of fast steady precession | rad/time | ϑ'' = 0
   | m*g*s = C*r0*steady_rate_fast - A*cos(theta0)*steady_rate_fast**2 ~ steady_rates[1]
   | if |r0| >= r0_steady_min and the tilt is not 90 degrees
r0_steady_min | r0 steady | least r0 of steady precession | rad/time | 2√(Amgs u0)/C
   | 2*sqrt(A*m*g*s*max(cos(theta0), 0))/C
precession_rate_elementary | ψ' elementary | precession rate of a fast top | rad/time | mgs/(C r0)
   | m*g*s/(C*r0) | if r0 is not 0
T_nutation_elementary | T elementary | nutation period of a fast top | time | 2πA/(C r0)
   | 2*pi*A/(C*abs(r0)) | if r0 is not 0
# where
u0 | | cosine of the tilt at the start | cos | | cos(theta0)
momentum | | beta - b u0 | | (4,7) | psidot0*sin(theta0)**2
m_k | | square of the modulus | | (4,19) | a*height/wide
P | | mean of (β - b)/(1 - u), times K | | (3,8)
   | (momentum_constant - b)*ellint_Pi((u1 - u2)/(1 - u2), k)/(1 - u2) ~ pole_integral(-1)
Q | | mean of (β + b)/(1 + u), times K | | (3,8)
   | (momentum_constant + b)*ellint_Pi((u2 - u1)/(1 + u2), k)/(1 + u2) ~ pole_integral(1)
U | | cos ϑ half a period after the start | cos |
   | u2 + (u1 - cos(theta0))*(u3 - u2)/(u3 - cos(theta0)) ~ u2 + rise*wide/far
V | | cos ϑ between two quarters | cos | (5,2)
   | u3 - sqrt(u3 - u1)*sqrt(u3 - u2) ~ u1 - height*k_prime/(1 + k_prime)
sine_V | | sin ϑ between two quarters | | (5,2)
   | sqrt((above_u1 + height*k_prime/(1 + k_prime))*(below_u2 + height/(1 + k_prime)))
nutation | | angle of the nutation | angle | | theta_max - theta_min
excess | | excess of the mean rate over the elementary rate, in ppm | |
   | 1000000*(mean_precession_rate/precession_rate_elementary - 1)
swing_rate | | rate of the swing on the separatrix | rad/time | | course.rate
lowest | | time at which the axis is lowest | time | | -course.h0/course.rate
"""


def _is_not_0(name: str) -> Callable[[Any, Any], Any]:
    """Return the test of a key whose formula divides by a number."""
    return lambda _, of: of.is_zero(name) ^ True


CONDITIONS: dict[str, Callable[[Any, Any], Any]] = {
    "": lambda x, _: True,
    "if there is a torque": lambda x, _: x.a != 0,
    "if r0 is not 0": lambda x, _: x.spin != 0,
    "if k > 0": lambda x, _: (x.a != 0) & (not x.steady),
    "if the top moves": lambda x, _: x.moves,
    "if the top is released from rest": lambda x, _: x.released,
    "if the start is at u1": lambda x, _: x.turning > 0,
    "if the mean spin rate is not 0": _is_not_0("mean_spin_rate"),
    "if the mean precession rate is not 0": _is_not_0("mean_precession_rate"),
    "if the axis does not leave the vertical at the start": lambda x, _: x.vertical or not x.pole,
    "if the axis is not vertical half a period after the start": lambda x, _: x.half_off_pole,
    "if the top nutates": lambda x, _: x.nutates,
    "if the top nutates, and the axis is not vertical half a period after the start": (
        lambda x, _: x.nutates and x.half_off_pole
    ),
    "if the top nutates and does not pass over a pole": lambda x, _: x.nutates and x.off_poles,
    "if the top nutates after release from rest": lambda x, _: x.nutates and x.released,
    "if |r0| >= r0_steady_min, and r0 is not 0 at 90 degrees": lambda x, _: x.has_steady_rate(SLOW),
    "if |r0| >= r0_steady_min and the tilt is not 90 degrees": lambda x, _: x.has_steady_rate(FAST),
}
"""The condition of a key, as lines and messages name it, and its test by facts and motion.

A test returns a bool for one motion, or an array of them (a mask) for many.
"""


def _read(table: str) -> Iterator[tuple[str, Key]]:
    group = common = ""
    for name, *cells in declared(table):
        if name.startswith("# "):
            group, common = name[2:], "".join(cells)
            continue
        symbol, meaning, unit, equation, formula, only, lacking = [*cells, "", ""][:7]
        printed, _, evaluated = map(str.strip, formula.partition("~"))
        evaluated = evaluated or printed.partition(" where ")[0]
        cosine = "1" if unit == "cos" else ""
        texts = (printed, only or common, evaluated, cosine, lacking)
        yield name, Key(group, symbol, meaning, unit.removeprefix("cos"), equation, *texts)


def _with_definitions(key: Key) -> Key:
    """Return a key whose printed formula defines the names that follow `where`."""
    formula, where, names = key.formula.partition(" where ")
    defined = ", ".join(f"{name} = {_TABLE[name].formula}" for name in names.split(", ") if where)
    return key._replace(formula=f"{formula}{where}{defined}")


def _forms() -> Iterator[tuple[str, Key]]:
    """Yield the forms of inputs; one that is divided by an input exists if that is not 0."""
    for name in (x for x in FORMS if x in DECLARED):
        form, group, only = DECLARED[name], "Inputs in other forms", ""
        formula = form.inverse.replace("u0", "cos(theta0)").replace("s*s", "s**2")
        if divided := re.search(r"/([a-z]\w*)", formula):
            only = f"if {divided[1]} is not 0"
            CONDITIONS.setdefault(only, _is_not_0(divided[1]))
        yield name, Key(group, form.symbol, form.name, form.unit, "", formula, only, formula)


_TABLE = dict(_read(_TEXT)) | dict(_forms())


@cache
def needed(name: str) -> tuple[str, ...]:
    """Return the lines that the evaluated formula of a line names, in order."""
    names = dict.fromkeys(re.findall(r"[A-Za-z_]\w*", LINES[name].evaluated))
    return tuple(x for x in names if x in LINES and x != name)


def lacks(name: str, facts: Any) -> bool:
    """Return whether a motion is of a kind that lacks a number."""
    return any(getattr(facts, kind) for kind in LINES[name].lacking.split())


def exists(name: str, facts: Any, of: Any) -> Any:
    """Return whether a motion has a number: its formula may name only numbers that it has.

    `of.has(name)` returns whether it has another number.
    """
    if lacks(name, facts):
        return False
    found = True
    for other in needed(name):
        found = found & of.has(other)
    return found if found is False else found & CONDITIONS[LINES[name].only](facts, of)


LINES = {bare_name(name): key for name, key in _TABLE.items()}
"""All lines by the names that formulas use."""
NUMBERS = {name: _with_definitions(key) for name, key in _TABLE.items() if key.group != "where"}
"""The declaration of each number by key."""
_FIRST_FURTHER = list(NUMBERS).index("energy_without_spin")
NUMBER_KEYS = list(NUMBERS)[:_FIRST_FURTHER]
"""The numbers of a record, in order; `regime` precedes them, `path` and `remark` follow."""
FURTHER_KEYS = list(NUMBERS)[_FIRST_FURTHER:]
"""The further numbers, in order."""
TEXT_KEYS = ("regime", "path", "remark")
"""The keys of a record whose values are words."""
INPUT_KEYS = {
    f"{name}_deg" if name == TILT else name: Key("Inputs", x.symbol, x.name, x.unit)
    for name, x in DECLARED.items()
    if name in NINE
}
"""The declaration of each input by key, the tilt in degrees."""
KEYS = (
    INPUT_KEYS
    | {"regime": Key("Constants", "", "kind of motion")}
    | {"path": Key("Constants", "", "path of the axis")}
    | {name: NUMBERS[name] for name in NUMBER_KEYS}
    | {"remark": Key("Remark", "", "special properties of the motion, if any")}
)
"""The declaration of each key of a record by name, in the order of the groups of a table."""


def key_of(word: str, units: Units, columns: Iterable[tuple[str, Key]] = ()) -> str:
    """Return the key or column that a symbol stands for, if only one; else the word itself.

    The key of an uncertainty, such as `T_std`, is that of its number with `_std`.
    """
    symbol, std, _ = word.partition("_std")
    known = shown_keys(units, requested=True) | dict(columns)
    named = [name for name, key in known.items() if symbol and key.symbol == symbol]
    return word if symbol in known or len(named) != 1 else named[0] + std


def record_keys(units: Units = DEGREES) -> list[str]:
    """Return all keys of a record in their order."""
    return units.keys([*INPUT_KEYS, "regime", *NUMBER_KEYS, "path", "remark"])


def all_keys(units: Units = DEGREES) -> list[str]:
    """Return the keys of a record and further ones, in their order."""
    return [*record_keys(units), *units.keys(FURTHER_KEYS)]


def shown_keys(units: Units = DEGREES, *, requested: bool = False) -> dict[str, Key]:
    """Return the declaration of each key by name in a record, with its unit as printed."""
    further = {name: NUMBERS[name] for name in FURTHER_KEYS} if requested else {}
    keys = (KEYS | further).items()
    return {units.key(name): key._replace(unit=units.named(key.unit)) for name, key in keys}


CHAIN = {
    step: names.split()
    for step, names in {
        "Inputs": "m A C s g r0 theta0_deg",
        "The body": "a spin_share",
        "The start": "u1 b roots_sum roots_product",
        "The roots": "roots_sum_squared roots_product_fourfold roots_gap_squared roots_gap "
        "u3_twice u2_twice u3 u2",
        "Modulus and amplitude": "k_squared modular_angle_deg comodular_angle_deg amplitude_deg",
        "Integrals": "K E alpha E_amplitude",
        "Nutation": "T_nutation u_quarter",
        "Spin and precession": "mean_spin_rate mean_precession_rate spin_rate_half "
        "precession_rate_half T_spin T_precession",
    }.items()
}
"""Keys by step of section 8, in the order of the paper."""


def derivation_keys(units: Units = DEGREES) -> dict[str, Key]:
    """Return the keys of the steps of section 8, in the order of the paper, grouped by step."""
    keys = shown_keys(units, requested=True)
    steps = {units.key(x): step for step, names in CHAIN.items() for x in names}
    return {name: keys[name]._replace(group=step) for name, step in steps.items()}
