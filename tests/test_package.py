"""The public names of the package, which are imported when they are asked for."""

from __future__ import annotations

import doctest
import os
import re
import subprocess
import sys
import tarfile
import warnings
from pathlib import Path
from zipfile import ZipFile

import lagtop
import numpy as np
import pytest
from conftest import ROOT

import lagrange_cli
from lagrange_cli import errors


def test_a_public_name_is_one_object_at_every_use() -> None:
    code = """
import importlib, pkgutil, lagrange_cli, lagtop
first = {name: getattr(lagrange_cli, name) for name in lagrange_cli.__all__}
for module in pkgutil.iter_modules(lagrange_cli.__path__):
    if module.ispkg:
        importlib.import_module(f"lagrange_cli.{module.name}")
for name, value in first.items():
    assert value is getattr(lagrange_cli, name) is getattr(lagtop, name) is not None, name
"""
    subprocess.run([sys.executable, "-c", code], check=True)


def test_every_error_of_the_package_is_public() -> None:
    made = {x for x in vars(errors).values() if isinstance(x, type) and issubclass(x, Exception)}
    assert {x.__name__ for x in made} - {"SomeFailedError"} <= {*dir(lagtop)}


def test_the_stubs_name_what_is_public() -> None:
    stubs = (ROOT / "lagrange_cli" / "alias.pyi").read_text()
    named = re.findall(r"^from lagrange_cli\.(\S+) import (\w+) as \2$", stubs, re.MULTILINE)
    assert {name: module for module, name in named} == lagrange_cli._MODULES


EXAMPLES = {
    name: getattr(lagtop, name)
    for name in dir(lagtop)
    if name != "__version__" and ">>> " in getattr(lagtop, name).__doc__
}
NAMES = {"np": np, "warnings": warnings, **EXAMPLES}


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_in_docstrings_run(name: str) -> None:
    text = EXAMPLES[name].__doc__
    (test,) = doctest.DocTestFinder(recurse=False).find(EXAMPLES[name], name, globs=dict(NAMES))
    assert test.examples, text
    with warnings.catch_warnings():
        warnings.simplefilter("always", lagtop.MixedBodyWarning)
        assert doctest.DocTestRunner().run(test).failed == 0


def test_only_errors_have_no_example() -> None:
    without = {*dir(lagtop)} - {*EXAMPLES, "__version__", "Outcome"}
    assert all(issubclass(getattr(lagtop, name), Exception | Warning) for name in without)


def test_the_import_alone_loads_nothing_heavy() -> None:
    code = "import sys, lagtop; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    assert not {"numpy", "mpmath", "scipy", "click", "rich"} & set(done.stdout.split())


@pytest.fixture(scope="module")
def distributions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build the sdist, and the wheel from it; unpack the wheel into the folder `site`."""
    folder = tmp_path_factory.mktemp("dist")
    build = [sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT)]
    subprocess.run(build, capture_output=True, check=True)
    (wheel,) = folder.glob("*.whl")
    with ZipFile(wheel) as archive:
        archive.extractall(folder / "site")
    return folder


@pytest.mark.slow
def test_the_wheel_works_in_an_empty_folder(distributions: Path, tmp_path: Path) -> None:
    site = distributions / "site"
    env = os.environ | {"PYTHONPATH": str(site), "PYTHONSAFEPATH": "1"}

    def run(*words: str) -> str:
        command = [sys.executable, *words]
        done = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, check=True)
        return done.stdout.decode()

    assert Path(run("-c", "import lagtop; print(lagtop.__file__)")).is_relative_to(site)
    T = run("-m", "lagrange_cli", "solve", "--theta0", "30", "--get", "T_nutation")
    assert T == "0.4292501244785477\n"
    run("-m", "lagrange_cli", "view", "-o", "page.html")
    assert {path.name for path in tmp_path.iterdir()} == {"page.html"}


@pytest.mark.slow
def test_type_checkers_see_the_names_of_the_wheel(distributions: Path, tmp_path: Path) -> None:
    lines = ["from lagtop import Top, solve", "k: str | None = solve(Top()).path", "Top(mass=3)"]
    (tmp_path / "user.py").write_text("\n".join(lines))
    command = [sys.executable, "-m", "mypy", "--strict", "user.py"]
    env = os.environ | {"MYPYPATH": str(distributions / "site")}
    done = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, check=False)
    said = done.stdout.decode().splitlines()
    found = [x for x in said if x.startswith("user.py") and "note:" not in x]
    assert found == ['user.py:3: error: Unexpected keyword argument "mass" for "Top"  [call-arg]']


@pytest.mark.slow
def test_the_distributions_hold_what_they_should(distributions: Path) -> None:
    site = distributions / "site"
    (metadata,) = site.glob("*.dist-info/METADATA")
    assert "How exact and how fast" in metadata.read_text()
    named = {path.name for path in site.iterdir()} - {metadata.parent.name}
    assert named == {"lagrange_cli", "lagtop.py", "lagtop-stubs"}
    assert {"py.typed", "CITATION.cff"} <= {path.name for path in (site / "lagrange_cli").iterdir()}
    (sdist,) = distributions.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        roots = {name.split("/")[1] for name in archive.getnames() if "/" in name}
    assert roots - {".gitignore", "PKG-INFO", "pyproject.toml"} == {
        *("README.md", "lagrange_cli", "sample_inputs", "tests"),
    }


def test_the_citation_names_the_version() -> None:
    citation = (ROOT / "lagrange_cli" / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {lagtop.__version__}\n" in citation
