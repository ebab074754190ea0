"""docs/cluster.md agrees with the arithmetic of benchmarks/cluster.py on the recorded measurements."""

import json
import math
import re
import runpy
from pathlib import Path

import pytest

pytestmark = pytest.mark.fast

ROOT = Path(__file__).parents[2]
SCRIPT = runpy.run_path(str(ROOT / "benchmarks" / "cluster.py"))
FOUND = json.loads((ROOT / "benchmarks" / "cluster_measured.json").read_text())
PAGE = (ROOT / "docs" / "cluster.md").read_text()


def block(name):
    return re.search(rf"<!-- {name} -->\n(.*?)\n<!-- end -->", PAGE, flags=re.DOTALL).group(1).strip()


def test_the_page_has_the_tables_that_the_script_prints():
    assert block("measured") == SCRIPT["measured_table"](FOUND)
    assert block("planned") == SCRIPT["plan_table"](SCRIPT["plan"](FOUND))


def test_the_plan_by_hand():
    """3840 x 2160 x 256 rays of 100 ns take 212.3 s; a thousand times that are 59 h."""
    found = {
        "ray_ns": {"a": 50.0, "b": 150.0},
        "method_s": {"a": [1.0, 4.0], "b": [1.0, 2.0]},  # as the pixels, to 64 s at 16 times; as their root, to 8 s
        "scores_s": 1.0,
        "scene_bytes": {"a": 1e6, "b": 3e6},
        "tile_bytes_per_pixel": 50.0,
        "empty_task_s": 0.01,
    }
    plan = SCRIPT["plan"](found)
    assert plan["rays"] == 3840 * 2160 * 256 * 1000 == 2_123_366_400_000
    assert plan["reference_h"] == pytest.approx(58.98, abs=0.01)
    assert plan["method_h"] == pytest.approx(16_000 * 36.0 / 3600)
    assert plan["scores_h"] == pytest.approx(16_000 * 16.0 / 3600)
    assert plan["core_h"] == pytest.approx(58.98 + 160.0 + 71.11, abs=0.01)
    assert plan["wall_h"] == pytest.approx(290.09 / 1600, abs=1e-4)
    assert plan["tasks"] == pytest.approx(212_336.64 / 16 + 16_000, abs=0.01)
    assert plan["client_h"] == pytest.approx(29_271.04 * 0.01 / 3600)
    assert plan["most_workers"] == pytest.approx(100.0)
    assert plan["scene_bytes"] == pytest.approx(1000 * 100 * 2e6)
    assert plan["reference_bytes"] == pytest.approx(1000 * 8_294_400 * 50.0)
    assert plan["reference_s_network"] == pytest.approx(414_720_000 / 125e6)
    assert plan["picture_bytes"] == pytest.approx(16_000 * 8_294_400 * 12)
    assert math.isfinite(SCRIPT["grown"](1.0, 1.0))
