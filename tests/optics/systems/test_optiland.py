"""The stored rays and spots of optiland, made again: whoever doubts them can see them come.

optiland and what it needs take 1.3 GB, so it is in an extra of its own. Set REFDOF_REQUIRE_OPTILAND=1 to fail where it
is missing.
"""

import importlib.util
import os
import warnings
from pathlib import Path

import numpy as np
import pytest

REQUIRED = os.environ.get("REFDOF_REQUIRE_OPTILAND") == "1"


@pytest.mark.skipif(
    not REQUIRED and importlib.util.find_spec("optiland") is None, reason="needs the extra `optiland`, of 1.3 GB"
)
def test_optiland_still_says_what_is_stored():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # its own, and those of what it needs
        from tests.optics.systems.make_optiland_rays import made

        found = made()
    with np.load(Path(__file__).with_name("optiland_rays.npz")) as stored:
        assert set(stored.files) == set(found)
        for name in stored.files:
            # The same formulas in float64: machines may differ by roundings of numbers of some 100 mm.
            np.testing.assert_allclose(found[name], stored[name], rtol=1e-11, atol=1e-11, err_msg=name)
