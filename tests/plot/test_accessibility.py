"""The page without a mouse, without motion, enlarged, and under a strict content policy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from browsers import Browser
from scenes import SAMPLES

pytestmark = pytest.mark.slow

TAB, ENTER, RIGHT, DOWN = "\ue004", "\ue007", "\ue014", "\ue015"
NAME = "(part) => part.id || part.dataset.shows || part.title || part.tagName"
SHOWN = "(part) => part.tabIndex >= 0 && part.getClientRects().length"
CONTROLS = f"[...document.querySelectorAll('input, select, button, [tabindex]')].filter({SHOWN})"


def tab_stops(browser: Browser) -> list[dict[str, Any]]:
    """Return name, place and outline of each element that Tab reaches, until it leaves the page."""
    stops: list[dict[str, Any]] = []
    while len(stops) < 200:
        browser.driver.switch_to.active_element.send_keys(TAB)
        stop = browser.ask(
            f"""const part = document.activeElement;
            const {{ x, y, width, height }} = part.getBoundingClientRect();
            const {{ outlineStyle, outlineWidth }} = getComputedStyle(part);
            const seen = x + width > 0 && y + height > 0 && x < innerWidth && y < innerHeight;
            return part === document.body ? null : {{
                name: ({NAME})(part), top: y + scrollY, seen,
                within: part.closest("section")?.className,
                outline: outlineStyle === "none" ? 0 : parseFloat(outlineWidth) }}"""
        )
        if stop is None:
            break
        stops.append(stop)
    return stops


@pytest.mark.parametrize("width", [1280, 390])
def test_tab_reaches_every_control_in_order(browser: Browser, page_file: Path, width: int) -> None:
    """The order is that of the text, on a phone from top to bottom; each stop is outlined."""
    browser.open(page_file, width=width)
    stops = tab_stops(browser)
    assert [stop["name"] for stop in stops] == browser.ask(f"return {CONTROLS}.map({NAME})")
    assert [stop["name"] for stop in stops if stop["outline"] < 2 or not stop["seen"]] == []
    regions = list(dict.fromkeys(stop["within"] for stop in stops))
    assert regions == [None, "space", "inputs", "course", "record"]
    if width == 390:
        tops = [min(x["top"] for x in stops if x["within"] == region) for region in regions]
        assert tops == sorted(tops)


def test_keys_work_every_control(browser: Browser) -> None:
    browser.press(ENTER, "play")
    assert browser.ask("return page.clock.playing")
    browser.press(" ", "play")
    assert not browser.ask("return page.clock.playing")
    browser.press(RIGHT, "slider-r0")
    assert browser.ask("return page.scene.r0") > 50
    browser.press(ENTER, "reset")
    assert browser.ask("return page.scene.r0") == 50
    browser.press("\b\b60" + ENTER, "field-r0")
    assert browser.ask("return page.scene.r0") == 60
    browser.press(DOWN, "examples")
    assert browser.ask("return [at.examples.value, page.scene.r0]") == [SAMPLES[0].stem, 150]
    browser.press(" ", "waves")
    assert browser.ask("return at.waves.checked")
    browser.press(RIGHT, "scrub")
    assert browser.ask("return page.clock.t") > 0
    row = browser.driver.find_element("css selector", "#record tr[title*='T_nutation']")
    row.send_keys("")
    browser.ask("arguments[0].focus()", row)
    said = browser.ask("return at.explained.textContent")
    assert said == "T, nutation period: T = 4 K/√(a (u3 - u2))  (5,1)  (key T_nutation)"
    below = "at.record.parentElement.scrollTop > 0 && at.explained.getBoundingClientRect().top"
    section = browser.ask("return at.record.parentElement.getBoundingClientRect().top")
    assert browser.ask(f"return {below}") == pytest.approx(section, abs=1)
    t = browser.ask("return page.clock.t")
    row.send_keys(DOWN)
    assert browser.ask("return page.clock.t") == t


def test_every_letter_of_the_record_is_explained(browser: Browser) -> None:
    """Symbol, meaning and formula are shown on hover and on focus or tap, in every example."""
    rows = browser.ask(
        """return [...at.examples.options].flatMap((example) => {
            set(at.examples, example.value);
            return [...at.record.querySelectorAll("tbody tr[tabindex]")].map((row) => {
                row.focus();
                return [row.cells[0].textContent, row.title, at.explained.textContent];
            });
        })"""
    )
    assert {"λ", "a", "b", "u1", "q", "K'", "T", "Tψ", "ϑ min", "ψ' mean"} <= {x for x, *_ in rows}
    for symbol, title, said in rows:
        assert title == said
        assert title.startswith(f"{symbol}, ")
        assert " = " in title, title


@pytest.mark.parametrize("still", [True, False])
def test_motion_starts_only_for_readers_who_want_it(
    browser: Browser, page_file: Path, still: bool
) -> None:
    browser.open(page_file, still=still)
    browser.settle()
    playing, t = browser.ask("return [page.clock.playing, page.clock.t]")
    assert (playing, t > 0) == (not still, not still)
    assert browser.ask("return document.getAnimations().length") == 0


def test_paper_shows_no_controls(browser: Browser, page_file: Path) -> None:
    """The rules of narrow screens must not win over those of paper."""
    browser.open(page_file, width=720)
    browser.command("Emulation.setEmulatedMedia", {"media": "print"})
    shown = f"{CONTROLS}.filter((part) => part.matches('button, select, [type=range], h2 *'))"
    height, left = browser.ask(f"return [at.space.clientHeight, {shown}.map({NAME})]")
    browser.command("Emulation.setEmulatedMedia", {"media": ""})
    assert left == []
    assert height < 90 / 25.4 * 96


@pytest.mark.parametrize(
    ("width", "zoom"), [(1280, 1), (820, 1), (390, 1), (1280, 2), (1280, 4), (820, 2)]
)
def test_nothing_is_lost_on_a_small_screen_or_if_the_page_is_enlarged(
    browser: Browser, page_file: Path, width: int, zoom: int
) -> None:
    """Up to 400 % and on a phone: nothing is cut, covered or beside the screen."""
    browser.open(page_file, width=width, height=844 if width == 390 else 800, zoom=zoom)
    assert width > 390 or browser.ask("return at.space.clientWidth") > 340
    assert browser.ask("return document.documentElement.scrollWidth") <= width // zoom
    lost = browser.ask(
        f"""return {CONTROLS}.filter((part) => {{
            part.scrollIntoView({{ block: "center" }});
            const {{ x, y, width, height }} = part.getBoundingClientRect();
            const top = document.elementFromPoint(x + width / 2, y + height / 2);
            return !part.contains(top) && !top?.closest("label")?.contains(part);
        }}).map({NAME})"""
    )
    assert lost == []
    cut = "part.scrollWidth > part.clientWidth + 1 && part.clientWidth"
    texts = "[...document.querySelectorAll('label, th, td, button, h2, p, .regime')]"
    assert browser.ask(f"return {texts}.filter((part) => {cut}).map((x) => x.textContent)") == []


def test_the_page_runs_only_its_own_script_and_sends_no_requests(
    browser: Browser, page_file: Path
) -> None:
    """Nothing is requested, whatever a reader does; nothing could be, because of the policy."""
    browser.requests()
    browser.complaints()
    browser.open(page_file)
    browser.ask(
        """for (const kind of ["csv", "toml", "png"]) { at.kind.value = kind; at.save.click(); }
        for (const button of document.querySelectorAll("button")) button.click();"""
    )
    tab_stops(browser)
    assert browser.complaints() == []
    own = ("data:", "about:", "blob:")
    assert [x for x in browser.requests() if not x.startswith(own)] == [page_file.as_uri()]
    blocked = browser.ask(
        """const done = [];
        const tries = {
            script: () => document.head.append(Object.assign(
                document.createElement("script"), { textContent: "window.intruder = 1" })),
            picture: () => { new Image().src = "https://example.org/x.png"; },
            handler: () => { document.body.setAttribute("onclick", "window.intruder = 1");
                document.body.click(); },
            style: () => { document.body.setAttribute("style", "opacity: 0.5"); },
        };
        for (const attempt of Object.values(tries)) attempt();
        return [window.intruder ?? null, getComputedStyle(document.body).opacity]"""
    )
    assert blocked == [None, "1"]
    said = " ".join(browser.complaints())
    for directive in ("script-src 'sha256-", "style-src 'sha256-", "img-src data:"):
        assert directive in said
