"""The scorecard as text: for a terminal, and as the page docs/claims.md."""

import textwrap
from collections import Counter
from collections.abc import Sequence

from refdof.claims.scorecard import Row, kind_of
from refdof.claims.statement import SOURCES
from refdof.claims.verdict import NOT_TESTABLE, REFUTED, VERDICTS

__all__ = ["markdown_page", "summary_rows", "terminal_text"]

_WIDTH = 100
_INTRO = """\
# Are the papers' claims true?

<!-- Made by `python benchmarks/claims.py`; edit data/claims.toml and refdof/claims/. -->

`refdof claims` holds {count} statements of the five sources against measurements: what is printed, what is measured
here, and the verdict. A verdict follows from the measured figure as it is shown, by the rule that stands beside it;
nobody writes it. `refdof claims --source lee2010` or `--only lensblur-psnr,mipmap-reads` runs some of them, `--json`
prints every part.

- **reproduced**: our figure lies in the stated bounds around the printed one.
- **direction reproduced**: the sign or the order is right, the size is not.
- **refuted**: neither. Where the source's own arithmetic is wrong, the right figure stands under *ours*.
- **not testable on a CPU**: said with the reason.

{summary}
Methods run with the parameters of their papers. What was misprinted there, and what a paper says it did not run, is put
right: see `AS_RUN` in `refdof/claims/bench.py`. `pyramidal`, `poisson`, `separable` and `scatter` are reconstructions,
so that a verdict on them does not speak for the originals. Scenes are our own, made after the papers' figures.

Times are compared as ratios only: medians of warm runs that are made in turn, so that what else a machine does slows
both. They are recorded, on {machine}; the tests check that each of these verdicts follows from its recorded figure, and
measure all other figures anew.
"""


def summary_rows(rows: Sequence[Row]) -> list[list[str]]:
    """A head, a row of counts for each source that has claims here, and one of all."""
    body = []
    for source, title in SOURCES.items():
        counts = Counter(row.verdict for row in rows if row.claim.source == source)
        if counts:
            body.append([title, *(str(counts[verdict]) for verdict in VERDICTS), str(counts.total())])
    counts = Counter(row.verdict for row in rows)
    body.append(["all", *(str(counts[verdict]) for verdict in VERDICTS), str(len(rows))])
    return [["source", *VERDICTS, "claims"], *body]


def terminal_text(rows: Sequence[Row]) -> str:
    """Claims by source with their verdicts, and the counts last."""
    lines = []
    for source, title in SOURCES.items():
        mine = [row for row in rows if row.claim.source == source]
        if mine:
            lines += [title, ""]
        for row in mine:
            claim = row.claim
            lines.append(f"{row.verdict.upper()}  {claim.name}  ({claim.place})")
            ours = f"Ours: {_with_setting(row)}. " if row.figure is not None else ""
            lines += textwrap.wrap(
                f"{claim.says} Printed: {claim.printed}. {ours}{row.why}",
                _WIDTH,
                initial_indent="    ",
                subsequent_indent="    ",
            )
        if mine:
            lines.append("")
    table = summary_rows(rows)
    widths = [max(len(row[k]) for row in table) for k in range(len(table[0]))]
    for row_cells in table:
        first, *others = zip(row_cells, widths, strict=True)
        lines.append("  ".join([first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in others)]))
    return "\n".join(lines)


def markdown_page(rows: Sequence[Row], machine: str) -> str:
    """The page: counts, what was learned, a table for each source; times are of `machine`. Ends with a line feed."""
    head, *body = summary_rows(rows)
    summary = _table(head, body, "-" + "r" * len(VERDICTS) + "r")
    parts = [_INTRO.format(count=len(rows), summary=summary, machine=machine), _learned(rows)]
    for source, title in SOURCES.items():
        mine = [row for row in rows if row.claim.source == source]
        if mine:
            parts.append(
                f"## {title}\n\n" + _table(["claim", "printed", "ours", "verdict"], [_cells(row) for row in mine])
            )
    return "\n".join(parts)


def _learned(rows: Sequence[Row]) -> str:
    """What was learned: refuted claims first, one by one."""
    refuted = [row for row in rows if row.verdict == REFUTED]
    counts = Counter(kind_of(row.claim) for row in refuted)
    tested = sum(row.verdict != NOT_TESTABLE for row in rows)
    lines = [
        "## What was learned",
        "",
        f"Of {tested} claims that a CPU can test, {len(refuted)} are refuted: {counts['formula']} by arithmetic alone, "
        f"{counts['picture']} by pictures, {counts['time']} by times on a CPU, which need not be those of a GPU.",
        "",
    ]
    for row in sorted(refuted, key=lambda row: ("formula", "picture", "time").index(kind_of(row.claim))):
        claim, authors = row.claim, SOURCES[row.claim.source].rsplit(",", 1)[0]
        lines.append(
            f"- {authors}, {claim.place}: *{claim.says}* Printed: {claim.printed}; ours: {row.ours}. {row.why}"
        )
    return "\n".join(lines) + "\n"


def _cells(row: Row) -> list[str]:
    claim = row.claim
    rule = f"<br>*{claim.rule.in_words()}: {claim.tolerance}*" if row.figure is not None else ""
    return [
        f"`{claim.name}`<br>{claim.place}<br>{claim.says}",
        claim.printed,
        _with_setting(row, "<br>"),
        f"**{row.verdict}**<br>{row.why}{rule}",
    ]


def _with_setting(row: Row, between: str = "; ") -> str:
    return between.join(filter(None, (row.ours, row.claim.setting)))


def _table(head: Sequence[str], body: Sequence[Sequence[str]], sides: str = "") -> str:
    """A table of Markdown; `sides` has r for a column of numbers."""
    rule = ["---:" if k < len(sides) and sides[k] == "r" else "---" for k in range(len(head))]
    lines = [head, rule, *([cell.replace("|", r"\|") for cell in cells] for cells in body)]
    return "".join("| " + " | ".join(cells) + " |\n" for cells in lines)
