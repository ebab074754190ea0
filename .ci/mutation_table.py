"""Run every wrong port of the mutation tests and put the table of what came of them between the markers of a page.

Usage: mutation_table.py, from the root of the repository. Needs `cc` and Mesa's llvmpipe.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

from tests.gl.shader import open_context  # noqa: E402
from tests.oracle.mutations import ROWS  # noqa: E402
from tests.oracle.mutations.runs import Bench  # noqa: E402
from tests.oracle.mutations.table import summary, table  # noqa: E402

START, END = "<!-- mutations -->", "<!-- end -->"

with Bench(open_context()) as bench:
    results = []
    for row in ROWS:
        results.append(bench.result_of(row))
        print(f"{len(results)}/{len(ROWS)} {row.port}: {row.name}: {results[-1].stage} {results[-1].cause}", flush=True)

page = ROOT / "docs" / "porting.md"
before, _, rest = page.read_text(encoding="utf-8").partition(START)
_, _, after = rest.partition(END)
page.write_text(f"{before}{START}\n\n{summary(results)}\n\n{table(results)}\n\n{END}{after}", encoding="utf-8")
print(summary(results))
