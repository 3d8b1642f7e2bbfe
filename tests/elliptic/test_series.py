"""The nome series converge for every real u and k < 1, as fast as their bounds say."""

from __future__ import annotations

import json
from itertools import islice
from typing import Any

import mpmath
import pytest
from conftest import Lagtop
from ours import ar, ours

from lagrange_cli.arithmetic.ball import balls
from lagrange_cli.elliptic.nome_series import k_series, nome_series

MODULI = ["1e-8", "0.03", "0.5", "0.9", "0.99", "0.9999"]
ARGUMENTS = ["-2.3", "0.4", "1.7", "11"]


def exact(name: str, u: str, m: Any) -> Any:
    """Return a function by mpmath; am by sn, cn and the number of half turns."""
    K = ar.ellipk(m)
    sn, cn = (ar.ellipfun(f, ar.mpf(u), m=m) for f in ("sn", "cn"))
    turns = ar.nint(ar.mpf(u) / (2 * K))
    am = turns * ar.pi + ar.atan(sn / cn)
    return {"K": K, "am": am, "sn": sn, "cn": cn}[name]


@pytest.mark.parametrize("k", MODULI)
def test_errors_are_below_their_bounds(k: str) -> None:
    """Bounds are also worth something: some error is over a sixth of its bound, of K a third."""
    m = ar.mpf(k) ** 2
    shares: dict[str, list[Any]] = {name: [] for name in ("K", "am", "sn", "cn")}
    with balls(60):
        given = ours.modulus(ar.mpf(k))
        for u in ARGUMENTS:
            series = {"K": k_series(given)} | nome_series(ours.ball(ar.mpf(u)), given)
            for name, one in series.items():
                true = exact(name, u, m)
                for n, part in enumerate(islice(one.sums, 30), 1):
                    bound = ours.number(one.bound(n))
                    if bound > 1e-40:
                        shares[name].append(abs(ours.number(part) - true) / bound)
    greatest = {name: max(found) for name, found in shares.items()}
    assert greatest["K"] > 1 / 3 or k == "0.9999"
    for name, share in greatest.items():
        assert share <= 1, name
        assert share > 1 / 6 or name == "K", name


def test_table(lagtop: Lagtop) -> None:
    """Errors that doubles can hold are errors of the series, however small."""
    args = "jacobi --k 0.5 --u 0.7 --series 100 --format json".split()
    rows = json.loads(lagtop(*args).stdout)
    assert [row["terms"] for row in rows] == list(range(1, 101))
    for row in rows:
        for name in ("K", "am_deg", "sn", "cn"):
            assert 0 <= row[f"{name}_error"] <= row[f"{name}_bound"], (name, row)
    assert rows[-1]["sn_error"] > 1e-180
    assert rows[-1]["sn"] == pytest.approx(float(mpmath.ellipfun("sn", 0.7, k=0.5)), abs=1e-15)
    assert rows[9]["K_error"] == pytest.approx(float(mpmath.ellipk(0.25)) - rows[9]["K"], abs=1e-15)
    close = lagtop("jacobi", "--k-prime", "1e-300", "--series", "1", "--format", "json")
    assert "inf" not in close.stdout
