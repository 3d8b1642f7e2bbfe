"""Installed as `lagtop-stubs`: the public names of `lagtop` for type checkers."""

from lagrange_cli.compare.compare import Comparison as Comparison
from lagrange_cli.compare.compare import compare as compare
from lagrange_cli.errors import LagtopError as LagtopError
from lagrange_cli.errors import MixedBodyWarning as MixedBodyWarning
from lagrange_cli.find import find as find
from lagrange_cli.fit.fit import fit as fit
from lagrange_cli.inputs.given import read_scene as read_scene
from lagrange_cli.inputs.top import Top as Top
from lagrange_cli.motion.derivatives import sensitivities as sensitivities
from lagrange_cli.motion.regime import Regime as Regime
from lagrange_cli.motion.solve import Motion as Motion
from lagrange_cli.motion.solve import solve as solve
from lagrange_cli.plot import draw as draw
from lagrange_cli.plot.browser.view import view as view
from lagrange_cli.plot.reports import draw_outcome as draw_outcome
from lagrange_cli.sweep.records import sweep as sweep

__version__: str
