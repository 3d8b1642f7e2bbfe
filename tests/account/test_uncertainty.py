"""Uncertain inputs in records, tables and budgets; `uncertainties` checks notation and rounding."""

from __future__ import annotations

import json
import math
import random
import re

import pytest
from conftest import Lagtop, Solved, dicts

from lagrange_cli.arithmetic.text import uncertain_text
from lagrange_cli.top.values import parse_value

uncertainties = pytest.importorskip("uncertainties")

BODY = ["--m", "1587(2)", "--A", "39032", "--C", "17458", "--s", "4.00(1)", "--g", "981 ± 0.1 %"]


def test_uncertain_numbers_are_written_and_read_as_by_uncertainties() -> None:
    """They are rounded as the Particle Data Group does."""
    rng = random.Random(1)
    pairs = [(5.0, x) for x in (0.1, 0.3549, 0.355, 0.9494, 0.95, 0.9949)]
    pairs += [(0.0, 0.02), (2e150, 1e145)]
    for _ in range(500):
        value = rng.choice([-1, 1]) * 10 ** rng.uniform(-8, 9)
        pairs.append((value, abs(value) * 10 ** rng.uniform(-13, 2)))
    for value, std in pairs:
        text = uncertain_text(value, std)
        assert text == f"{uncertainties.ufloat(value, std):S}", text
        read, other = parse_value("m", text, uncertain=True), uncertainties.ufloat_fromstr(text)
        assert float(read.number) == pytest.approx(other.n, rel=1e-15)
        assert float(read.std or 0) == pytest.approx(other.s, rel=1e-12)
    assert [uncertain_text(5.0, 0.0), uncertain_text(2e300, 1e295)] == ["5.0", "2.000000(10)e+300"]


def test_an_uncertainty_on_request_is_in_every_format(lagtop: Lagtop) -> None:
    uncertain = ["solve", "--r0", "50(1)", "--get", "T_nutation,T_nutation_std"]
    value, std = (plain := lagtop(*uncertain)).stdout.splitlines()
    assert plain.stderr == ""  # it is in proportion
    assert lagtop(*uncertain, "--format", "csv").stdout.splitlines()[1] == f"{value},{std}"
    shown = uncertain_text(float(value), float(std))
    assert lagtop(*uncertain, "--format", "table").stdout == f"{shown}\n{std}\n"


def test_the_record_carries_uncertainties(lagtop: Lagtop, solved: Solved) -> None:
    text = lagtop("solve", *BODY, "--theta0", "30(1)", "--format", "json").stdout
    record = json.loads(text)
    assert list(record)[list(record).index("remark") + 1] == "m_std"
    assert record["m_std"] == 2
    assert record["g_std"] == 0.981
    assert record["A_std"] == 0
    shown = lagtop("solve", *BODY, "--theta0", "30(1)").stdout
    assert uncertain_text(record["T_nutation"], record["T_nutation_std"]) in shown
    assert "1587.0(2.0)" in shown
    radians = solved(*BODY, "--rad", "--theta0", "0.5(1)")
    assert radians["theta_min_rad_std"] == pytest.approx(0.1)


def test_a_budget_adds_up(lagtop: Lagtop) -> None:
    arguments = [*BODY, "--theta0", "30(1)", "--budget", "T_nutation"]
    rows = dicts(lagtop("solve", *arguments, "--format", "csv").stdout)
    *rows, result = rows
    assert [row["quantity"] for row in rows] == ["theta0_deg", "s", "m", "g"]
    whole = math.hypot(*(float(row["contribution"]) for row in rows))
    std = lagtop("solve", *BODY, "--theta0", "30(1)", "--get", "T_nutation_std").stdout
    assert whole == pytest.approx(float(std), rel=1e-14)
    known = {"quantity": "T_nutation", "value": "0.4292501244785477", "std": std.strip()}
    assert {name: text for name, text in result.items() if text} == known
    assert sum(float(row["share"]) for row in rows) == pytest.approx(1)
    assert float(rows[0]["elasticity"]) == pytest.approx(-0.572, abs=1e-3)
    text = lagtop("solve", *arguments).stdout
    assert f"T_nutation = {uncertain_text(0.4292501244785477, whole)}" in text


