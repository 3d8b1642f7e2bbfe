"""What `lagtop jacobi` and `lagtop eta` refuse: one line says why, before any work."""

from __future__ import annotations

import pytest
from conftest import Lagtop, assert_one_line

JACOBI = [
    # real functions
    ("", "give exactly one of --k, --k-prime, --m, --nome, --modular-angle"),
    ("--k 0.5 --nome 0.1", "give exactly one of --k, --k-prime, --m, --nome"),
    ("--modular-angle 91", "--modular-angle must be between 0 and 90, got 91.0"),
    ("--modular-angle 1.6 --rad", "--modular-angle must be between 0 and 1.57079632679489"),
    ("--k K", "--k must be a finite number, complex as 0.3+0.7i, got 'K'"),
    ("--nome 1e-10001", "--nome must be 0 or at least 1e-10000 in size, got '1e-10001'"),
    (f"--nome 0.{'9' * 300}", "--nome must be at most 1 - 1e-17 in size: k' is too small"),
    ("--nome 1", "--nome must be below 1 in size, got 1.0"),
    ("--k 0.5 --u 1 --functions pi", "the functions omega and pi need --param: 0.7, 0.7i or"),
    ("--k 0.5 --u 1 --param 2", "--param needs --functions omega or pi"),
    ("--k 0.5 --u 1 --functions sn,ss", "--functions must be one of am, sn, cn"),
    ("--k 1 --u 1 --functions theta", "k must be below 1 for theta functions"),
    # complex numbers, and moduli of any kind
    ("--k 1+2i --n 0.3", "--n needs a real k^2: Pi is not computed for a complex one"),
    ("--k 1+2i --phi 1+i", "--phi must be real if n is given, or if k^2 is complex"),
    ("--m i --u 1 --functions sn,am", "--functions must not contain am if k^2 is complex"),
    ("--nome 0.1+0.2i", "--nome must be exp(i pi tau) with |2 tau - 1| and |2 tau + 1| >= 1"),
    ("--nome 0.8+0.6i --u 1", "--nome must be below 1 in size, got 0.8+0.6i"),
    ("--k 0 --u iK'", "--u must not contain K' for k = 0, where it is infinite"),
    ("--k 0.5 --u 1 --functions Z", "Jacobi's Z(u) is zeta01 of zeta"),
    (
        "--k 0.5 --u K --functions theta1",
        "--u must not contain K for theta1 to theta4: theta is of",
    ),
    ("--k 0.5 --u i --functions arcsn", "--u must be real, without K, for inverse functions"),
    ("--k 0.8 --u 1e20+i", "--u must be within 2^50 periods = 4.49e+15 of 0, got 1e+20"),
    ("--k 0.8 --u 1 --functions pi --param 1+1e20i", "the imaginary part of param must be within"),
    ("--k 1.5 --functions pi --param 1", "--functions needs --u or --phi"),
    # F and E
    ("--k 0.8 --phi 1 --u 3", "use --phi or --u, not both"),
    ("--k 0.8 --phi 1 --functions sn", "--functions must be one of F, E, Pi, zeta, got 'sn'"),
    ("--k 0.8 --phi 1 --functions Pi", "--n and --functions Pi belong together"),
    ("--k 0.8 --phi 1e30", "--phi must be within 2^50 periods = 2.03e+17 of 0, got 1e+30"),
    ("--k 0.8 --phi K", "--phi must be an angle, without K"),
    ("--k 0.8 --phi 1+i --n 2", "--phi must be real if n is given"),
    ("--k 0.8 --u 1 --n 2", "use --n or --u, not both"),
    # multiples of K
    (
        "--nome -0.999 --u 0.3",
        "--u must be 0, because a period is below all doubles, got 0.3 (with",
    ),
    ("--k 0.3 --u 1e16K", "u in units of K must be within 2^50 periods = 2.25e+15 of 0"),
    ("--k 1 --u K", "--u must not contain K for k = 1, where it is infinite"),
]
ETA = [
    ("--delta 0.2 --delta-star 0.5 --p 0 --q 2", "--delta must be >= --delta-star = 0.5, got 0.2"),
    ("--delta 1 --delta-star 0 --p 0 --q 0.5", "outside the band from delta* to delta, [0.0, 1.0]"),
    ("--delta 1 --delta-star 0 --p 0 --q -2", "--q must be >= 0, or imaginary (0.7i), got -2.0"),
    ("--delta 1 --delta-star 0 --p 0", "--p and --q belong together"),
    ("--delta 1 --delta-star 0 --gap-above 0", "--gap-above must be > 0"),
    ("--delta 1 --delta-star 0 --gap-below 1 --g 0", "--g must be > 0, got 0.0"),
    ("--delta 1 --delta-star 0 --p 0 --q xi", "--q must be a finite number, complex as"),
    ("--delta 1 --delta-star 0 --p 0 --q 1+i", "--q must be >= 0, or imaginary (0.7i), got"),
    ("--delta 1 --delta-star 0 --p 3 --q 2", "makes the period infinite (k1 = 1), got 1.0"),
    ("--delta 1 --delta-star 0 --columns h1", "--columns needs --tau"),
]
REFUSED = [("jacobi", *case) for case in JACOBI] + [("eta", *case) for case in ETA]


@pytest.mark.parametrize(("command", "args", "message"), REFUSED)
def test_bad_input_is_refused_in_a_line(
    command: str, args: str, message: str, lagtop: Lagtop
) -> None:
    result = lagtop(command, *args.split(), "--format", "json")
    assert_one_line(result, 2, "")
    assert message in result.stderr
