"""Cases of a small pack, right ports of it, and what spoils files."""

import hashlib
import json
import os
import shlex
import sys
from functools import cache

import numpy as np
import pytest

from refdof.oracle.cases import Case
from refdof.stages import Stages
from tests.methods.singlepass.shader32 import listing

posix = pytest.mark.skipif(os.name != "posix", reason="process groups, links and pipes are POSIX's")

CASES = [
    Case("cards", "singlepass", "cards", (24, 18), stages=Stages((1, 4)), tags=("staged",)),
    Case("noise", "singlepass", "noise", (17, 13)),
    Case("noise_up", "singlepass", "noise", (17, 13), {"row_order": "up"}, "up", Stages((1, 4)), ("staged", "up")),
]


def port(color, depth, coc, params):
    """A right port."""
    return listing(color, depth, coc).astype(np.float32)


def staged_port(color, depth, coc, params, faults=()):
    """A right port that shows its stages, in float32: each uses the ones before, or given ones.

    faults: {stage: function of it, "tap K": (dx, dy) [px] that are added to that tap, counted from 1}.
    """
    faults, given, one = dict(faults), params.get("given", {}), np.float32(1)
    shown = {}

    def stage(name, values):
        shown[name] = faults.get(name, lambda same: same)(np.asarray(given.get(name, values), dtype=np.float32))
        return shown[name]

    height, width = depth.shape
    coc = stage("coc", coc)
    size = stage("size", np.minimum(np.abs(coc), np.float32(params["max_blur_size"])))
    limit = stage("limit", np.float32(params["behind_factor"]) * size)
    y, x = np.indices(depth.shape)
    radius = np.float32(params["rad_scale"])
    mean, angle, k = color.copy(), np.float32(0), 0
    while radius < params["max_blur_size"]:
        k += 1
        dx, dy = faults.get(f"tap {k}", (0.0, 0.0))
        u, v = x + np.cos(angle) * radius + dx, y + np.sin(angle) * radius + dy
        at = [np.clip(np.floor(c + 0.5), 0, n - 1).astype(int) for c, n in ((v, height), (u, width))]
        reach = np.where(depth[*at] > depth, np.minimum(size[*at], limit), size[*at])
        t = np.clip(reach - (radius - np.float32(0.5)), 0, 1)
        m = (t * t * (3 - 2 * t))[..., None].astype(np.float32)
        mean = mean + m * (bilinear(color, u, v) - mean) / np.float32(k + 1)
        if k in (1, 4):
            mean = stage(f"mean_{k}", mean)
        angle += np.float32(2.39996323)
        radius += np.float32(params["rad_scale"]) / radius
    stage("image", mean * one)
    return shown


def bilinear(image, u, v):
    """(H, W, 3) at places in centres of texels, clamped to the edge."""
    height, width = image.shape[:2]
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    right, down = (u - i)[..., None], (v - j)[..., None]
    columns = [np.clip(i + k, 0, width - 1) for k in (0, 1)]
    rows = [np.clip(j + k, 0, height - 1) for k in (0, 1)]
    above, below = (image[r, columns[0]] * (1 - right) + image[r, columns[1]] * right for r in rows)
    return (above * (1 - down) + below * down).astype(np.float32)


def of_case(function, parts):
    """A port with stages that gives only those that a case has."""

    def given(color, depth, coc, params):
        shown = function(color, depth, coc, params)
        return {name: values for name, values in shown.items() if name == "image" or name in parts(depth.shape, params)}

    return given


def stages_of(shape, params):
    """The stages of the case of this size and these parameters."""
    if shape == (18, 24) or params["row_order"] == "up":
        return ("coc", "size", "limit", "mean_1", "mean_4")
    return ()


def flip_bit(path):
    data = bytearray(path.read_bytes())
    data[-1] ^= 1
    path.write_bytes(bytes(data))


def rewrite(folder, name, change):
    """Change a JSON file of a pack, and the manifest with it, as an attacker would."""
    path = folder / name
    content = json.loads(path.read_text())
    change(content)
    resign(folder, name, json.dumps(content))


def resign(folder, name, text):
    """Write a file of a pack, and its digest."""
    (folder / name).write_text(text)
    if name != "manifest.json":
        manifest = json.loads((folder / "manifest.json").read_text())
        manifest["files"][name] = hashlib.sha256((folder / name).read_bytes()).hexdigest()
        (folder / "manifest.json").write_text(json.dumps(manifest))


def write_results(folder, pack):
    """Right results of all cases, as files."""
    for case in CASES:
        (folder / case.name).mkdir(parents=True)
        (folder / case.name / "image.f32").write_bytes(_right_bytes(pack, case.name))


@cache
def _right_bytes(pack, case):
    images = [np.load(pack / "cases" / case / "inputs" / f"{name}.npy") for name in ("color", "depth", "coc")]
    return port(*images, {}).astype("<f4").tobytes()


def command(tmp_path, code):
    """A command line of a Python script with this code, which has `case` and `out`."""
    script = tmp_path / "a port.py"
    script.write_text("import os, sys, time, pathlib\ncase, out = map(pathlib.Path, sys.argv[1:])\n" + code)
    return f"{shlex.quote(sys.executable)} {shlex.quote(str(script))} {{case}} {{out}}"


def statuses(report):
    return [outcome.status for outcome in report.outcomes]
