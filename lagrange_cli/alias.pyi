"""Installed as `lagtop-stubs`: the public names of `lagtop` for type checkers."""

from lagrange_cli.account.spread import sensitivities as sensitivities
from lagrange_cli.comparison.compare import Comparison as Comparison
from lagrange_cli.comparison.compare import compare as compare
from lagrange_cli.errors import AbsentError as AbsentError
from lagrange_cli.errors import CannotWriteError as CannotWriteError
from lagrange_cli.errors import DataError as DataError
from lagrange_cli.errors import LagtopError as LagtopError
from lagrange_cli.errors import MixedBodyWarning as MixedBodyWarning
from lagrange_cli.errors import OutOfRangeError as OutOfRangeError
from lagrange_cli.errors import OutOfRangeWarning as OutOfRangeWarning
from lagrange_cli.errors import SceneError as SceneError
from lagrange_cli.errors import UnavailableError as UnavailableError
from lagrange_cli.inverse.fit import fit as fit
from lagrange_cli.inverse.outcome import Outcome as Outcome
from lagrange_cli.plot import draw as draw
from lagrange_cli.plot import draw_outcome as draw_outcome
from lagrange_cli.plot.browser.view import view as view
from lagrange_cli.solver.facts import Regime as Regime
from lagrange_cli.solver.solve import Motion as Motion
from lagrange_cli.solver.solve import solve as solve
from lagrange_cli.sweeps.find import find as find
from lagrange_cli.sweeps.records import sweep as sweep
from lagrange_cli.sweeps.results import Results as Results
from lagrange_cli.top.given import read_scene as read_scene
from lagrange_cli.top.top import Top as Top

__version__: str
