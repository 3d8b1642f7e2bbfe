"""The nome series converge for every real u and k < 1, as fast as their bounds say."""

from __future__ import annotations

import json
import re
from itertools import islice
from typing import Any

import mpmath
import pytest
from conftest import Lagtop

from lagrange_cli.elliptic.many_digits import ManyDigits
from lagrange_cli.elliptic.modulus import modulus
from lagrange_cli.elliptic.nome_series import k_series, nome_series, terms_needed

ar = ManyDigits(60)
MODULI = ["1e-8", "0.03", "0.5", "0.9", "0.99", "0.9999"]
ARGUMENTS = ["-2.3", "0.4", "1.7", "11", "1e6"]


def exact(name: str, u: Any, m: Any) -> Any:
    """Return a function by mpmath, from theta functions of its own or by R_F."""
    with mpmath.workdps(80):
        if name == "K":
            return mpmath.ellipk(m)
        sn, cn = (mpmath.ellipfun(f, u, m=m) for f in ("sn", "cn"))
        if name != "am":
            return sn if name == "sn" else cn
        turns = mpmath.nint(u / (2 * mpmath.ellipk(m)))
        sign = -1 if turns % 2 else 1
        return turns * mpmath.pi + mpmath.atan2(sign * sn, sign * cn)


@pytest.mark.parametrize("k", MODULI)
def test_errors_are_below_their_bounds(k: str) -> None:
    """Bounds are also worth something: some error is over a sixth of its bound, of K a third."""
    given, m = modulus(ar, k=ar.mpf(k)), mpmath.mpf(k)
    with mpmath.workdps(80):
        m = mpmath.mpf(k) ** 2
    shares: dict[str, list[Any]] = {name: [] for name in ("K", "am", "sn", "cn")}
    for u in map(ar.mpf, ARGUMENTS):
        for name, series in ({"K": k_series(ar, given)} | nome_series(ar, u, given)).items():
            true = exact(name, u, m)
            for n, part in enumerate(islice(series.sums, 30), 1):
                if series.bound(n) > 1e-40:
                    shares[name].append(abs(part - true) / series.bound(n))
    greatest = {name: max(found) for name, found in shares.items()}
    assert greatest["K"] > 1 / 3 or k == "0.9999"
    for name, share in greatest.items():
        assert share <= 1, name
        assert share > 1 / 6 or name == "K", name


@pytest.mark.parametrize("k", MODULI)
def test_as_many_terms_as_are_needed(k: str) -> None:
    """All four series converge for any real u: the bounds fall to 1e-16 and below."""
    given = modulus(ar, k=ar.mpf(k))
    for _, _, bound in (k_series(ar, given), *nome_series(ar, ar.mpf(1), given).values()):
        n = terms_needed(bound, ar.mpf("1e-16"))
        assert bound(n) <= 1e-16 < (bound(n - 1) if n > 1 else 1)
        assert bound(terms_needed(bound, ar.mpf("1e-300"))) <= 1e-300


@pytest.mark.slow
def test_table_and_counts(lagtop: Lagtop) -> None:
    """Errors that doubles can hold are errors of the series, however small."""
    args = "jacobi --k 0.5 --u 0.7 --series 100 --format json".split()
    result = lagtop(*args)
    for row in json.loads(result.stdout):
        for name in ("K", "am_deg", "sn", "cn"):
            assert 0 <= row[f"{name}_error"] <= row[f"{name}_bound"], (name, row)
    assert row["sn_error"] > 1e-180
    counts = "K 24, am_deg 9, sn 10, cn 10"
    assert result.stderr == f"Terms whose error is proved to be below 1e-16: {counts}\n"
    close = lagtop("jacobi", "--k-prime", "1e-300", "--series", "1", "--format", "json")
    assert "K 3.27e+601" in close.stderr
    assert "inf" not in close.stdout


def test_counts_of_any_size_are_found_at_once(lagtop: Lagtop) -> None:
    """For K it is about 1/k'^2, k'^2 = 16 exp(pi^2/log q); a bisection would take 140 000 steps."""
    given = modulus(ar, q=ar.mpf("0.9999"))
    asked, bound = [], k_series(ar, given).bound

    def counted(n: int) -> Any:
        asked.append(n)
        return bound(n)

    enough = terms_needed(counted, ar.mpf("1e-16"))
    assert len(asked) < 400
    with mpmath.workdps(60):
        size = mpmath.pi**2 / -mpmath.log(mpmath.mpf("0.9999"))
        assert abs(mpmath.log(enough) / size - 1) < 1e-3
    assert bound(enough) <= ar.mpf("1e-16") < bound(enough * 999 // 1000)
    result = lagtop(*"jacobi --nome 0.9999 --series 1 --format csv".split())
    assert result.exit_code == 0
    assert re.search(r"below 1e-16: K \d\.\d\de\+4286\d$", result.stderr.strip())
