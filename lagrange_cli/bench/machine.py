"""The machine and the packages that a report was made with."""

from __future__ import annotations

import os
import platform
from importlib.metadata import PackageNotFoundError, version

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def use_one_thread() -> None:
    """Keep the linear algebra of packages that are not imported yet to one thread."""
    os.environ.update(dict.fromkeys(_THREADS, "1"))


def warm_allocator() -> None:
    """Make and free a large array, after which glibc keeps freed memory instead of returning it.

    Asking the system for it again would double the time of work on arrays of some thousand numbers.
    """
    import numpy as np

    np.empty(1 << 21)


def machine() -> str:
    """Return the processor and the system."""
    return f"{_processor()}, {platform.system()} {platform.machine()}"


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            names = [line.partition(":")[2].strip() for line in lines if "model name" in line]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or "unknown processor"


def versions() -> str:
    """Return the versions of Python and of all packages that take part."""
    parts = [f"Python {platform.python_version()}"]
    for name in ("lagtop", "numpy", "mpmath", "scipy", "heyoka"):
        try:
            parts.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            parts.append(f"no {name}")
    return ", ".join(parts)


def common_conditions() -> dict[str, str]:
    """Return the conditions that every report begins with."""
    return {"machine": machine(), "versions": versions()}
