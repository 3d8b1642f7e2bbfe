"""The command `lagtop find`: inputs for wanted numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from ..errors import LagtopError
from .command import ExamplesFirst, complain, write_keys
from .options import COUNT, KEY_NAMES, exclude, output_options
from .progress import with_progress
from .top_options import by_key, input_options, is_scene, say_missing, say_unused, value_type

if TYPE_CHECKING:
    from ..inputs.units import System
    from ..motion.solve import Motion


@click.command(
    "find",
    cls=ExamplesFirst,
    shows=write_keys,
    examples="""
        lagtop find --r0 10:200 T_precession=2
        lagtop find --r0 10:200 --theta0 5:150 T_precession=0.8 T_nutation=0.43
        lagtop find --psidot0 -20:20 mean_precession_rate=6 path=looping 'theta_max_deg<120'
        lagtop find sample_inputs/hanging-top.toml --r0 log:1:40 T_nutation=0.25 --scan 1e4
        lagtop find --from theta_min=30 theta_max=60 T_nutation=0.4 mean_precession_rate=5
    """,
)
@click.argument("words", nargs=-1, metavar="[SCENE.toml|-] CONDITION...")
@input_options(value_type("number or from:to", "parse_number_or_span"), units=False)
@click.option(
    "--scan",
    type=COUNT,
    metavar="N",
    help="Values of each unknown in the scan.  [default: 1000, 60 or 20 of 1, 2 or 3 unknowns]",
)
@click.option(
    "--from",
    "seen",
    is_flag=True,
    help="The conditions are theta_min, theta_max, T_nutation and mean_precession_rate, and may be "
    "mean_spin_rate: they tell a and b in closed form.",
)
@click.option("--keys", type=KEY_NAMES, help="Print only these keys, with commas between.")
@output_options("csv", "ndjson", "json")
def command(
    words: tuple[str, ...],
    rad: bool,
    scan: int | None,
    seen: bool,
    keys: list[str] | None,
    fmt: str,
    output: str,
    **options: Any,
) -> None:
    """Tops whose records have wanted numbers.

    An input that is a range from:to (or log:from:to) is unknown, up to three of them; a unit stands
    once, at the end: --r0 '400:600 rpm'.  There are as many conditions KEY=NUMBER, which with units
    are in SI.  regime=WORD, path=WORD and bounds such as KEY<NUMBER leave out what does not keep
    them; an angle may leave out its unit.

    With one unknown all solutions are found that the scan brackets: each is the double whose number
    comes nearest to the wanted one, but where that number hardly changes, others do as well.  With
    several, those are found to which its best points lead.  The exit code is 1 where there is none.

    With --from inputs of the body, and a scene, may be given too; what these numbers cannot tell of
    it is 1, or such that C = A.  The tops start at their least tilt.
    """
    from ..inputs.names import check_names
    from ..motion.record import all_keys, record_keys

    exclude({"--from": seen or None, "--scan": scan})
    chosen = record_keys(radians=rad)
    if keys is not None:
        chosen = check_names("keys", keys, all_keys(radians=rad))
    scenes = [word for word in words if is_scene(word)]
    conditions = [word for word in words if word not in scenes]
    if len(scenes) > 1:
        raise LagtopError(f"find takes one scene, got {' '.join(scenes)}")
    inputs = by_key(options, radians=rad)
    if seen:
        motions, system = _inverted(scenes, conditions, inputs, rad)
    else:
        motions, system = _found(scenes, conditions, inputs, scan, rad)
    _write(motions, system, chosen, rad, fmt, output)


def _found(
    scenes: list[str],
    conditions: list[str],
    inputs: dict[str, Any],
    count: int | None,
    radians: bool,
) -> tuple[list[Motion], System | None]:
    from ..fits.find import find_tops
    from ..fits.search import search_of

    scene = scenes[0] if scenes else None
    search, given = search_of(inputs, conditions, scene=scene, radians=radians)
    found = find_tops(search, count, with_progress)
    say_missing(given)
    say_unused(given.stds)
    complain(f"{len(found.motions)} found; {found.looked}")
    return found.motions, given.system


def _inverted(
    scenes: list[str], conditions: list[str], inputs: dict[str, Any], radians: bool
) -> tuple[list[Motion], System | None]:
    from ..fits.implied_body import BODY_INPUTS
    from ..fits.invert import invert
    from ..inputs.given import gather
    from ..inputs.ranges import Span

    for name, x in inputs.items():
        if name not in BODY_INPUTS or isinstance(x.number, Span):
            option = name.removesuffix("_deg").removesuffix("_rad").replace("_", "-")
            raise LagtopError(
                f"--from goes with numbers for {' '.join(BODY_INPUTS)}, got --{option}"
            )
    found = gather(inputs, scenes[0] if scenes else None)
    given = {name: float(x) for name, x in found.inputs.items() if name in BODY_INPUTS}
    say_unused(name for name in found.stds if name in given)
    return invert(conditions, radians=radians, known=given), found.system


def _write(
    motions: list[Motion],
    system: System | None,
    keys: list[str],
    radians: bool,
    fmt: str,
    output: str,
) -> None:
    """Write the records as `lagtop sweep` does, a row for each motion."""
    from ..motion.solve import record_in_range
    from ..output.write import block_text, write_text_blocks

    records = [record_in_range(motion, radians=radians, keys=keys)[0] for motion in motions]
    if system is not None:
        for record in records:
            if record.get("remark"):
                record["remark"] = system.in_words(record["remark"])
    columns = [[record[key] for record in records] for key in keys]
    write_text_blocks(fmt, keys, [block_text(columns, keys, fmt)], output)
