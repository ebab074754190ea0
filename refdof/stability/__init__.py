"""Stability: every method at the numerical extremes.

1. make extreme pictures and scenes                        `refdof.stability.cases`
2. run a method on each, in float32 and in float64         `refdof.stability.run`, `refdof.stability.twins`
3. measure what must hold                                  `refdof.stability.checks`
4. judge the figures by their bounds                       `refdof.stability.verdict`, `refdof.stability.degraded`
5. put all cells together, and show them                   `refdof.stability.matrix`, `refdof.stability.page`
"""

from refdof.stability.cases import CASES, Case
from refdof.stability.matrix import cell_of, matrix
from refdof.stability.page import as_json, counts_of, html_page, markdown_section, terminal_text
from refdof.stability.verdict import VERDICTS, Cell, Figure, verdict_of

__all__ = [
    "CASES",
    "VERDICTS",
    "Case",
    "Cell",
    "Figure",
    "as_json",
    "cell_of",
    "counts_of",
    "html_page",
    "markdown_section",
    "matrix",
    "terminal_text",
    "verdict_of",
]
