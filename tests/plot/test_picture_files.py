"""What the files of pictures carry: text, fonts, metadata, and the command that draws them."""

from __future__ import annotations

import io
import re
import shlex
from typing import Any

import pytest
from conftest import Lagtop

from lagrange_cli import Motion, Top, solve
from lagrange_cli.plot.kinds import PlotRequest
from lagrange_cli.plot.map import parse_input_range
from lagrange_cli.plot.page import Page, page_bytes
from lagrange_cli.plot.style import DARK, LIGHT


def file_of(fmt: str, motion: Motion | None = None) -> bytes:
    """Return the picture of a cubic."""
    page = Page(motion or solve(Top(r0=30)), ["cubic"], PlotRequest(), LIGHT)
    return page_bytes(page, fmt, 50)


def test_text_is_text_in_svg_and_its_title_and_scene_can_be_read() -> None:
    text = file_of("svg").decode()
    assert ">upright</text>" in text
    assert "<title>Lagrange top: cubic</title>" in text
    scene = re.search("<desc>(.*)</desc>", text)
    assert scene
    assert "cusped path" in scene[1]
    assert "r0 = 30.0" in scene[1]
    assert "lagtop plot cubic --m 1587.0" in text
    assert "'DejaVu Sans', 'Verdana'" in text


def test_pdf_embeds_truetype_fonts_and_knows_its_scene() -> None:
    data = file_of("pdf")
    assert b"/Type3" not in data
    assert b"/Subtype /CIDFontType2" in data or b"/Subtype /TrueType" in data
    for part in (b"/Title (Lagrange top: cubic)", b"r0 = 30.0", b"--r0 30.0"):
        assert part in data


def test_png_carries_its_scene_and_its_command() -> None:
    from PIL import Image

    with Image.open(io.BytesIO(file_of("png"))) as picture:
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
        limits=(0.5, 2.5),
        numbers=False,
    )
    motion = solve(Top(theta0_rad=0.625, psidot0=-0.5))
    page = Page(motion, ["sphere", "map"], request, DARK, (7.0, 5.0))
    words = shlex.split(page.command())
    assert words[:2] == ["lagtop", "plot"]
    result = lagtop(*words[1:-2], "--format", "svg", "-o", "-")
    assert result.exit_code == 0
    assert result.stdout_bytes == page_bytes(page, "svg", 150.0)
