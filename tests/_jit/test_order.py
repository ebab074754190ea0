"""The order of rows: each once, and every thread's run of them spread over the picture."""

import numpy as np
import pytest

from refdof._jit.order import fair_step

pytestmark = pytest.mark.fast


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5, 6, 12, 23, 64, 90, 720, 1080])
def test_each_row_comes_once(count):
    assert sorted(k * fair_step(count) % count for k in range(count)) == list(range(count))


@pytest.mark.parametrize("threads", [2, 3, 4, 8])
@pytest.mark.parametrize("count", [23, 45, 90, 135, 720])
def test_threads_have_as_much_to_do_where_work_grows_downwards(count, threads):
    order = np.arange(count) * fair_step(count) % count
    work, alone = (
        np.array([(run + 0.5).sum() for run in np.array_split(rows, threads)]) for rows in (order, np.arange(count))
    )
    # A run has n = count / threads rows, or one more, and the mean of n steps of the golden section is off by 3 / n at
    # most. Of runs of neighbours the last one has up to 2 - 1 / threads shares.
    assert work.max() / work.mean() < 1.0 + 4.0 * threads / count
    assert alone.max() / alone.mean() > 1.4
