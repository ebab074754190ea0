"""Diagnosis, tested by mutation: most wrong ports are blamed on the right stage, with the right cause named first.

Every sixteenth row, since all of them take minutes: `.ci/mutation_table.py` runs those, and writes the table of
docs/porting.md.
"""

import pytest

from tests.oracle.mutations import ROWS
from tests.oracle.mutations.needs import need_all
from tests.oracle.mutations.runs import results_of
from tests.oracle.mutations.table import shares, table

SOME = [row for row in ROWS if row.cause != "error"][::16]


@pytest.mark.gl
def test_most_wrong_ports_are_told_what_is_wrong(tmp_path):
    need_all(tmp_path)
    results = list(results_of(SOME))
    stage, cause = shares(results)
    print(table(results))
    assert stage >= 0.9
    assert cause >= 0.7
