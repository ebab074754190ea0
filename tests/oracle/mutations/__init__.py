"""Wrong ports of the single pass, as rows of data, with the truth about each, and right ones written otherwise."""

from tests.oracle.mutations import c_rows, glsl_rows, host_rows, wgsl_rows
from tests.oracle.mutations.correct_rows import VARIANTS

__all__ = ["ROWS", "VARIANTS"]

ROWS = (*c_rows.ROWS, *glsl_rows.ROWS, *wgsl_rows.ROWS, *host_rows.ROWS)
