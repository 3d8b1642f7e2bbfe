"""The public names of the package, which are imported when they are asked for."""

from __future__ import annotations

import subprocess
import sys

import pytest

import lagrange_cli


@pytest.mark.parametrize("name", dir(lagrange_cli))
def test_every_public_name_is_there(name: str) -> None:
    assert getattr(lagrange_cli, name) is not None


def test_an_unknown_name_is_no_attribute() -> None:
    with pytest.raises(AttributeError, match="module 'lagrange_cli' has no attribute 'nothing'"):
        _ = lagrange_cli.nothing
    with pytest.raises(ImportError):
        exec("from lagrange_cli import nothing")


def test_the_import_alone_loads_nothing_heavy() -> None:
    code = "import sys, lagrange_cli; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    assert not {"numpy", "mpmath", "scipy", "click", "rich"} & set(done.stdout.split())
