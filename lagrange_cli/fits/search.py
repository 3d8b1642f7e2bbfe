"""A search: its conditions such as `T_precession=2`, its unknown inputs, and a scan over these."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import eq, ge, gt, le, lt
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arithmetic.text import double_text, quoted, shortened
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.given import Given, gather
from ..inputs.input_keys import overridden
from ..inputs.names import check_names
from ..inputs.ranges import Product, Span, parse_span
from ..inputs.top import Top
from ..inputs.value import Value, exact_number, parse_value, split_unit, value_of, values_of
from ..motion.quantity import unit_name
from ..motion.record import all_keys, shown_keys
from ..motion.regime import Regime
from ..motion.solve import solve
from ..output.terminal import Progress
from ..sweeps.plan import shared_inputs
from ..sweeps.records import BLOCK_ROWS, sweep

if TYPE_CHECKING:
    from ..inputs.units import System

COUNTS = {1: 1000, 2: 60, 3: 20}
"""Number of values of each unknown in a scan, by the number of unknowns."""
MOST_TOPS = 10_000_000
_WORDS = {"regime": [regime.value for regime in Regime], "path": ["cusped", "looping", "wavy"]}
"""Keys that hold a word, and the words."""
_RELATIONS: Mapping[str, Callable[[Any, Any], bool]]
_RELATIONS = {"=": eq, "<": lt, "<=": le, ">": gt, ">=": ge}


class Condition(NamedTuple):
    """A condition on the record of a top: a word, a target value or a bound."""

    key: str
    relation: str
    value: float | str

    def holds(self, record: Mapping[str, Any]) -> bool:
        """Return whether a record meets the condition; a missing number does not."""
        found = record[self.key]
        return found is not None and _RELATIONS[self.relation](found, self.value)

    def __str__(self) -> str:
        value = self.value if isinstance(self.value, str) else f"{self.value:g}"
        return f"{self.key}{self.relation}{value}"


def targets_of(conditions: Iterable[Condition]) -> dict[str, float]:
    """Return the target values by key."""
    given = {x.key: x.value for x in conditions if x.relation == "="}
    return {key: x for key, x in given.items() if not isinstance(x, str)}


def read_conditions(
    texts: Iterable[str], *, radians: bool = False, system: System | None = None
) -> list[Condition]:
    """Parse conditions `KEY=VALUE` and `KEY<VALUE`; the key of an angle may omit its unit.

    Values with units are converted to a system.  Raises LagtopError for an unknown key, and for an
    impossible value.
    """
    found: list[Condition] = []
    known = all_keys(radians=radians)
    for text in texts:
        match = re.fullmatch(r"\s*(\w+)\s*(<=|>=|<|>|=)\s*(.+?)\s*", text)
        if not match:
            raise LagtopError(f"a condition must be KEY=VALUE or KEY<VALUE, got {quoted(text)}")
        name, relation, value = match.groups()
        key = unit_name(f"{name}_deg", radians=radians)
        if key not in known:
            (key,) = check_names("a condition", [name], known)
        if any(x.key == key and x.relation == "=" for x in found):
            raise LagtopError(f"a condition must name each key once, got {key} twice")
        if key in _WORDS and (relation != "=" or value not in _WORDS[key]):
            wanted, got = ", ".join(_WORDS[key]), f"{relation}{shortened(value)}"
            raise LagtopError(f"{key}= must be one of {wanted}, got {got}")
        number = value if key in _WORDS else _number(key, value, radians, system)
        found.append(Condition(key, relation, number))
    return found


def _number(key: str, text: str, radians: bool, system: System | None) -> float:
    try:
        value = parse_value(text)
    except LagtopError as error:
        raise LagtopError(f"the value of {key} {error}") from None
    if not value.unit:
        return float(value.number)
    from ..inputs.units import CGS, factor_of  # few searches have units

    unit = shown_keys(radians=radians, requested=True)[key].unit
    return float(value.number * factor_of(key, value, unit, system or CGS))


def system_asked(conditions: Iterable[str]) -> str | None:
    """Return `si` if a condition has a unit other than that of an angle, else None."""
    units = {split_unit(re.split("[<>=]+", text)[-1])[1] for text in conditions} - {""}
    if not units:
        return None
    from ..inputs.units import UNITS  # few searches have units

    angles = {x for x, unit in UNITS.items() if not any(unit.dimensions)}
    return "si" if units - angles - {"degree", "radian"} else None


def condition_texts(conditions: Mapping[str, float | str] | Sequence[str]) -> Sequence[str]:
    """Return conditions as texts KEY=VALUE.  Raises LagtopError for a value of another type."""
    if not isinstance(conditions, Mapping):
        return conditions
    texts = []
    for key, given in conditions.items():
        if isinstance(given, str):
            texts.append(f"{key}={given}")
        else:
            value = value_of(key, given)
            texts.append(f"{key}={float(exact_number(key, value.number))!r} {value.unit}")
    return texts


def read_unknown(name: str, given: Any) -> Value:
    """Return a number, or a range as exact fractions; a unit is kept."""
    value = value_of(name, given, parse_span)
    pair = value.number
    if isinstance(pair, Span) or not isinstance(pair, tuple | list | np.ndarray):
        return value
    if (isinstance(pair, np.ndarray) and pair.ndim != 1) or len(pair) != 2:
        raise LagtopError(f"{name} must be a real number or a pair, got {quoted(given)}", name)
    first, last = (exact_number(name, x) for x in pair)
    if not first < last:
        raise LagtopError(f"{name} must have its smaller end first, got {quoted(given)}", name)
    return value.replace(number=Span(first, last))


class Search(NamedTuple):
    """Unknown inputs, known inputs, and the conditions."""

    fixed: Mapping[str, float]
    spans: Mapping[str, Span]
    conditions: Sequence[Condition]
    radians: bool = False

    @property
    def keys(self) -> list[str]:
        """The keys that have a target value."""
        return list(targets_of(self.conditions))

    @property
    def targets(self) -> Array:
        """The target values of the conditions."""
        return np.array(list(targets_of(self.conditions).values()))

    def broken_by(self, record: Mapping[str, Any]) -> Condition | None:
        """Return the first word or bound that a record does not meet, or None."""
        others = (x for x in self.conditions if x.key not in self.keys or x.relation != "=")
        return next((x for x in others if not x.holds(record)), None)

    def target_text(self) -> str:
        """Return the conditions on numbers as text."""
        numbers = targets_of(self.conditions).items()
        return ", ".join(f"{key}={double_text(x).removesuffix('.0')}" for key, x in numbers)

    @property
    def ends(self) -> Array:
        """The first and the last value of each unknown, as two rows."""
        spans = self.spans.values()
        return np.array([[float(x.first) for x in spans], [float(x.last) for x in spans]])

    def inputs(self, values: Sequence[Any]) -> dict[str, Any]:
        """Return the inputs of `Top` with these values of the unknowns."""
        return overridden(dict(self.fixed), dict(zip(self.spans, values, strict=True)))

    def top(self, values: Sequence[float]) -> Top:
        """Return the top with these values of the unknowns.  Raises LagtopError."""
        return Top(**{key: float(value) for key, value in self.inputs(values).items()})

    def numbers(self, values: Sequence[float]) -> Array:
        """Return the numbers that have a target value, correctly rounded; NaN if a key has none."""
        try:
            motion = solve(self.top(values))
            record = motion.record(radians=self.radians, keys=self.keys)
        except LagtopError:
            return np.full(len(self.keys), np.nan)
        found = (record[key] for key in self.keys)
        return np.array([np.nan if x is None else x for x in found])

    def swept(self, values: Array) -> Array:
        """Return the numbers that have a target value by `sweep`, a row for each row of values."""
        found = sweep(keys=self.keys, radians=self.radians, **self.inputs(list(values.T)))
        return np.stack([np.asarray(found[key], dtype=np.float64) for key in self.keys], axis=-1)


def search_of(
    inputs: Mapping[str, Any],
    conditions: Sequence[str],
    *,
    scene: str | None = None,
    radians: bool = False,
) -> tuple[Search, Given]:
    """Return a search, and the given inputs of the top, from options and from a scene file.

    An input is a number or a `Span`, or a `Value` of one of these.  Raises LagtopError for
    bad options, and for conditions that cannot have isolated solutions.
    """
    given = gather(values_of(inputs), scene, system=system_asked(conditions))
    wanted = read_conditions(conditions, radians=radians, system=given.system)
    spans = {name: x for name, x in given.inputs.items() if isinstance(x, Span)}
    known = {name: x for name, x in given.inputs.items() if name not in spans}
    shared = shared_inputs(given.replace(inputs=known), varying=spans)
    fixed = {name: x for name, x in shared.items() if name not in spans}
    unknown, numbers = len(spans), len(targets_of(wanted))
    if not 1 <= unknown <= max(COUNTS):
        raise LagtopError(
            f"find needs 1 to {max(COUNTS)} unknown inputs, each a range from:to such as "
            f"10:200, got {unknown}"
        )
    if numbers != unknown:
        raise LagtopError(
            f"find needs as many conditions KEY=NUMBER as unknown inputs, got {numbers} for "
            f"{unknown}: {', '.join(spans)}"
        )
    return Search(fixed, spans, wanted, radians), given


class Scan(NamedTuple):
    """Tops on a grid of the unknowns."""

    search: Search
    shape: tuple[int, ...]
    values: Array
    """The unknowns of each top, shape (tops, unknowns); the last unknown varies fastest."""
    numbers: Array
    """The numbers that have a target value, in the same shape; NaN if a key has none."""

    @property
    def sizes(self) -> Array:
        """The scale of each number: its standard deviation, or else the size of its target."""
        spread = np.nanstd(np.where(np.isfinite(self.numbers), self.numbers, np.nan), axis=0)
        return np.where(spread > 0, spread, np.maximum(np.abs(self.search.targets), 1e-300))


def scan_of(search: Search, count: int | None, progress: Progress) -> Scan:
    """Compute the tops on a grid with `count` values of each unknown.

    Raises LagtopError if the count is too small, or the grid too large.
    """
    each = COUNTS[len(search.spans)] if count is None else count
    if each < 3 or each ** len(search.spans) > MOST_TOPS:
        raise LagtopError(
            f"scan must be 3 or more values of each unknown, and at most 1e7 tops, got {each}",
            "scan",
        )
    grid = Product({name: span.points(each) for name, span in search.spans.items()})
    values, numbers = [], []
    for block in progress([*grid.blocks(BLOCK_ROWS)], "tops", size=lambda block: block.size):
        at = np.stack(list(block.values().values())[::-1], axis=-1)
        values.append(at)
        numbers.append(search.swept(at))
    shape = (each,) * len(search.spans)
    return Scan(search, shape, np.concatenate(values), np.concatenate(numbers))
