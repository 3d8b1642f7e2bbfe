@pytest.mark.parametrize(
    ("path", "style"), [*((path, LIGHT) for path in SAMPLES), (SAMPLES[0], DARK)]
)
def test_every_kind_of_every_sample(path: Path, style: Look) -> None:
    """Warnings are errors, those of missing glyphs and of failed layouts too."""
    x, y = keymap.parse_axis("--x", "r0=20:100:4"), keymap.parse_axis("--y", "theta0=10:90:3")
    page = Page(sample_motion(path), list(KINDS), PlotRequest(x=x, y=y, radians=style is DARK), style)
    assert page_bytes(page, "png", 40).startswith(b"\x89PNG")


@pytest.mark.parametrize("name", REGIMES)
def test_every_regime(name: str) -> None:
    scene = solve(Top(**REGIMES[name]))
    assert name == scene.regime.value or name not in {regime.value for regime in Regime}
    page = Page(scene, ["sphere", "angles", "remainders", "cubic", "phase"], PlotRequest(), LIGHT)
    assert page_bytes(page, "png", 40).startswith(b"\x89PNG")
    if not nutation_period(scene):
        with pytest.raises(LagtopError, match=r"no remainders: .* has no nutation period"):
            page_bytes(page._replace(kinds=["remainders"]), "png", 40)


@pytest.mark.parametrize(
    ("style", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
def test_files_are_the_same_every_time(style: str, start: bytes) -> None:
    page = Page(solve(Top()), ["sphere", "cubic"], PlotRequest(), LIGHT)
    first, second = (page_bytes(page, style, 50) for _ in range(2))
    assert first == second
    assert first.startswith(start)
    assert not re.search(rb"20\d\d-\d\d|CreationDate|matplotlib v", first)


def test_letters_shrink_with_the_page_and_fit_it() -> None:
    page = Page(solve(Top()), ["sphere", "phase"], PlotRequest(), LIGHT, (7.35, 2.5))
    assert page.lettering() == pytest.approx(0.5)
    with styled(LIGHT, page.lettering()):
        figure = Figure(figsize=page.inches(), layout="constrained")
        draw_page(figure, page)
        figure.savefig(io.BytesIO(), format="png")
        boxes = [text.get_window_extent() for text in figure.subfigs[0].texts[1:]]
    keys, values = boxes[::2], boxes[1::2]
    assert all(key.x1 < value.x0 for key, value in zip(keys, values, strict=True))
    assert all(upper.y0 > lower.y0 for upper, lower in pairwise(keys))


def test_the_numbers_of_the_sheet(lagtop: Lagtop) -> None:
    figure = drawn(solve(Top()), ["sphere", "angles"])
    texts = {text.get_text() for text in figure.subfigs[0].texts}
    assert {"T_nutation", "0.4292501", "mean_precession_rate", "7.991055", "cusped"} <= texts


def _seen(colour: str, matrix: Sequence[Sequence[float]]) -> Array:
    """CIELAB of a colour as it is seen through a simulation in linear RGB."""
    rgb = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    linear = np.clip(np.array(matrix) @ linear, 0, 1)
    to_xyz = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    x, y, z = np.cbrt(np.maximum(np.array(to_xyz) @ linear / [0.9505, 1, 1.089], 1e-6))
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


VISIONS: dict[str, list[list[float]]] = {  # Machado, Oliveira and Fernandes (2009), severity 1
    "normal": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "protan": [
        [0.152286, 1.052583, -0.204868],
        [0.114503, 0.786281, 0.099216],
        [-0.003882, -0.048116, 1.051998],
    ],
    "deutan": [
        [0.367322, 0.860646, -0.227968],
        [0.280085, 0.672501, 0.047413],
        [-0.011820, 0.042940, 0.968881],
    ],
    "tritan": [
        [1.255528, -0.076749, -0.178779],
        [-0.078411, 0.930809, 0.147602],
        [0.004733, 0.691367, 0.303900],
    ],
}


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("style", [LIGHT, DARK], ids=["light", "dark"])
def test_the_colours_differ_for_everybody(style: Look, vision: str) -> None:
    seen = [_seen(colour, VISIONS[vision]) for colour in (*style.lines, style.paper)]
    distances = [float(np.linalg.norm(p - q)) for i, p in enumerate(seen) for q in seen[i + 1 :]]
    assert min(distances) > 15


