"""Results on the disk."""

import csv
import math
import os
import subprocess
import sys
from dataclasses import replace

import duckdb
import pytest

from refdof import InputError
from refdof.sweep import Results
from tests.sweep.points import SCORES, point

ODD = replace(
    point("odd", psnr=math.inf, floor=math.inf),
    scene="söme 'scene', \"quoted\"",
    params={"samples": 16, "limit": "inf", "none": None, "flag": True, "pair": [0.5, 1]},
    varied={},
    peak_bytes=math.nan,
    focus=math.inf,
    artefacts={"leak": 0.5, "none": math.nan},
)


def same(a, b):
    """Equal, where NaN equals NaN."""
    return repr(a) == repr(b)


def test_points_come_back(tmp_path):
    points = [point("b"), point("a", 0.2, 20.0), ODD]
    with Results(tmp_path / "new" / "sweep.duckdb") as results:
        assert results.keys() == set()
        for one in points:
            results.add(one)
    with Results(tmp_path / "new" / "sweep.duckdb") as results:
        assert results.keys() == {"a", "b", "odd"}
        for found, wanted in zip(results.points(), points, strict=True):
            assert same(found, wanted)
        assert [one.key for one in results.points(["odd", "nobody", "b"])] == ["odd", "b"]
        results.add(point("b", 9.0))
        assert [one.time_s for one in results.points(["b"])] == [9.0]
        assert len(results.points()) == 3


def test_export(tmp_path):
    with Results(tmp_path / "sweep.duckdb") as results:
        results.add(point("a"))
        results.add(ODD)
        results.export(tmp_path)
    with (tmp_path / "sweep.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["key"] for row in rows] == ["a", "odd"]
    assert float(rows[0]["psnr"]) == 30.0
    assert rows[1]["scene"] == ODD.scene
    assert set(SCORES) < set(rows[0])
    found = duckdb.sql(f"SELECT key, rmse FROM '{tmp_path}/sweep.parquet'").fetchall()
    assert found == [("a", 0.02), ("odd", 0.02)]
    assert not list(tmp_path.glob(".refdof-*"))


def test_a_damaged_file_is_put_aside(tmp_path, capsys):
    file = tmp_path / "sweep.duckdb"
    for content in (b"garbage" * 3000, b""):
        file.write_bytes(content)
        with Results(file) as results:
            results.add(point("a"))
        assert "sweep.duckdb is damaged: it is kept as sweep.damaged" in capsys.readouterr().err
        file.unlink()
    assert (tmp_path / "sweep.damaged.duckdb").read_bytes() == b"garbage" * 3000
    assert (tmp_path / "sweep.damaged-2.duckdb").read_bytes() == b""


def test_overwritten_blocks_are_found(tmp_path, capsys):
    file = tmp_path / "sweep.duckdb"
    with Results(file) as results:
        for k in range(50):
            results.add(point(str(k)))
    data = bytearray(file.read_bytes())
    data[8192:] = bytes(len(data) - 8192)
    file.write_bytes(data)
    with Results(file) as results:
        assert results.keys() == set()
    assert "is damaged" in capsys.readouterr().err


def test_a_file_of_another_version_is_kept(tmp_path, capsys):
    file = tmp_path / "sweep.duckdb"
    with duckdb.connect(file) as base:
        base.execute("CREATE TABLE points (key VARCHAR, measured_at VARCHAR)")
        base.execute("INSERT INTO points VALUES ('a', 'b')")
    with Results(file) as results:
        assert results.keys() == set()
    assert "is of another version of refdof: it is kept as sweep.older.duckdb" in capsys.readouterr().err
    with duckdb.connect(tmp_path / "sweep.older.duckdb") as base:
        assert base.execute("SELECT key FROM points").fetchall() == [("a",)]


def test_two_sweeps_in_one_folder(tmp_path):
    code = "import sys; from refdof.sweep import Results\nwith Results(sys.argv[1]): print('open', flush=True); input()"
    with subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path / "sweep.duckdb")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as other:
        assert other.stdout.readline() == "open\n"
        with pytest.raises(InputError, match=r"out: got '.*sweep\.duckdb', which another sweep writes to; allowed is"):
            Results(tmp_path / "sweep.duckdb")
        other.communicate("\n")
    with Results(tmp_path / "sweep.duckdb") as results:
        assert results.keys() == set()


def test_a_folder_in_its_place(tmp_path):
    (tmp_path / "sweep.duckdb").mkdir()
    with pytest.raises(InputError, match="out: cannot write"):
        Results(tmp_path / "sweep.duckdb")
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="out: "):
        Results(tmp_path / "file" / "sweep.duckdb")


FULL = """
import resource, signal, sys
from refdof.sweep import Results
from refdof import InputError
from tests.sweep.points import point
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
with Results(sys.argv[1]) as results:
    results.add(point("before"))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 15, 1 << 15))
    try:
        for k in range(2000):
            results.add(point(str(k)))
    except InputError as error:
        print(error)
"""


def test_a_full_disk(tmp_path):
    """A limit on the size of files stands for it: writing fails in the same place."""
    file = tmp_path / "sweep.duckdb"
    run = subprocess.run([sys.executable, "-c", FULL, str(file)], capture_output=True, text=True, timeout=120)
    assert "out: cannot write" in run.stdout, run.stderr
    assert "the points before are kept" in run.stdout
    assert len(run.stdout.splitlines()) == 1
    with Results(file) as results:
        assert "before" in results.keys()  # noqa: SIM118  a method, not a dict's


def test_no_file_is_made_elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with Results("sweep.duckdb") as results:
        results.add(point("a"))
    assert sorted(os.listdir(tmp_path)) == ["sweep.duckdb"]
