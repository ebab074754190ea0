"""A small pack that the tests of the check share."""

import shutil

import pytest

from refdof.oracle import write_pack
from tests.oracle.small_pack import CASES


@pytest.fixture(scope="session")
def pack(tmp_path_factory):
    """A pack of three small cases."""
    folder = tmp_path_factory.mktemp("oracle") / "pack"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("refdof.oracle.pack.cases_of", lambda level, methods: CASES)
        write_pack(folder)
    return folder


@pytest.fixture
def copied(pack, tmp_path):
    """A copy of the pack that a test may spoil."""
    return shutil.copytree(pack, tmp_path / "pack")
