"""Every picture and the page, side by side in one HTML file, to be looked at; no test.

    python tests/tools/contact_sheet.py sheet.html
    python tests/tools/contact_sheet.py few.html --scenes looping-top --kinds angles map

Each kind is drawn for every shipped scene, on light and on dark paper, in three sizes; the page is
shown as a laptop, a tablet and a phone show it.
"""

from __future__ import annotations

import argparse
import base64
import sys
import tempfile
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path += [str(ROOT), str(ROOT / "tests")]

from browsers import chromium  # noqa: E402
from lagtop import view  # noqa: E402
from pictures import sample_motion  # noqa: E402
from scenes import SAMPLES  # noqa: E402

from lagrange_cli.errors import NothingToDrawError  # noqa: E402
from lagrange_cli.plot.kinds import KINDS, ON_THE_SHEET, SHEET, PlotRequest  # noqa: E402
from lagrange_cli.plot.page import Page, page_bytes  # noqa: E402
from lagrange_cli.plot.style import DARK, LIGHT  # noqa: E402

SIZES = {"usual": None, "a journal column": (3.5, 3.0), "wide": (10.0, 4.0)}
"""Width and height in inches."""
SCREENS = {"laptop": (1280, 800), "tablet": (820, 1180), "phone": (390, 844)}
"""Width and height in pixels."""
STYLE = "body{font:14px sans-serif} figure{display:inline-block;margin:4px;vertical-align:top}"


def figure_of(png: bytes, caption: str) -> str:
    """Return a picture with its caption, as HTML."""
    source = base64.b64encode(png).decode()
    picture = f'<img src="data:image/png;base64,{source}" alt="{escape(caption)}">'
    return f"<figure><figcaption>{escape(caption)}</figcaption>{picture}</figure>"


def pictures(scenes: Sequence[Path], kinds: Sequence[str], dpi: float) -> Iterator[str]:
    """Yield the pictures of each scene, or why there is none, as HTML."""
    for scene in scenes:
        motion = sample_motion(scene)
        yield f"<h2>{scene.stem}</h2>"
        for kind in kinds:
            chosen = ON_THE_SHEET if kind == SHEET else (kind,)
            for name, size in SIZES.items():
                for look, paper in ((LIGHT, "light"), (DARK, "dark")):
                    caption = f"{scene.stem}, {kind}, {name}, {paper}"
                    try:
                        png = page_bytes(
                            Page(motion, chosen, PlotRequest(look=look), size), "png", dpi
                        )
                    except NothingToDrawError as reason:
                        yield f"<p>{escape(caption)}: {escape(str(reason))}</p>"
                    else:
                        yield figure_of(png, caption)


def pages(scenes: Sequence[Path]) -> Iterator[str]:
    """Yield the page of each scene on each screen, as HTML."""
    with chromium() as browser, tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            yield f"<h2>{scene.stem}, the page</h2>"
            path = Path(folder) / "top.html"
            view(sample_motion(scene)).save(path)
            for name, (width, height) in SCREENS.items():
                for dark in (False, True):
                    browser.open(path, "#t=0.1", width=width, height=height, dark=dark)
                    caption = f"{scene.stem}, {name}, {'dark' if dark else 'light'}"
                    yield figure_of(browser.picture(), caption)


def main() -> None:
    """Write the sheet."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--scenes", nargs="*", help="names of shipped scenes; by default all")
    parser.add_argument("--kinds", nargs="*", default=[*KINDS, SHEET], choices=[*KINDS, SHEET])
    parser.add_argument("--dpi", type=float, default=75)
    parser.add_argument("--no-page", action="store_true", help="leave out the page")
    asked = parser.parse_args()
    scenes = [path for path in SAMPLES if not asked.scenes or path.stem in asked.scenes]
    with asked.output.open("w", encoding="utf-8") as sheet:
        sheet.write(
            f'<!DOCTYPE html><meta charset="utf-8"><title>lagtop</title><style>{STYLE}</style>'
        )
        for part in pictures(scenes, asked.kinds, asked.dpi):
            sheet.write(part)
        for part in () if asked.no_page else pages(scenes):
            sheet.write(part)


if __name__ == "__main__":
    main()
