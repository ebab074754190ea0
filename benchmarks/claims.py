"""Make docs/claims.md anew, with docs/claims.json, the figures that it rests on.

1. measure every claim, or with --keep-times all but those of times      `refdof.claims.scorecard`
2. write the figures as they are shown, and the machine of the times     docs/claims.json
3. write the page                                                       `refdof.claims.page`

Run it on a machine that does nothing else, from the root of the repository: ``python benchmarks/claims.py``.
"""

import argparse
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from refdof._jit import thread_count
from refdof.claims import claims, kind_of, markdown_page, row_of, scorecard
from refdof.machine import processor

DOCS = Path(__file__).resolve().parents[1] / "docs"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--keep-times", action="store_true", help="do not measure times again")
    words = parser.parse_args()
    results = DOCS / "claims.json"
    kept: dict[str, Any] = {"machine": f"{processor()}, {thread_count()} threads", "figures": {}}
    if words.keep_times:
        kept = json.loads(results.read_text())
    chosen = claims()
    timed = [claim for claim in chosen if kind_of(claim) == "time"] if words.keep_times else []

    def tell(what: str, done: int, count: int) -> None:
        print(f"\r{done}/{count} {what[:70]:70}", end="", file=sys.stderr, flush=True)

    found = {row.claim.name: row for row in scorecard([claim for claim in chosen if claim not in timed], tell)}
    found |= {claim.name: row_of(claim, kept["figures"][claim.name]) for claim in timed}
    rows = [found[claim.name] for claim in chosen]
    figures = {
        row.claim.name: dict(row.figure) if isinstance(row.figure, Mapping) else row.figure
        for row in rows
        if row.figure is not None
    }
    results.write_text(json.dumps({"machine": kept["machine"], "figures": figures}, indent=1) + "\n")
    (DOCS / "claims.md").write_text(markdown_page(rows, kept["machine"]), encoding="utf-8")
    print(f"\n{sum(row.verdict == 'refuted' for row in rows)} of {len(rows)} refuted", file=sys.stderr)


if __name__ == "__main__":
    main()
