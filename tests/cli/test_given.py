"""Words among others that name a scene."""

from __future__ import annotations

import pytest

from lagrange_cli.cli.top_options import is_scene


@pytest.mark.parametrize("word", ["-", "top.toml", "folder/scene", "./scene", "x.txt", "a.b/c"])
def test_words_that_name_a_scene(word: str) -> None:
    assert is_scene(word)


@pytest.mark.parametrize("word", ["sphere", "T_nutation=0.5", "r0<1.5", "K>./2", "", "map"])
def test_words_that_do_not(word: str) -> None:
    assert not is_scene(word)
