"""`lagtop jacobi` of complex numbers, and of a modulus that is imaginary or above 1."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..arithmetic.exact_complex import ExactComplex
from ..errors import LagtopError
from ..output.layouts import JACOBI, in_parts
from ..output.write import write_record, write_table
from .options import exclude
from .progress import with_progress

if TYPE_CHECKING:
    from ..elliptic.complex_request import ComplexPoints
    from ..elliptic.modulus_input import ModulusInput
    from ..inputs.multiples import Multiple, Multiples

    Asked = tuple[ModulusInput | ExactComplex, tuple[str, ...], ExactComplex, bool]


def all_real(arguments: tuple[Multiple | ExactComplex, ...], parameter: ExactComplex) -> bool:
    """Return whether arguments are real, and a parameter real or imaginary."""
    return not (
        any(isinstance(u, ExactComplex) for u in arguments) or (parameter.real and parameter.imag)
    )


def complex_points(
    single: tuple[Multiple | ExactComplex, ...], grid: Multiples | None
) -> ComplexPoints | None:
    """Return complex arguments, if any.  Raises LagtopError for multiples of K."""
    from ..arithmetic.points import ListedPoints
    from ..elliptic.complex_request import ComplexPoints

    exclude({"--u": single or None, "--u-range": grid})
    multiples = [grid] if grid else [u for u in single if not isinstance(u, ExactComplex)]
    if any(u.in_quarters for u in multiples):
        raise LagtopError(
            "--u must be without K beside complex numbers, and where --k is not in [0, 1]"
        )
    if grid:
        return ComplexPoints(grid.factors)
    if not single:
        return None
    numbers = [u if isinstance(u, ExactComplex) else ExactComplex(u.factor) for u in single]
    imag = [u.imag for u in numbers]
    return ComplexPoints(
        ListedPoints([u.real for u in numbers]), ListedPoints(imag) if any(imag) else None
    )


def write_complex(
    points: ComplexPoints | None, asked: Asked, digits: int | None, destination: tuple[str, str]
) -> None:
    """Write the functions at these points, or the constants of the modulus."""
    from ..elliptic import complex_table as tables
    from ..elliptic.any_modulus import check_any_modulus
    from ..elliptic.complex_request import ComplexRequest

    k = asked[0]
    if isinstance(k, ExactComplex):
        check_any_modulus(k)
        if points is None:
            record = tables.any_constants_record(k, digits)
            write_record(record, *destination, lambda: in_parts(JACOBI, record))
            return
    assert points is not None
    request, count = ComplexRequest(*asked), points.real.count
    if digits is None:
        header, blocks = tables.complex_rows(points, request)
        write_table(header, with_progress(blocks, count, 100_000), *destination)
    else:
        header, lines = tables.complex_digit_rows(points, request, digits)
        texts = with_progress(([line] for line in lines), count, 300)
        write_table(header, texts, *destination)
