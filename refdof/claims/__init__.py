"""Claims: statements of the five sources, held against measurements.

1. read the statements of data/claims.toml                `refdof.claims.statement`
2. measure each                                           `refdof.claims.measures`
3. judge the figure by the claim's rule                   `refdof.claims.verdict`
4. put all together, and print it                         `refdof.claims.scorecard`, `refdof.claims.page`
"""

from refdof.claims.page import markdown_page, summary_rows, terminal_text
from refdof.claims.scorecard import Row, kind_of, row_of, scorecard
from refdof.claims.statement import SOURCES, Claim, claims
from refdof.claims.verdict import VERDICTS, Rule, verdict_of

__all__ = [
    "SOURCES",
    "VERDICTS",
    "Claim",
    "Row",
    "Rule",
    "claims",
    "kind_of",
    "markdown_page",
    "row_of",
    "scorecard",
    "summary_rows",
    "terminal_text",
    "verdict_of",
]