def test_a_budget_in_radians_is_that_in_degrees(lagtop: Lagtop) -> None:
    """Uncertain is the spin, whose unit does not change."""
    found = []
    for more, key in (([], "theta_max_deg"), (["--rad", "--theta0", "0.6"], "theta_max_rad")):
        tilt = more or ["--theta0", repr(math.degrees(0.6))]
        words = [*tilt, "--r0", "50(1)", "--thetadot0", "2.0(1)", "--budget", key]
        text = lagtop("solve", *words, "--format", "csv").stdout
        found.append(dicts(text))
    for degrees, radians in zip(*found, strict=True):
        for name in ("sensitivity", "contribution"):
            if degrees[name]:
                wanted = math.radians(float(degrees[name]))
                assert float(radians[name]) == pytest.approx(wanted, rel=1e-9)
    *rows, result = found[1]
    whole = math.hypot(*(float(row["contribution"]) for row in rows))
    assert float(result["std"]) == pytest.approx(whole, rel=1e-12)


UNITS = "--m 1587(2)g --A-cm 13640g*cm^2 --C 17458g*cm^2 --s 4cm --g 981cm/s^2".split()


def test_budgets_name_units(lagtop: Lagtop, solved: Solved) -> None:
    arguments = [*UNITS, "--r0", "50rad/s", "--psidot0", "1.0(1)rad/s"]
    shown = lagtop("solve", *arguments, "--budget", "T_nutation").stdout
    words = "m [kg]", "psidot0 [rad/s]", "contribution [s]", ") s; inputs"
    assert all(x in shown for x in words)
    found = solved(*arguments, "--budget", "T_nutation")
    assert found["units"] == {"T_nutation": "s", "m": "kg", "psidot0": "rad/s"}
    plain = solved("--m", "9(1)", "--budget", "a")
    assert "units" not in plain


def test_random_tops_have_about_the_same_uncertainties(lagtop: Lagtop) -> None:
    line = ["solve", "--m", "1587(2)", "--psidot0=-3(0.1)", "--r0", "50(1)", "--format", "json"]
    near, drawn = (json.loads(lagtop(*line, *x).stdout) for x in ([], ["--samples", 10000]))
    assert drawn.keys() == near.keys()
    stds = [key for key in near if key.endswith("_std") and near[key] is not None]
    assert len(stds) > 30
    for key in stds:
        assert drawn[key] == pytest.approx(near[key], rel=0.03, abs=1e-13), key
    beyond = lagtop("solve", "--theta0", "0.1(1)", "--samples", 100, "--get", "k_std")
    assert re.search("of 100 random tops 1[0-9] are impossible", beyond.stderr)


def test_tables_report_rough_uncertainties_and_those_of_waves(lagtop: Lagtop) -> None:
    table = ["--t-max", 3, "--n", 4, "--columns", "t,theta,dphi,dpsi"]
    fine = lagtop("table", "--r0", "50.00(1)", "--theta0", "30.00(1)", *table)
    assert fine.stderr == ""
    assert list(dicts(fine.stdout)[0])[4:] == [
        "theta_deg_std",
        "dphi_deg_std",
        "dpsi_deg_std",
    ]
    released = lagtop("table", "--thetadot0", "0+/-1", *table)
    assert "uncertainties of theta, dphi" in released.stderr
    # a wave keeps its size, and its band follows the phase: the spread of the mean rate is left out
    low, high = (
        dicts(lagtop("table", "--r0", r0, "--theta0", 30, *table).stdout) for r0 in (49.99, 50.01)
    )
    only = dicts(lagtop("table", "--r0", "50.00(1)", "--theta0", 30, *table).stdout)
    for row, one, other in zip(only, low, high, strict=True):
        for name in ("dphi_deg", "dpsi_deg"):
            half = abs(float(other[name]) - float(one[name])) / 2
            assert float(row[f"{name}_std"]) == pytest.approx(half, rel=1e-3, abs=1e-6)


@pytest.mark.parametrize(
    ("top", "times", "misled"),
    [
        # draws have the same root mean square to 6 %, though single uncertainties pass through 0
        (("50.0(5)", "30(1)"), ["--t-max", 1, "--n", 100], False),
        (("50.0(5)", "30(1)"), ["--t-max", 3, "--n", 100], False),  # 5 %
        # one standard deviation away both tilts change as linear propagation says, to 12 %
        (("25+/-8", 30), ["--t-min", 0.826, "--n", 1], True),
    ],
)
def test_tables_warn_if_the_spread_of_motions_is_another(
    lagtop: Lagtop, top: tuple[object, object], times: list[object], misled: bool
) -> None:
    found = lagtop("table", "--r0", top[0], "--theta0", top[1], *times)
    assert ("uncertainties of theta" in found.stderr) == misled


def test_late_times_have_angles_with_digits(lagtop: Lagtop) -> None:
    late = ["table", "--t-min", "3.9e14", "--n", 1]
    proved = [lagtop(*late, *how, "--digits", 5).stdout for how in (["--wrap"], [])]
    wrapped, whole = (float(dicts(text)[0]["psi_deg"]) for text in proved)
    assert abs(wrapped) <= 180 < whole
