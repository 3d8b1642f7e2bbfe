"""The page: its letters, its sizes and colours, and its files with their text and metadata."""

from __future__ import annotations

import io
import re
import shlex
from collections.abc import Sequence
from itertools import groupby, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from colour_vision import VISIONS, seen
from conftest import Lagtop
from hypothesis import given
from hypothesis import strategies as st
from lagtop import LagtopError, Regime, Top, solve
from matplotlib.figure import Figure
from pictures import NUTATING, REGIMES, drawn, regime_motion, sample_motion

from lagrange_cli.arithmetic.types import Array
from lagrange_cli.errors import NothingToDrawError
from lagrange_cli.inputs.value import Stds
from lagrange_cli.motion.uncertainty import AngleStds, FirstOrder
from lagrange_cli.plot.curves import tilt_period
from lagrange_cli.plot.kinds import KINDS, ON_THE_SHEET, PlotRequest
from lagrange_cli.plot.map import parse_input_range
from lagrange_cli.plot.page import (
    LEAST_LETTERS,
    MOST_PIXELS,
    Page,
    draw_page,
    page_bytes,
)
from lagrange_cli.plot.style import DARK, LIGHT, POINTS, Look, styled

X, Y = parse_input_range("x", "r0=20:100:4"), parse_input_range("y", "theta0=10:90:3")


