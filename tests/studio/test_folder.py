"""The folder: names that lead out of it are refused, whatever they look like; what is in it is listed and opened."""

import os

import pytest

from refdof import InputError, LensSystem, Scene
from refdof.focus.focus_file import save_focus
from refdof.focus.focus_lens import Focus
from refdof.focus.point import FocusPoint
from refdof.studio.folder import Folder

pytestmark = pytest.mark.fast

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.fixture
def folder(tmp_path):
    root = tmp_path / "root"
    (root / "sub").mkdir(parents=True)
    (root / "sub" / "a.obj").write_text(TRIANGLE)
    (root / "notes.txt").write_text("not listed")
    (root / ".hidden.obj").write_text(TRIANGLE)
    save_focus(root / "points.toml", Focus((FocusPoint(0, (1, 1, 1)),)))
    (tmp_path / "outside.obj").write_text(TRIANGLE)
    (root / "link.obj").symlink_to(tmp_path / "outside.obj")
    os.mkfifo(root / "pipe.obj")
    dropped = tmp_path / "dropped"
    dropped.mkdir()
    return Folder(root, dropped)


def test_listing(folder):
    assert folder.listing() == {"scenes": ["link.obj", "pipe.obj", "sub/a.obj"], "lenses": [], "focus": ["points.toml"]}


def test_open(folder):
    assert isinstance(folder.open("sub/a.obj"), Scene)
    assert isinstance(folder.open("cans"), Scene)
    assert isinstance(folder.open("double_gauss"), LensSystem)
    assert isinstance(folder.open("points.toml"), Focus)


OUTSIDE = [
    "../outside.obj",
    "sub/../../outside.obj",
    "sub/../sub/a.obj",
    "/etc/passwd",
    "link.obj",
    "pipe.obj",
    "sub",
    ".",
    "",
    "a\0b.obj",
    "a\nb.obj",
    "..\\outside.obj",
    "x" * 1000 + ".obj",
    "/".join(["d"] * 90) + ".obj",
    None,
    3,
    ["sub/a.obj"],
    "~/a.obj",
    "missing.obj",
]


@pytest.mark.parametrize("name", OUTSIDE, ids=range(len(OUTSIDE)))
def test_what_is_outside_or_no_plain_file_is_refused(folder, name):
    with pytest.raises(InputError, match="name: got"):
        folder.open(name)


@pytest.mark.parametrize(
    "name", [n for n in OUTSIDE if n not in ("missing.obj", "~/a.obj", "/".join(["d"] * 90) + ".obj")]
)
def test_nothing_is_written_outside(folder, name):
    with pytest.raises(InputError, match="name: got"):
        folder.new(name, (".obj",))


def test_new_names_have_the_suffix_of_what_is_written(folder):
    assert folder.name_of(folder.new("sub/b.png", (".png",))) == "sub/b.png"
    for name in ("b.exr", ".png", "b", ".b.png"):
        with pytest.raises(InputError, match="name"):
            folder.new(name, (".png",))


def test_dropped_files_are_kept_apart(folder):
    name = folder.drop("b.obj", TRIANGLE.encode())
    assert isinstance(folder.open(name), Scene)
    assert not (folder.root / "b.obj").exists()
    for bad in ("sub/c.obj", "../c.obj", "c.exe", "c", "", None, "/c.obj"):
        with pytest.raises(InputError, match="name"):
            folder.drop(bad, b"")
    with pytest.raises(InputError, match="drop"):
        Folder(folder.root).drop("b.obj", b"")
