"""The page: its motion against lagtop in Node, its file, and one session of a browser."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
from base64 import b64encode
from collections.abc import Iterator, Sequence
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from lagtop import LagtopError, Motion, Top, read_scene, solve, view
from scenes import EVERY_KIND, UNIT
from scipy.spatial.transform import Rotation

from lagrange_cli.account.summary import PHRASES, summary
from lagrange_cli.bench import hard_scenes
from lagrange_cli.plot.browser.view import page_scene
from lagrange_cli.plot.style import DARK, LIGHT
from lagrange_cli.solver.keys import NUMBERS
from lagrange_cli.top.scenes import scene_names
from lagrange_cli.top.units import in_si

MOTION_JS = ROOT / "lagrange_cli" / "plot" / "browser" / "motion.js"
ORDINARY = ("generic", "from rest", "slow", "no spin")
PERIODS = 0.1, 0.5, 1.3, 4.6, 9.95, 19.7
LIMIT = 1e-7
"""Greatest error of the attitude (rad), unless the page marks itself as a sketch."""


def computed(motions: Sequence[Motion]) -> list[dict[str, Any]]:
    """Return angles, sentences and numbers of motions by the page, at times within 20 periods."""
    node = shutil.which("node")
    if not node:
        pytest.skip("no node")
    tasks = [{"scene": page_scene(x), "times": times_of(x)} for x in motions]
    data = f"const tasks = {json.dumps(tasks)}, phrases = {json.dumps(PHRASES)};"
    code = f"""
        import {{ motionOf, sentence }} from "{MOTION_JS.as_uri()}";
        {data}
        console.log(JSON.stringify(tasks.map(({{ scene, times }}) => {{
            const motion = motionOf(scene);
            const {{ doubt = null, record }} = motion;
            const angles = times.map((t) => Object.values(motion.angles(t)));
            return {{ doubt, record, angles, words: sentence(motion, phrases, "time") }};
        }})));"""
    command = [node, "--input-type=module", "-"]
    done = subprocess.run(command, input=code, capture_output=True, check=True, text=True)
    found: list[dict[str, Any]] = json.loads(done.stdout)
    return found


def times_of(motion: Motion) -> list[float]:
    unit = motion.T_nutation or motion.T_precession or motion.T_spin or 1.0
    return [x * unit for x in PERIODS]


def assert_that_of_solve(motion: Motion, page: dict[str, Any]) -> None:
    """Check the attitudes, the sentence and the numbers of a page that is no sketch."""
    theta, phi, psi = np.array(page["angles"], float).T
    shown = Rotation.from_euler("ZXZ", np.stack([psi, theta, phi], axis=1))
    away = motion.rotation(times_of(motion)) * shown.inv()
    assert away.magnitude().max() <= LIMIT, motion.top
    assert page["words"] == summary(motion), motion.top
    for key, number in page["record"].items():
        exact = getattr(motion, key)
        assert (number is None) == (exact is None), (key, motion.top)
        size = 1e-12 if NUMBERS[key].relative_to else 0.0
        assert number is None or number == pytest.approx(exact, rel=1e-6, abs=size), (key, motion)


PAGES: dict[str, tuple[dict[str, Any], str | None]] = {
    "nearly 180 degrees": ({"r0": 34, "theta0_deg": 179.979}, None),
    "nearly upright": ({"r0": 90, "theta0_deg": 0.02}, None),
    "from the pole": ({"theta0_deg": 0, "r0": 115.4, "thetadot0": -3}, None),
    "over both poles": (UNIT | {"g": 2, "r0": 0, "theta0_deg": 0, "thetadot0": 1}, None),
    "over the lower pole": (
        {"m": 1, "s": 1, "g": 2, "A": 8, "C": 8, "r0": -1}
        | {"theta0_deg": 90, "thetadot0": 2, "psidot0": 1},
        None,
    ),
    "fast": ({"r0": 9e5}, None),
    "a tie": ({"theta0_deg": 45.625}, None),
    "loops that are nearly cusps": (UNIT | {"r0": 3, "theta0_deg": 50, "psidot0": -1e-10}, None),
    "too fast": ({"r0": 4.8e18}, "the nutation is lost in double precision"),
    "next to the vertical": ({"theta0_deg": 1e-4}, "the axis starts next to the vertical"),
}
"""Scenes that the page described wrongly, and why the page is only a sketch."""


@pytest.mark.parametrize("count", [4, pytest.param(100, marks=pytest.mark.slow)])
def test_scenes_of_every_kind_move_as_lagtop_says(count: int) -> None:
    """Few ordinary ones are sketches, of the shipped ones those next to a limit or on it."""
    motions = {x: solve(read_scene(x)) for x in scene_names()}
    motions |= {f"kind of motion: {x}": solve(Top(**y)) for x, y in EVERY_KIND.items()}
    motions |= {x: solve(Top(**inputs)) for x, (inputs, _) in PAGES.items()}
    vertical = [Top(theta0_deg=x, r0=20, thetadot0=y) for x in (0, 180) for y in (-1, 0, 1)]
    motions |= {f"vertical {i}": solve(x) for i, x in enumerate(vertical)}
    for kind, scene_of_kind in hard_scenes.KINDS.items():
        rng = Random(f"page {kind}")
        for i in range(count):
            with suppress(LagtopError):  # precession on the vertical, or a size beyond the page
                motion = solve(Top(**hard_scenes.in_doubles(scene_of_kind(rng))))
                page_scene(motion)
                motions[f"random: {kind} {i}"] = motion
    pages = dict(zip(motions, computed([*motions.values()]), strict=True))
    clear = {x for x, page in pages.items() if not page["doubt"]}
    for name in clear:
        assert_that_of_solve(motions[name], pages[name])
    assert {x: pages[x]["doubt"] for x in PAGES} == {x: doubt for x, (_, doubt) in PAGES.items()}
    assert {*scene_names()} - clear == {"kinon-betsch-cone", "near-separatrix", "whittaker-71"}
    assert len(clear) >= 0.6 * len(motions)
    usual = [x for x in motions if x.startswith(tuple(f"random: {kind} " for kind in ORDINARY))]
    assert len(clear & {*usual}) >= 0.95 * len(usual)


def test_the_file_is_small_and_asks_for_nothing() -> None:
    text = view(solve(Top()))
    assert len(text.encode()) <= 65_000
    assert re.findall(r"https?://|url\(|@import|src=|href=", text) == []
    for name in ("script", "style"):
        (part,) = re.findall(rf"<{name}[^>]*>(.*?)</{name}>", text, re.DOTALL)
        digest = b64encode(sha256(part.encode()).digest()).decode()
        assert f"{name}-src 'sha256-{digest}'" in text
    for look in (LIGHT, DARK):
        colours = {look.paper, look.ink, look.quiet, look.faint, *look.lines}
        assert colours <= {*re.findall(r"#\w{6}", text)}
    assert "innerHTML" not in text
    assert "insertAdjacentHTML" not in text
    text = view(solve(Top()), lambda unit: f"</script><b>{unit}")
    assert text.count("</script>") == 1
    assert "<b>" not in text.partition("<script")[0]


# --- one session of a browser


class Browser:
    """A headless Chromium."""

    def __init__(self, driver: Any, path: Path) -> None:
        self.driver, self.address = driver, path.as_uri()

    def open(self, fragment: str = "", width: int = 1280, height: int = 800) -> None:
        """Load the page, paused, on a screen of this size."""
        screen = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", screen)
        calm = [{"name": "prefers-reduced-motion", "value": "reduce"}]
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": calm})
        self.driver.get("about:blank")
        self.driver.get(self.address + fragment)
        self.ask("")

    def ask(self, script: str) -> Any:
        """Return what a script returns; `at(id)` is an element, and `set` changes it."""
        names = """const at = (id) => document.getElementById(id);
            const set = (id, value) => {
                at(id).value = value;
                at(id).dispatchEvent(new Event("change", { bubbles: true }));
            };"""
        found = self.driver.execute_script(names + script)
        self.driver.execute_async_script(
            "requestAnimationFrame(() => requestAnimationFrame(arguments[0]))"
        )
        return found


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Start a browser, or skip the test with the reason why there is none."""
    webdriver = pytest.importorskip("selenium.webdriver")
    programs = [shutil.which(name) for name in ("chromium", "chromedriver")]
    if not all(programs):
        pytest.skip("no chromium and chromedriver (apt-get install chromium chromium-driver)")
    path = tmp_path_factory.mktemp("view") / "top.html"
    view(solve(Top()), in_si).save(path)
    options = webdriver.ChromeOptions()
    options.binary_location = programs[0]
    for word in ("headless=new", "no-sandbox", "disable-gpu", "disable-dev-shm-usage"):
        options.add_argument(f"--{word}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(programs[1]))
    try:
        yield Browser(driver, path)
    finally:
        driver.quit()


@pytest.mark.slow
def test_a_session_in_the_browser(browser: Browser) -> None:
    browser.open()
    assert "every 0.4293" in browser.ask("return at('words').textContent")
    wide, tall, whole = browser.ask(
        "const x = at('stage').getBoundingClientRect();"
        "return [x.width, x.height, innerWidth * innerHeight]"
    )
    assert wide * tall >= 0.5 * whole

    browser.ask("set('field-r0', '60')")
    exact = solve(Top(r0=60))
    assert f"{exact.T_nutation:.7g}" in browser.ask("return at('record').textContent")
    slider = "at('field-psidot0').nextElementSibling"
    browser.ask(f"{slider}.value = -3; {slider}.dispatchEvent(new Event('input'))")
    assert "has loops" in browser.ask("return at('words').textContent")

    browser.ask("set('time', '1e3')")
    exact = solve(Top(r0=60, psidot0=-3))
    tilt = math.degrees(exact.angles(1e3).theta)
    shown = browser.ask("return at('now').textContent")
    assert float(re.findall(r"ϑ = ([\d.]+)°", shown)[0]) == pytest.approx(tilt, abs=1e-4)

    address = browser.ask("return location.hash")
    browser.open(address)
    assert browser.ask("return [at('field-r0').value, at('time').value]") == ["60", "1000"]
    assert browser.ask("return at('now').textContent") == shown
    browser.ask("set('scenes', 'sleeping-top')")
    assert "upright, and this is stable" in browser.ask("return at('words').textContent")
    assert "kg" not in browser.ask("return at('inputs').textContent + at('record').textContent")
    browser.ask("set('field-r0', '56'); set('field-theta0_deg', '1e-4'); set('field-psidot0', '1')")
    assert browser.ask("return at('sketch').hidden") is False


@pytest.mark.slow
def test_bad_values_are_named_and_leave_the_motion(browser: Browser) -> None:
    browser.open()
    browser.ask("set('field-C', '-1')")
    assert browser.ask("return at('error').textContent").startswith("C must be positive")
    assert browser.ask("return document.body.className") == "bad"
    browser.ask("set('field-C', '80000')")  # the page has units
    assert browser.ask("return at('error').textContent").startswith("C must be positive; above 2A")
    browser.ask("set('field-C', '17458'); set('field-psidot0', '-3'); set('field-theta0_deg', '0')")
    assert browser.ask("return at('error').textContent").startswith("ψ'0 must be 0")
    browser.ask("set('field-psidot0', '0')")  # both zeros count
    assert "upright" in browser.ask("return at('words').textContent")
    assert "r0 sleeping" in browser.ask("return at('record').textContent")
    assert browser.ask("return at('scenes').selectedOptions[0].textContent") == (
        "this scene (edited)"
    )
    browser.ask("set('field-theta0_deg', '30'); set('field-psidot0', '-3')")
    browser.ask("set('field-theta0_deg', '0'); at('fix').click()")
    browser.ask("set('field-theta0_deg', '30'); set('field-psidot0', '-3')")
    assert browser.ask("return [at('error').textContent, document.body.className]") == ["", ""]
    slider = "at('field-{}').nextElementSibling.{}"
    ends = [("m", "min"), ("A", "min"), ("C", "max"), ("theta0_deg", "max")]
    shown = browser.ask(f"return [{', '.join(slider.format(*x) for x in ends)}]")
    assert [float(x) for x in shown] == [15.87, 17458 / 2, 2 * 39032, 180]

    for word in ("-3", "x", "1e400", "3"):
        browser.ask(f"set('time', '{word}')")
        state = browser.ask("return [at('error').textContent, at('time').className]")
        assert state == (["", ""] if word == "3" else ["t must be a number, at least 0", "wrong"])
    boxes = "['play', 'restart', 'full', 'time', 'speed'].map((x) => at(x).offsetTop)"
    assert browser.ask(f"const y = {boxes}; return Math.max(...y) - Math.min(...y)") < 20
    assert "(kg m²)" in browser.ask("return at('inputs').textContent")


@pytest.mark.slow
def test_numbers_without_units_need_no_rigid_body(browser: Browser, tmp_path: Path) -> None:
    view(solve(Top())).save(tmp_path / "top.html")
    browser.driver.get((tmp_path / "top.html").as_uri())
    browser.ask("set('field-C', '80000')")
    assert browser.ask("return at('sketch').textContent") == "no rigid body has C > 2A"
    exact = solve(Top(m=1587, A=39032, C=80000, s=4, g=981))
    assert f"{exact.T_nutation:.7g}" in browser.ask("return at('record').textContent")
    browser.ask("set('field-C', '17458')")
    assert browser.ask("return at('sketch').hidden")


@pytest.mark.slow
def test_the_page_runs_and_fits_a_phone(browser: Browser) -> None:
    browser.open()
    width = browser.ask("return at('play').offsetWidth")
    browser.ask("at('play').click()")
    assert browser.ask("return at('play').offsetWidth") == width
    times = browser.driver.execute_async_script(
        """const [done, shown] = [arguments[0], []];
        requestAnimationFrame(function next() {
            shown.push(Number(document.getElementById("time").value));
            if (shown.length < 10) requestAnimationFrame(next);
            else done(shown);
        });"""
    )
    assert times[-1] > times[2] > 0
    browser.driver.find_element("id", "full").click()
    assert browser.ask("return document.fullscreenElement?.id") == "stage"
    browser.ask("document.exitFullscreen()")
    browser.open(width=390, height=844)
    assert browser.ask("return document.documentElement.scrollWidth") <= 390
    browser.ask("at('field-psidot0').scrollIntoView()")
    top, height = browser.ask(
        "const x = at('stage').getBoundingClientRect(); return [x.top, x.height]"
    )
    assert top == 0
    assert height <= 0.45 * 844
    assert browser.ask("return at('curves').offsetTop < at('controls').offsetTop")

    assert [x["message"] for x in browser.driver.get_log("browser")] == []
    events = [json.loads(x["message"])["message"] for x in browser.driver.get_log("performance")]
    sent = [x["params"] for x in events if x["method"] == "Network.requestWillBeSent"]
    assert {x["request"]["url"].partition(":")[0] for x in sent} <= {"file", "about"}
