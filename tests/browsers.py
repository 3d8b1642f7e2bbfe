"""A headless browser for the tests of the page, and the questions they ask of it.

Run as a script it prints how long frames take, and draws the picture of the README again:
`python tests/browsers.py`.
"""

from __future__ import annotations

import base64
import json
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT

Values = dict[str, Any]


class Browser:
    """A headless Chromium with one page."""

    def __init__(self, driver: Any) -> None:
        self.driver = driver

    def open(
        self,
        path: Path,
        fragment: str = "",
        *,
        width: int = 1280,
        height: int = 800,
        dark: bool = False,
        still: bool = True,
        zoom: int = 1,
    ) -> None:
        """Reload a page on a screen of this size; it is paused if `still`."""
        screen = {"width": width // zoom, "height": height // zoom, "mobile": width < 500}
        self.command("Emulation.setDeviceMetricsOverride", screen | {"deviceScaleFactor": zoom})
        self.command("Emulation.setFocusEmulationEnabled", {"enabled": True})
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        calm = {"name": "prefers-reduced-motion", "value": "reduce" if still else "no-preference"}
        self.command("Emulation.setEmulatedMedia", {"features": [scheme, calm]})
        self.driver.get("about:blank")
        self.driver.get(path.as_uri() + fragment)
        self.settle()

    def command(self, name: str, values: Values) -> Any:
        """Run a command of the browser's protocol."""
        return self.driver.execute_cdp_cmd(name, values)

    def ask(self, script: str, *values: Any) -> Any:
        """Return what a script returns; `page` is the page, `at` its elements by id.

        `set` gives an element a value, as a reader does.
        """
        names = """const { page, motionOf } = window.lagtop;
            const set = (element, value, ...kinds) => {
                element.value = value;
                for (const kind of kinds.length ? kinds : ["change"]) {
                    element.dispatchEvent(new Event(kind));
                }
            };
            const at = new Proxy({}, { get: (_, id) => document.getElementById(id) });"""
        return self.driver.execute_script(names + script, *values)

    def settle(self) -> None:
        """Wait for two frames."""
        self.driver.execute_async_script(
            "requestAnimationFrame(() => requestAnimationFrame(() => arguments[0]()))"
        )

    def press(self, keys: str, element: str | None = None) -> None:
        """Send keys, on an element or on the page."""
        target = self.driver.find_element("id", element) if element else None
        (target or self.driver.find_element("tag name", "body")).send_keys(keys)
        self.settle()

    def picture(self) -> bytes:
        """Return what is to be seen, as PNG."""
        return base64.b64decode(self.driver.get_screenshot_as_base64())

    def complaints(self) -> list[str]:
        """Return what the console has to complain of since the last time."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def requests(self) -> list[str]:
        """Return the addresses that have been asked for since the last time."""
        events = [json.loads(entry["message"])["message"] for entry in self._events()]
        sent = [event for event in events if event["method"] == "Network.requestWillBeSent"]
        return [event["params"]["request"]["url"] for event in sent]

    def _events(self) -> list[Values]:
        events: list[Values] = self.driver.get_log("performance")
        return events


@contextmanager
def chromium() -> Iterator[Browser]:
    """Start a browser, or skip the test with the reason why there is none."""
    webdriver = pytest.importorskip("selenium.webdriver", reason="selenium is not installed")
    programs = [shutil.which(name) for name in ("chromium", "chromedriver")]
    if not all(programs):
        pytest.skip("no chromium and chromedriver (apt-get install chromium chromium-driver)")
    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    for word in ("headless=new", "no-sandbox", "disable-gpu", "disable-dev-shm-usage"):
        options.add_argument(f"--{word}")
    options.add_argument("--hide-scrollbars")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(programs[1]))
    driver.set_script_timeout(120)
    try:
        yield Browser(driver)
    finally:
        driver.quit()


README_PICTURE = ROOT / "sample_inputs" / "images" / "view.png"
README_FRAGMENT = "#psidot0=-4&t=0.35"
"""The picture of the page in the README, and the scene it shows."""

FRAMES = """
    const done = arguments[0];
    const { page } = window.lagtop;
    const [whole, own] = [[], []];
    const draw = page.draw.bind(page);
    page.draw = () => {
        const start = performance.now();
        draw();
        own.push(performance.now() - start);
    };
    page.clock.play(true);
    const middle = (times) => times.sort((x, y) => x - y)[times.length >> 1];
    const next = (last) => requestAnimationFrame((now) => {
        whole.push(now - last);
        if (whole.length < 300) next(now);
        else done([middle(whole), middle(own)]);
    });
    requestAnimationFrame(next);
"""
"""Asks for the medians over 300 frames, in milliseconds: from frame to frame, and our own part."""


def main() -> None:
    """Print the medians of the times that frames take, for some scenes; make the picture."""
    from lagtop import Top, solve, view

    with chromium() as browser, tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "top.html"
        view(solve(Top())).save(path)
        for fragment in ("#", "#psidot0=-4", "#theta0_deg=1e-6", "#r0=1000"):
            browser.open(path, fragment)
            whole, own = browser.driver.execute_async_script(FRAMES)
            print(f"{fragment:17} {whole:5.1f} ms from frame to frame, {own:4.1f} ms our own")
        browser.open(path, README_FRAGMENT)
        README_PICTURE.write_bytes(browser.picture())


if __name__ == "__main__":
    main()
