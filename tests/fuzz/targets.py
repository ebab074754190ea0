"""Targets: what is read, from which seeds, and what it may raise: an `InputError`, for a case of a pack a `FileFault`.

Each reads bytes, through a file where the reader takes a file. Seeds are made from files of the repository and from
those that the tests write.
"""

import hashlib
import json
import os
import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from refdof._check import InputError
from refdof.focus.focus_file import load_focus
from refdof.image.file import load_image
from refdof.methods import METHODS
from refdof.optics.systems.prescription import load_lens
from refdof.options import metres_of, pixel_of
from refdof.oracle.expectation import expectation_of
from refdof.oracle.files import FileFault, open_pack
from refdof.oracle.waivers import read_waivers
from refdof.scene.formats.pictures import Pictures
from refdof.scene.kit.shot import parse_shot
from refdof.scene.limits import Limits, Meter
from refdof.scene.mesh_file import load_mesh
from refdof.settings import settings_by_method
from tests.fuzz import seeds

__all__ = ["TARGETS", "Target", "refused"]

_LIMITS = Limits(pixels=1e6, total_pixels=4e6, instances=1000, triangles=1e5, bytes=1e7, seconds=5.0)


@dataclass(frozen=True)
class Target:
    """A reader: takes bytes, and raises an `InputError` for bad ones."""

    seeds: Callable[[], list[bytes]]
    read: Callable[[bytes], object]
    most: int = 4096  # bytes of an input


def refused(target: Target, data: bytes) -> bool:
    """Whether the bytes are refused in a clear way; anything else that is raised comes through."""
    said = ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            target.read(data)
    except (InputError, FileFault) as error:
        said = str(error)
    assert len(said.splitlines()) <= 1, f"more than one line: {said}"
    return bool(said)


@cache
def _folder() -> Path:
    """A folder of this process, in memory where there is such a place."""
    memory = Path("/dev/shm")
    return Path(tempfile.mkdtemp(prefix="refdof-fuzz-", dir=memory if os.access(memory, os.W_OK) else None))


def _through_file(name: str, read: Callable[[Path], object]) -> Callable[[bytes], object]:
    def reads(data: bytes) -> object:
        path = _folder() / name
        path.write_bytes(data)
        return read(path)

    return reads


def _mesh(suffix: str) -> Callable[[bytes], object]:
    return _through_file(f"a.{suffix}", lambda path: load_mesh(path, limits=_LIMITS))


def _texture(data: bytes) -> object:
    return Pictures(Meter(_LIMITS)).get(0, "a", data)


def _text(data: bytes) -> str:
    return data.decode("utf-8", "surrogateescape")


def _shot(data: bytes) -> object:
    return parse_shot("a.toml", data.decode("utf-8", "replace"), seeds.NUMBERS)


def _words(data: bytes) -> object:
    """Words of the command line: a line each of one kind."""
    settings = []
    for line in _text(data).split("\n"):
        kind, _, word = line.partition(" ")
        if kind == "limit":
            Limits().with_words([word])
        elif kind == "units":
            metres_of(word)
        elif kind == "pixel":
            pixel_of(word)
        else:
            settings.append(line)
    return settings_by_method(settings, sorted(METHODS), [])


def _case(data: bytes) -> object:
    """A file of a pack with its digest put right: the first byte says which."""
    folder = _pack()
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    name = names[data[0] % len(names)] if data else names[0]
    kept = {one: (folder / one).read_bytes() for one in {name, "manifest.json"}}
    try:
        (folder / name).write_bytes(data[1:])
        if name != "manifest.json":
            manifest = json.loads(kept["manifest.json"])
            manifest["files"][name] = hashlib.sha256(data[1:]).hexdigest()
            (folder / "manifest.json").write_text(json.dumps(manifest))
        opened = open_pack(folder)
        return [expectation_of(opened, case) for case in opened.cases]
    finally:
        for one, content in kept.items():
            (folder / one).write_bytes(content)


@cache
def _pack() -> Path:
    """A pack of one case of 4 x 3 pixels, without what only people read."""
    from refdof.oracle.cases import Case
    from tests.packs import pack_of

    folder = pack_of([Case("noise", "singlepass", "noise", (4, 3))], _folder() / "pack")
    for path in (*folder.rglob("*.html"), *folder.rglob("*.png"), *folder.rglob("*.f32")):
        path.unlink()
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["files"] = {name: digest for name, digest in manifest["files"].items() if (folder / name).exists()}
    (folder / "manifest.json").write_text(json.dumps(manifest))
    return folder


def _seeds_of_pack() -> list[bytes]:
    folder = _pack()
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())
    return [bytes([number]) + (folder / name).read_bytes() for number, name in enumerate(names)]


TARGETS = {
    "gltf": Target(seeds.gltf_texts, _mesh("gltf")),
    "glb": Target(seeds.glb_files, _mesh("glb")),
    "obj": Target(seeds.obj_files, _mesh("obj")),
    "ply": Target(seeds.ply_files, _mesh("ply")),
    "off": Target(seeds.off_files, _mesh("off")),
    "stl": Target(seeds.stl_files, _mesh("stl")),
    "texture": Target(seeds.pictures("png"), _texture),
    "png": Target(seeds.pictures("png"), _through_file("a.png", load_image)),
    "exr": Target(seeds.pictures("exr"), _through_file("a.exr", load_image)),
    "hdr": Target(seeds.radiance, _through_file("a.hdr", load_image)),
    "npy": Target(seeds.pictures("npy"), _through_file("a.npy", load_image)),
    "scene_toml": Target(seeds.scenes, _shot),
    "lens_toml": Target(seeds.files("data/lenses/*.toml"), _through_file("a.toml", load_lens)),
    "lens_dat": Target(seeds.pbrt_files, _through_file("a.dat", load_lens)),
    "lens_zmx": Target(seeds.zemax_files, _through_file("a.zmx", load_lens)),
    "focus_toml": Target(seeds.focus_files, _through_file("b.toml", load_focus)),
    "waivers": Target(seeds.waivers, _through_file("c.toml", read_waivers)),
    "pack": Target(_seeds_of_pack, _case, most=16384),
    "settings": Target(seeds.settings, _words),
}
