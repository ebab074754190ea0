"""A pack for shaders, and a run of a shader's text on it. Modules that use them name the SUFFIX of their shaders."""

import pytest

from refdof.oracle import check_shader
from refdof.oracle.shaders import source
from tests.oracle.shaders.cases import CASES, Kept, need
from tests.packs import pack_of


@pytest.fixture(scope="session")
def written(tmp_path_factory):
    return pack_of(CASES, tmp_path_factory.mktemp("shaders") / "pack")


@pytest.fixture(scope="module")
def pack(request, written, tmp_path_factory):
    """A pack of `tests.oracle.shaders.cases.CASES`, where such shaders can be drawn."""
    need(request.module.SUFFIX, tmp_path_factory.mktemp("need"))
    return written


@pytest.fixture(scope="module")
def kept():
    process = Kept()
    yield process
    process.close()


@pytest.fixture
def outcomes(request, pack, tmp_path, kept, monkeypatch):
    """What a shader's text makes of every case, with a text of bindings."""
    monkeypatch.setattr(source, "Process", kept)

    def run(text, bindings=None, timeout=20.0, stem="shader"):
        shader, file = tmp_path / f"{stem}.{request.module.SUFFIX}", tmp_path / "bindings.toml"
        shader.write_text(text)
        if bindings is not None:
            file.write_text(bindings)
        return check_shader(shader, pack, None if bindings is None else file, timeout).outcomes

    return run
