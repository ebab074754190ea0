"""Run every wrong port of the mutation tests and put the table of what came of them between the markers of a page.

Usage: mutation_table.py. Takes some minutes; needs `cc`, and Mesa's llvmpipe and lavapipe.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

from tests.oracle.mutations import ROWS  # noqa: E402
from tests.oracle.mutations.runs import results_of  # noqa: E402
from tests.oracle.mutations.table import summary, table  # noqa: E402

START, END = "<!-- mutations -->", "<!-- end -->"

if __name__ == "__main__":  # processes that it starts import it
    results = []
    for result in results_of(ROWS):
        results.append(result)
        row = result.row
        print(f"{len(results)}/{len(ROWS)} {row.port}: {row.name}: {result.stage} {result.cause}", flush=True)
    page = ROOT / "docs" / "porting.md"
    before, _, rest = page.read_text(encoding="utf-8").partition(START)
    _, _, after = rest.partition(END)
    page.write_text(f"{before}{START}\n\n{summary(results)}\n\n{table(results)}\n\n{END}{after}", encoding="utf-8")
    print(summary(results))
