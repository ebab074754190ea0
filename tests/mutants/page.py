"""Page: docs/mutants.md and docs/mutants.json, from the results and from the reasons written down for survivors."""

import json
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from refdof.image.atomic import write_text

__all__ = ["counts", "page", "reasons", "write"]

CAUGHT = ("caught", "hang", "crash")
REASONS = Path(__file__).with_name("survivors.toml")
Rows = Sequence[Sequence[dict[str, Any]]]  # of each fault its results, the first one first

_HEAD = """# Planted faults

Tests that pass say little until they have been seen to fail. `make mutants` plants single-line faults in a copy of the
code, one at a time: operators and comparisons swapped, constants changed, minus signs, `abs` and square roots dropped,
minima and maxima exchanged, indices and ranges off by one, arguments swapped, statements removed. They are drawn with
the seed {seed} from all lines of optics, raster, methods, metrics, oracle and truth, at most one a function. Lines of
which only speed depends (sizes of blocks, numbers of threads) are left out, and so are words and types.

For each fault the fast tests that call its function are run, interpreted; what survives them meets the compiled tests
of its folder. It counts as caught if a test fails, if a test takes more than four times its processor time and ten
seconds, or if the package cannot be imported.

{summary}

## By room

*At first* is before tests were added for survivors: what the fast tests caught, and compiled ones where they were
tried. It is the rate to expect of other faults; the last one is of faults that tests were then written for. *No change*
are faults that change no result, or none that is promised.

{table}

## Survivors

{survivors}

## Run it again

```
make mutants                                   # goes on where it was stopped; results in build/mutants/
.venv/bin/python -m tests.mutants.run --again  # survivors once more, after new tests
```

Which test calls what is noted once, in build/mutants/seen.json: remove it when tests change. Every fault, with the test
that caught it, is in [mutants.json](mutants.json). When code changes, the seed draws other faults: the numbers above
belong to the lines in that file.
"""


def reasons() -> dict[str, dict[str, Any]]:
    """Why faults survive, by their names."""
    given = tomllib.loads(REASONS.read_text(encoding="utf-8")).get("survivor", [])
    return {entry["name"]: entry for entry in given}


def counts(rows: Rows, why: dict[str, dict[str, Any]]) -> dict[str, dict[str, int]]:
    """Of each room, and of "all": planted, caught at first, caught, and of the others those that change nothing."""
    table: dict[str, dict[str, int]] = {}
    for results in rows:
        first, last = results[0], results[-1]
        caught = last["outcome"] in CAUGHT
        same = not caught and why.get(last["name"], {}).get("equivalent", False)
        for room in (first["room"], "all"):
            row = table.setdefault(room, dict.fromkeys(("planted", "first", "caught", "equivalent"), 0))
            row["planted"] += 1
            row["first"] += first["outcome"] in CAUGHT
            row["caught"] += caught
            row["equivalent"] += same
    table["all"] = table.pop("all", dict.fromkeys(("planted", "first", "caught", "equivalent"), 0))
    return table


def page(rows: Rows, why: dict[str, dict[str, Any]], seed: int) -> str:
    """The text of docs/mutants.md."""
    table = counts(rows, why)
    lines = [
        "| room | planted | caught at first | caught | no change | others |",
        "|---|--:|--:|--:|--:|--:|",
    ]
    for room, row in table.items():
        others = row["planted"] - row["caught"] - row["equivalent"]
        lines.append(
            f"| {room} | {row['planted']} | {row['first']} | {row['caught']} | {row['equivalent']} | {others} |"
        )
    whole = table["all"]
    counted = whole["planted"] - whole["equivalent"]
    summary = (
        f"{whole['caught']} of {whole['planted']} faults are caught, {whole['caught'] / max(whole['planted'], 1):.1%}; "
        f"without the {whole['equivalent']} that change no result, {whole['caught'] / max(counted, 1):.1%}. "
        f"Before tests were added it was {whole['first'] / max(whole['planted'], 1):.1%}."
    )
    survivors = []
    for results in rows:
        last = results[-1]
        if last["outcome"] in CAUGHT:
            continue
        reason = why.get(last["name"], {}).get("reason", "no reason is known yet")
        survivors.append(
            f"- `{last['path']}:{last['line']}`, {last['kind']}: `{last['line_before']}` became "
            f"`{last['line_after']}`. {reason}"
        )
    return _HEAD.format(
        seed=seed, summary=summary, table="\n".join(lines), survivors="\n".join(survivors) or "There are none."
    )


def write(docs: Path, rows: Rows, seed: int) -> None:
    """Write both files."""
    write_text(docs / "mutants.md", page(rows, reasons(), seed))
    kept = ("name", "room", "function", "kind", "line_before", "line_after", "outcome", "stage", "test")
    faults = [{**{key: results[-1][key] for key in kept}, "at_first": results[0]["outcome"]} for results in rows]
    write_text(docs / "mutants.json", json.dumps({"seed": seed, "faults": faults}, indent=1) + "\n")
