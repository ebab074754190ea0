"""The tables of docs/scenes.md: each row is proved by a small file, and each file has its row."""

import re
from pathlib import Path

import pytest
from PIL import features as pillow

from refdof import InputError
from refdof.scene.gltf.codecs import DECODERS
from refdof.scene.mesh_file import load_mesh
from tests.scene.gltf.card import Card
from tests.scene.gltf.features import FEATURES, READ_EXTENSIONS

pytestmark = pytest.mark.fast
PAGE = Path(__file__).parents[3] / "docs" / "scenes.md"


def rows(head):
    """First and second cells of the table with this head."""
    text = PAGE.read_text().split(f"| {head} | outcome | note |")[1].split("\n\n")[0]
    return dict(re.findall(r"^\| (?!-)(.+?) \| (.+?) \|", text.partition("\n")[2].partition("\n")[2], re.MULTILINE))


CORE, EXTENSIONS = rows("feature"), rows("extension")


def test_every_row_has_a_file_and_every_file_a_row():
    assert list(CORE) == list(FEATURES)
    read = {name for name, outcome in EXTENSIONS.items() if outcome == "read"}
    assert read == {*READ_EXTENSIONS, *DECODERS}
    assert set(CORE.values()) == {"read", "refused", "ignored with warning"}
    assert set(EXTENSIONS.values()) == {"read", "ignored with warning"}


def written(feature, folder):
    card = feature.make()
    if feature.name != "beside.gltf":
        return card.write(folder, feature.name)
    path = folder / feature.name
    path.write_text(card.beside(folder, "my numbers.bin"))
    return path


@pytest.mark.parametrize("name", FEATURES)
def test_features_of_the_core(tmp_path, name):
    feature = FEATURES[name]
    path = written(feature, tmp_path)
    if CORE[name] == "read":
        assert feature.shown(load_mesh(path))
    elif CORE[name] == "refused":
        with pytest.raises(InputError, match=feature.shown):
            load_mesh(path)
    else:
        with pytest.warns(UserWarning, match=f"^{feature.name}: left out: .*{feature.shown}") as told:
            assert len(load_mesh(path).faces) == 2
        assert len(told) == 1


@pytest.mark.parametrize("name", READ_EXTENSIONS)
def test_extensions_that_are_read(tmp_path, name):
    if name == "EXT_texture_avif" and not pillow.check("avif"):
        pytest.skip("Pillow has no AVIF here")
    feature = READ_EXTENSIONS[name]
    assert feature.shown(load_mesh(written(feature, tmp_path)))


@pytest.mark.parametrize("name", [name for name, outcome in EXTENSIONS.items() if outcome != "read"])
def test_extensions_that_are_ignored_with_a_warning_or_refused(tmp_path, name):
    card = Card({"extensions": {name: {}}}).uses(name)
    with pytest.warns(UserWarning, match=f"left out: the extension {name}$"):
        assert len(load_mesh(card.write(tmp_path)).faces) == 2
    card.header["extensionsRequired"] = [name]
    with pytest.raises(InputError, match=f"it requires the extension '{name}'; allowed are"):
        load_mesh(card.write(tmp_path))


@pytest.mark.parametrize("name", DECODERS)
def test_packed_files_are_refused_without_a_decoder(tmp_path, name, monkeypatch):
    for place in ("codecs", "extensions", "file"):
        monkeypatch.setattr(f"refdof.scene.gltf.{place}.has_decoder", lambda extension: False)
    path = Card().uses(name, required=True).write(tmp_path)
    with pytest.raises(InputError, match=rf"the extension '{name}'; pip install 'refdof\[codecs\]' reads it"):
        load_mesh(path)


def test_an_extension_of_nobody_is_refused_or_told(tmp_path):
    with pytest.warns(UserWarning, match="the extension ACME_teapots"):
        load_mesh(Card().uses("ACME_teapots").write(tmp_path))
    with pytest.raises(InputError, match="it requires the extension 'ACME_teapots'"):
        load_mesh(Card().uses("ACME_teapots", required=True).write(tmp_path))


def test_a_texture_of_basis_universal_alone_is_told(tmp_path):
    card = Card({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}).uses("KHR_texture_basisu")
    card.header["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]
    card.header["images"] = [{"uri": "a.ktx2"}]
    with pytest.warns(UserWarning, match=r"texture 0 \(it has no image but of KHR_texture_basisu\)"):
        assert load_mesh(card.write(tmp_path)).materials[0].texture is None
