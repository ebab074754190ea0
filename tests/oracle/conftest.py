"""A small pack that the tests of the check share."""

import shutil

import pytest

from tests.oracle.small_pack import CASES
from tests.packs import pack_of


@pytest.fixture(scope="session")
def pack(tmp_path_factory):
    """A pack of three small cases."""
    return pack_of(CASES, tmp_path_factory.mktemp("oracle") / "pack")


@pytest.fixture
def copied(pack, tmp_path):
    """A copy of the pack that a test may spoil."""
    return shutil.copytree(pack, tmp_path / "pack")
