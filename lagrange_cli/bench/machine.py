"""What a report was made on and with."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def use_one_thread() -> None:
    """Keep linear algebra to one thread, for what has not been imported yet."""
    os.environ.update(dict.fromkeys(_THREADS, "1"))


def warm_allocator() -> None:
    """Let a large array come and go: until then glibc gives freed memory back at once, and to ask
    for it again doubles the time of whatever works on arrays of some thousand numbers."""
    import numpy as np

    np.empty(1 << 21)


def machine() -> str:
    """Processor, system and Python."""
    return f"{_processor()}, {platform.system()} {platform.machine()}"


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            names = [line.partition(":")[2].strip() for line in lines if "model name" in line]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or "unknown processor"


def versions() -> str:
    """Of Python and of all packages that take part."""
    parts = [f"Python {platform.python_version()}"]
    for name in ("lagtop", "numpy", "mpmath", "scipy", "heyoka"):
        try:
            parts.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            parts.append(f"no {name}")
    return ", ".join(parts)
