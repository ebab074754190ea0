"""The checker, tested by mutation: no wrong port passes, no right one fails, and most are told what is wrong.

Wrong ports are rows of `tests.oracle.mutations`. Their truth was written down from what each change does.
REFDOF_REQUIRE_CC=1 and REFDOF_REQUIRE_GL=1 make a missing compiler or OpenGL a failure.
"""

import os
import shutil

import pytest

from tests.gl.shader import GLMissing, open_context
from tests.oracle.mutations import ROWS, VARIANTS
from tests.oracle.mutations.row import mutated
from tests.oracle.mutations.runs import checked, source_of, write_small_pack


@pytest.fixture(scope="module")
def pack(tmp_path_factory):
    return write_small_pack(tmp_path_factory.mktemp("mutations") / "pack")


def needed(variable, reason):
    """Skip, or fail where CI requires what is missing."""
    if os.environ.get(variable) == "1":
        pytest.fail(f"{variable} is set, but {reason}", pytrace=False)
    pytest.skip(reason)


@pytest.fixture(scope="module")
def context():
    if shutil.which("cc") is None:
        needed("REFDOF_REQUIRE_CC", "no C compiler: there is no `cc`")
    try:
        opened = open_context()
    except GLMissing as missing:
        needed("REFDOF_REQUIRE_GL", str(missing))
    yield opened
    opened.release()


def test_every_change_is_one_and_every_name_another():
    for row in ROWS:
        assert row.text != mutated(row.port)
    for variant in VARIANTS:
        assert (variant.text != mutated(variant.port)) == bool(variant.changes)
    for rows in (ROWS, VARIANTS):
        assert len({(row.port, row.name) for row in rows}) == len(rows)
    assert len(ROWS) >= 75


@pytest.mark.gl
@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.port}: {row.name}")
def test_a_wrong_port_does_not_pass(row, context, pack, tmp_path):
    report = checked(source_of(row.port, row.text, tmp_path, context), pack)
    print(report.outcomes)
    assert not report.passed


@pytest.mark.gl
@pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: f"{variant.port}: {variant.name}")
def test_a_right_port_passes(variant, context, pack, tmp_path):
    report = checked(source_of(variant.port, variant.text, tmp_path, context), pack)
    assert {outcome.status for outcome in report.outcomes} == {"pass"}, report.outcomes
