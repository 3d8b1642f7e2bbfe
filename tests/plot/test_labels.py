"""Labels of pictures do not touch: judged by their boxes, over random scenes, not by eye."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np
import pytest
from lagtop import Motion, Top, solve
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from lagrange_cli.plot.cubic import cubic_curve
from lagrange_cli.plot.globe import camera_at, draw_globe
from lagrange_cli.plot.kinds import KINDS, PlotRequest
from lagrange_cli.plot.style import LIGHT, styled

SCENES = 200


def random_motions(count: int) -> Iterator[Motion]:
    """Yield tops of all kinds: at rest and not, upright, fast, slow, and near the separatrix."""
    draw = np.random.default_rng(1952)
    while count:
        inputs = {"r0": float(draw.normal() * 10 ** draw.uniform(0, 2.5))}
        off = 10 ** draw.uniform(-6, 1)
        inputs["theta0_deg"] = float(draw.choice([draw.uniform(0, 180), off, 180 - off]))
        for name in ("thetadot0", "psidot0"):
            if draw.random() < 0.5:
                inputs[name] = float(draw.normal() * 10 ** draw.uniform(-1, 1.5))
        count -= 1
        yield solve(Top(**inputs))


def bare(axes: Axes) -> Axes:
    """Return axes without what was drawn on them, which costs less than new ones."""
    for artist in [*axes.lines, *axes.texts, *axes.collections, *axes.patches, *axes.artists]:
        artist.remove()
    return axes


def written(axes: Axes) -> list[Text]:
    """Return the texts of an axes that are seen, the numbers of the ticks among them."""
    texts = [*axes.texts, axes.title, axes.xaxis.label, axes.yaxis.label]
    for axis in (axes.xaxis, axes.yaxis) if axes.axison else ():
        low, high = sorted(axis.get_view_interval())
        ticks = zip(axis.get_majorticklocs(), axis.get_majorticklabels(), strict=True)
        texts += [label for place, label in ticks if low <= place <= high]
        texts.append(axis.get_offset_text())
    return [text for text in texts if text.get_visible() and text.get_text().strip()]


def touching(texts: list[Text]) -> list[tuple[str, str]]:
    """Return the pairs of texts whose boxes overlap by more than a pixel."""
    boxes = [text.get_window_extent() for text in texts]
    return [
        (texts[i].get_text(), texts[j].get_text())
        for i, j in combinations(range(len(texts)), 2)
        if (both := Bbox.intersection(boxes[i], boxes[j])) and both.width > 1 and both.height > 1
    ]


@pytest.mark.slow
def test_the_roots_and_the_poles_of_the_cubic_are_written_where_there_is_room() -> None:
    """No text touches another, the curve, or the lines of the poles."""
    with styled(LIGHT):
        axes = Figure(figsize=(6.8, 5.0)).add_subplot()
        for motion in random_motions(SCENES):
            KINDS["cubic"].draw(motion, PlotRequest(), lambda _: [bare(axes)])
            axes.title.set_visible(False)
            assert touching(written(axes)) == [], motion.top
            cubic = cubic_curve(motion)
            curve = axes.transData.transform(np.stack([cubic.u, cubic.f], axis=1))
            names = [text for text in axes.texts if text.get_text().startswith(("u₁", "u₂", "u₃"))]
            assert names
            for name in names:
                box = name.get_window_extent()
                assert not box.count_contains(curve), (motion.top, name)


@pytest.mark.slow
def test_the_names_on_the_globe() -> None:
    """Names of axes do not touch, from wherever one looks, and all of them are on the page."""
    draw, limits = np.random.default_rng(7), (0.5, 1.0)
    with styled(LIGHT):
        axes = Figure(figsize=(6.4, 6.0)).add_subplot()
        for _ in range(SCENES):
            camera = camera_at(draw.uniform(-math.pi, math.pi), math.asin(draw.uniform(-1, 1)))
            draw_globe(bare(axes), camera, limits, PlotRequest())
            names = written(axes)
            assert sorted("".join(x.get_text() for x in names).replace(", ", "")) == ["x", "y", "z"]
            assert touching(names) == []
            page = axes.get_window_extent()
            boxes = [x.get_window_extent() for x in names]
            assert all(page.contains(*corner) for box in boxes for corner in box.corners())
