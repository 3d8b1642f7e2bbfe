"""Signals end a command without a traceback and without temporary files."""

from __future__ import annotations

import signal
import subprocess
import time
from pathlib import Path

import pytest
from conftest import LAGTOP


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGQUIT"), reason="signals of POSIX")
@pytest.mark.parametrize("names", ["SIGQUIT", "SIGINT SIGINT SIGINT", "SIGTERM SIGINT", "SIGHUP"])
def test_no_temporary_file_stays(names: str, tmp_path: Path) -> None:
    words = [*LAGTOP, *"sweep --r0 1:100:3e6 --psidot0 1 -o a.csv".split()]
    with subprocess.Popen(
        words, cwd=tmp_path, stderr=subprocess.PIPE, preexec_fn=restore_signals
    ) as process:
        deadline = time.monotonic() + 60
        while not list(tmp_path.glob(".lagtop-*")) and time.monotonic() < deadline:
            time.sleep(0.01)
        for name in names.split():
            process.send_signal(signal.Signals[name])
            time.sleep(0.02)
        _, said = process.communicate(timeout=60)
    assert list(tmp_path.iterdir()) == []
    assert b"Traceback" not in said
    first = signal.Signals[names.split()[0]]
    assert process.returncode in {-first, 128 + first}


def restore_signals() -> None:
    """Let a child be interrupted, even if the tests run in the background."""
    for name in ("SIGINT", "SIGQUIT", "SIGHUP", "SIGTERM"):
        signal.signal(getattr(signal, name), signal.SIG_DFL)
