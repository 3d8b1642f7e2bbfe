"""`import lagtop` is `import lagrange_cli`: the build installs this file as `lagtop.py`."""

import sys

import lagrange_cli

sys.modules[__name__] = lagrange_cli
