"""The command `refdof claims`: its text, its JSON, and one line for bad input."""

import json

import pytest
from typer.testing import CliRunner

from refdof.claims import SOURCES
from refdof.cli import app
from tests.one_line import refused

pytestmark = pytest.mark.fast


def claims(*words):
    done = CliRunner().invoke(app, ["claims", *words])
    assert done.exit_code == 0, done.exception
    return done.stdout


def in_a_line(text):
    return " ".join(text.split())


def test_some_claims_in_words():
    text = claims("--only", "mipmap-kraus-reads,lensblur-ten-layers")
    assert "REFUTED  lensblur-ten-layers  (Section 3.1, layer construction)" in text
    assert "Printed: 173.02. Ours: 172.75 reads per pixel." in in_a_line(text)
    assert SOURCES["lee2010"] in text
    assert SOURCES["schedl2012"] not in text
    assert text.splitlines()[-1].split() == ["all", "0", "0", "2", "0", "2"]


def test_some_claims_as_json():
    told = json.loads(claims("--source", "gustafsson2018", "--only", "singlepass-angle", "--json"))
    (claim,) = told["claims"]
    assert claim["ours"] == 2.3999632297
    assert claim["verdict"] == "reproduced"
    assert claim["source"] == "gustafsson2018"
    assert told["summary"]["all"] == {
        "reproduced": 1,
        "direction reproduced": 0,
        "refuted": 0,
        "not testable on a CPU": 0,
        "claims": 1,
    }


def test_what_no_cpu_tells_says_why():
    text = claims("--only", "mipmap-frames")
    assert "NOT TESTABLE ON A CPU  mipmap-frames" in text
    assert "GeForce 8800 GTX" in in_a_line(text)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--source", "lee2011"], "source: got 'lee2011'; did you mean 'lee2010'? allowed are lee2009multiview,"),
        (["--only", "mipmap-read"], "only: got 'mipmap-read'; did you mean 'mipmap-reads'?"),
        (["--only", "mipmap-reads,"], "only: got ''"),
        (["--source", "lee2010", "--only", "mipmap-reads"], "only: got 'mipmap-reads'"),
        (["--threads", "0"], "threads: got 0"),
    ],
)
def test_bad_input_is_one_line(monkeypatch, capsys, words, message):
    assert message in refused(monkeypatch, capsys, "claims", *words)