def png(page: Page, dpi: float) -> Array:
    """Return the pixels of a page, shape (height, width, 3)."""
    from PIL import Image

    with Image.open(io.BytesIO(page_bytes(page, "png", dpi))) as picture:
        return np.asarray(picture.convert("RGB"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("path", "look"),
    [
        *((path, LIGHT) for path in NUTATING[1::4]),
        (NUTATING[0], DARK),
    ],
)
def test_every_kind_has_ink(path: Path, look: Look) -> None:
    """A smoke test: warnings are errors, those of missing glyphs and of failed layouts too.

    Each of the six panels has ink on paper.
    """
    radians = look is DARK
    y = parse_input_range("y", "theta0=0.2:1.5:3") if radians else Y
    page = Page(sample_motion(path), list(KINDS), PlotRequest(x=X, y=y, radians=radians, look=look))
    pixels = png(page, 40)
    width, height = page.inches()
    assert pixels.shape == (round(height * 40), round(width * 40), 3)
    paper = np.array([int(look.paper[i : i + 2], 16) for i in (1, 3, 5)])
    inked = (np.abs(pixels.astype(int) - paper) > 40).any(axis=2)
    for row in np.array_split(inked, 2):
        for panel in np.array_split(row[:, round(3.7 * 40) :], 3, axis=1):
            assert 0.02 < panel.mean() < 0.9


@pytest.mark.slow
@pytest.mark.parametrize("name", REGIMES)
def test_every_regime(name: str) -> None:
    """A smoke test: no kind of motion gives a warning on any picture."""
    scene = regime_motion(name)
    assert name == scene.regime.value or name not in {regime.value for regime in Regime}
    page = Page(scene, ["sphere", "angles", "remainders", "cubic", "phase"])
    assert png(page, 40).min() < 64


@pytest.mark.parametrize("name", ["regular", "sleeping"])
def test_a_picture_that_is_missing_says_why(name: str) -> None:
    """On a page of several it is a text in its panel; alone it is an error."""
    scene = regime_motion(name) if name in REGIMES else solve(Top())
    panel = drawn(scene, ["cubic", "remainders"]).subfigs[1].subfigs[1]
    texts = [text.get_text() for text in panel.texts if "remainders" in text.get_text()]
    missing = tilt_period(scene) is None
    assert texts == ["no remainders: the tilt is constant (sleeping)"] * missing
    if missing:
        with pytest.raises(NothingToDrawError, match=re.escape(texts[0])):
            drawn(scene, ["remainders"])


@pytest.mark.parametrize("size", [None, (2.0, 2.0), (3.5, 3.0)])
@pytest.mark.parametrize(
    "kinds", [ON_THE_SHEET, ("angles",), ("angles", "cubic"), ("map",)], ids=",".join
)
def test_no_title_is_cut_off(
    kinds: Sequence[str], size: tuple[float, float] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At any size, and with the longest titles: those of uncertain inputs."""
    figures: list[Figure] = []

    def keep(figure: Figure, *_: Any) -> bytes:
        figures.append(figure)
        return b""

    monkeypatch.setattr("lagrange_cli.plot.page.figure_bytes", keep)
    motion = solve(Top())
    stds = AngleStds(motion, Stds({"theta0_deg": 1.0}), ["theta0_deg"])
    request = PlotRequest(x=X, y=Y, stds=stds, key="precession_rate_start")
    page_bytes(Page(motion, kinds, request, size), "png", 150)
    (figure,) = figures
    panels = figure.subfigs if len(kinds) == 1 else figure.subfigs[1].subfigs
    for panel in panels:
        (title,) = (text for text in panel.texts if text.get_text() == panel.get_suptitle())
        assert title.get_window_extent().x1 <= panel.bbox.x1, title.get_text()


@pytest.mark.parametrize("uncertain", [False, True])
def test_numbers_stand_beside_pictures_with_their_uncertainties(uncertain: bool) -> None:
    motion = solve(Top())
    stds = FirstOrder(motion, Stds({"theta0_deg": 1.0}), ["theta0_deg"])
    request = PlotRequest(uncertain=stds if uncertain else None)
    figure = drawn(motion, ["cubic", "phase"], request)
    texts = {text.get_text() for text in figure.subfigs[0].texts}
    if uncertain:
        assert {"30.0(1.0) deg", "73.9(8) deg", "50 rad/time", "0.429(8) time"} <= texts
    else:
        names = {"T_nutation", "mean_precession_rate", "cusped"}
        assert names | {"0.4292501 time", "7.991055 rad/time"} <= texts


# Sizes.


KIND_LISTS = [*([kind] for kind in KINDS), ON_THE_SHEET, ("cubic", "phase"), tuple(KINDS)]


@given(
    kinds=st.sampled_from(KIND_LISTS),
    size=st.none() | st.tuples(st.floats(2, 50), st.floats(2, 50)),
    dpi=st.floats(20, 1000),
)
def test_each_page_is_drawable_or_refused(
    kinds: Sequence[str], size: tuple[float, float] | None, dpi: float
) -> None:
    """What passes has letters of a pixel and not too many pixels; a refusal names what passes."""
    page = Page(solve(Top()), kinds, PlotRequest(), size)
    width, height = page.inches()
    try:
        page.check_dpi(dpi, "png")
    except LagtopError as error:
        bounds = re.search(r"dpi must be in \[(\d+), (\d+)\]", str(error))
        assert bounds
        for bound in bounds.groups():
            page.check_dpi(float(bound), "png")
        return
    assert POINTS * page.lettering() * dpi / 72 >= LEAST_LETTERS
    assert width * height * dpi**2 <= MOST_PIXELS * (1 + 1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("kinds", KIND_LISTS, ids=",".join)
def test_pictures_at_the_corners_of_the_range_of_sizes(kinds: Sequence[str]) -> None:
    """At the fewest pixels per inch allowed, FreeType draws every letter; a step below is refused.

    The fullest page is drawn as SVG and PDF too.
    """
    scene = solve(Top(r0=101.0, theta0_deg=0.5))
    corners = [(2.0, 2.0), (2.0, 50.0), (50.0, 2.0)]
    for size in corners[: 3 if len(kinds) == len(KINDS) else 1]:  # its panels have least room
        page = Page(scene, kinds, PlotRequest(x=X, y=Y), size)
        least = max(20.0, 72 * LEAST_LETTERS / (POINTS * page.lettering()))
        shape = png(page, least * (1 + 1e-12)).shape[:2]
        assert shape == pytest.approx((size[1] * least, size[0] * least), abs=1)
        with pytest.raises(LagtopError, match=r"^dpi must be in \[\d+, \d+\] for \d+ x \d+ inches"):
            page_bytes(page, "png", least - 1)
        if size == (2.0, 2.0) and len(kinds) == len(KINDS):
            assert page_bytes(page, "svg", 20.0).startswith(b"<?xml")
            assert page_bytes(page, "pdf", 20.0).startswith(b"%PDF")


# Files.


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fmt", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
@pytest.mark.parametrize(
    "kinds", [["cubic"], pytest.param(["sphere", "cubic"], marks=pytest.mark.slow)], ids=",".join
)
def test_files_are_the_same_every_time(kinds: list[str], fmt: str, start: bytes) -> None:
    page = Page(solve(Top()), kinds)
    first, second = (page_bytes(page, fmt, 50) for _ in range(2))
    assert first == second
    assert first.startswith(start)
    assert not re.search(rb"20\d\d-\d\d|CreationDate|matplotlib v", first)


@pytest.mark.slow
def test_letters_shrink_with_the_page_and_fit_it() -> None:
    page = Page(solve(Top()), ["sphere", "phase"], PlotRequest(), (7.65, 2.5))
    assert page.lettering() == pytest.approx(0.5)
    with styled(LIGHT, page.lettering()):
        figure = Figure(figsize=page.inches(), layout="constrained")
        draw_page(figure, page)
        figure.savefig(io.BytesIO(), format="png")
        texts = [text for text in figure.subfigs[0].texts[1:] if text.get_text()]
        lines = [list(line) for _, line in groupby(texts, lambda text: text.get_position()[1])]
        boxes = [[text.get_window_extent() for text in line] for line in lines]
    assert len(lines) == 37
    assert all(left.x1 < right.x0 for line in boxes for left, right in pairwise(line))
    assert all(upper[0].y0 > lower[0].y0 for upper, lower in pairwise(boxes))


def test_axis_numbers_share_a_power_of_ten() -> None:
    """Numbers without a factor are plain texts, which cost a third of those through mathtext."""
    factor, plain = (
        page_bytes(Page(solve(Top(r0=r0)), ["cubic"]), "svg", 100).decode() for r0 in (1e4, 50)
    )
    assert r"<!-- $\times\mathdefault{10^{−4}}\mathdefault{}$ -->" in factor
    assert "mathdefault" not in plain


FILE_PARTS = {
    "svg": [
        *(">upright</text>", "<title>Lagrange top: cubic</title>", "'DejaVu Sans', 'Verdana'"),
        *("<desc>Lagrange top, cusped path", "r0 = 30.0", "lagtop plot cubic --m 1587.0"),
    ],
    "pdf": ["/Title (Lagrange top: cubic)", "r0 = 30.0", "--r0 30.0", "/Subtype /CIDFontType2"],
}


@pytest.mark.parametrize("fmt", ["svg", "pdf", "png"])
def test_files_have_title_scene_and_command_and_text_is_text(fmt: str) -> None:
    """PDF embeds TrueType fonts."""
    from PIL import Image

    data = page_bytes(Page(solve(Top(r0=30)), ["cubic"]), fmt, 50)
    assert [x for x in FILE_PARTS.get(fmt, []) if x.encode() not in data] == []
    assert b"/Type3" not in data
    if fmt == "png":
        with Image.open(io.BytesIO(data)) as picture:
            info: dict[Any, Any] = picture.info
        assert info["Title"] == "Lagrange top: cubic"
        assert "r0 = 30.0" in info["Description"]
        assert info["Comment"].startswith("lagtop plot cubic --m 1587.0")


@pytest.mark.slow
def test_the_command_in_a_file_draws_the_same_file(lagtop: Lagtop) -> None:
    """With every option that a picture has."""
    request = PlotRequest(
        t_max=0.75,
        radians=True,
        key="theta_max_rad",
        x=parse_input_range("x", "r0=log:10:90:3"),
        y=parse_input_range("y", "theta0=0.25:1.5:3"),
        camera=(0.5, -0.25),
        colour_limits=(0.5, 2.5),
        look=DARK,
    )
    motion = solve(Top(theta0_rad=0.625, psidot0=-0.5))
    page = Page(motion, ["sphere", "map"], request, (7.0, 5.0))
    words = shlex.split(page.about().command)
    assert words[:2] == ["lagtop", "plot"]
    result = lagtop(*words[1:-2], "--format", "svg", "-o", "-")
    assert result.exit_code == 0
    assert result.stdout_bytes == page_bytes(page, "svg", 150.0)


def test_the_command_in_a_file_has_no_option_that_its_pictures_lack() -> None:
    """Such options may belong to the film of the same command; `plot` refuses them alone."""
    request = PlotRequest(t_max=1.0, camera=(0.5, 0.25), key="nome", x=X)
    words = {kind: Page(solve(Top()), [kind], request).about().command for kind in KINDS}
    for option, kinds in (
        ("--t-max", ["sphere", "angles", "remainders"]),
        ("--camera", ["sphere"]),
        ("--key", ["map"]),
        ("--x", ["map"]),
    ):
        assert [kind for kind in KINDS if f" {option} " in words[kind]] == kinds


# Colours.


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("look", [LIGHT, DARK], ids=["light", "dark"])
def test_the_colours_differ_for_everybody(look: Look, vision: str) -> None:
    shown = [seen(colour, VISIONS[vision]) for colour in (*look.lines, look.paper)]
    distances = [float(np.linalg.norm(p - q)) for i, p in enumerate(shown) for q in shown[i + 1 :]]
    assert min(distances) > 15
