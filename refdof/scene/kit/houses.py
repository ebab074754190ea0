"""Houses: gabled town houses with windows, doors, dormers and chimneys, as meshes by material name."""

from collections import defaultdict
from collections.abc import Iterable

import numpy as np

from refdof._check import Float
from refdof.scene.kit.darkening import corner_shade
from refdof.scene.kit.masonry import window
from refdof.scene.kit.mesh import Mesh, join
from refdof.scene.kit.noise import fractal, smooth
from refdof.scene.kit.shapes import box, lathe, plane, surface
from refdof.scene.kit.textures import blend, paint

__all__ = ["church", "gather", "house", "timbered"]

_STOREY = 2.7


def gather(groups: Iterable[dict[str, Mesh]]) -> dict[str, Mesh]:
    """Join meshes of the same material name."""
    found: dict[str, list[Mesh]] = defaultdict(list)
    for group in groups:
        for name, mesh in group.items():
            found[name].append(mesh)
    return {name: join(meshes) for name, meshes in found.items()}


def timbered(size: int, plaster: str, beam: str, rng: np.random.Generator) -> Float:
    """Half-timbered wall, two storeys by four bays: posts, rails and braces on plaster."""
    s = (np.arange(size) + 0.5) / size
    u, v = np.meshgrid(4.0 * s, 2.0 * s[::-1])
    bay, storey = np.floor(u).astype(int), np.floor(v).astype(int)
    x, y = u - bay, v - storey
    beams = np.minimum(np.minimum(x, 1 - x), 1.2 * np.minimum(y, 1 - y))
    beams = np.minimum(beams, np.where(storey == 0, 1.2 * np.abs(y - 0.42), 1.0))
    slant = np.where((bay + storey) % 2 == 0, x - y, x + y - 1.0)
    beams = np.minimum(beams, np.where((bay + 2 * storey) % 3 == 0, 0.8 * np.abs(slant), 1.0))
    rough = fractal((size, size), (8, 8), rng, 5, 0.65) - 0.5
    wall = paint(plaster) * (1.0 + 0.3 * rough - 0.2 * smooth(0.16, 0.05, beams))[..., None]
    timber = paint(beam) * (1.0 + 1.1 * rough)[..., None]
    return np.maximum(blend(timber, wall, smooth(0.06, 0.075, beams + 0.02 * rough)), 0.0).astype(np.float32)


def house(width: float, depth: float, storeys: int, wall: str, roof: str, rng: np.random.Generator) -> dict[str, Mesh]:
    """House whose front looks along +z, the ridge along x or, when narrow, towards the street."""
    high = _STOREY * storeys
    pitch = rng.uniform(0.9, 1.25)
    gable = width < depth
    across, along = (width, depth) if gable else (depth, width)
    peak = high + 0.5 * across * pitch
    body = box(width, high, depth).tiled(1 / 1.5, 1 / _STOREY)  # bays and storeys
    x, y = np.array([-0.5, 0.0, 0.5]) * across, np.array([high, peak, high])
    ends = []
    for s in (-1, 1):
        rows = np.stack(
            [
                np.column_stack([x, np.full(3, high), np.full(3, s * along / 2)]),
                np.column_stack([x, y, np.full(3, s * along / 2)]),
            ]
        )
        ends.append(surface(rows, rows[..., :2] / [1.5, _STOREY]))
    eaves, over = 0.45, 0.35
    slabs = []
    for s in (-1, 1):
        run = np.array([s * (across / 2 + eaves), -(0.5 * across + eaves) * pitch])
        top = plane(
            (0, peak + 0.16, s * (along / 2 + over)),
            (0, 0, -s * (along + 2 * over)),
            (run[0], run[1], 0),
            (4, 4),
        )
        length = float(np.hypot(*run))
        top = top.tiled((along + 0.7) / 2.4, length / 2.4).tinted(1.05 - 0.2 * top.uv[:, 1:2])
        slabs += [
            top,
            *(
                plane((0, peak + (0.16 if k else 0), s * e), (run[0], run[1], 0), (0, -0.16, 0))
                for k, e in ((1, along / 2 + over), (1, -along / 2 - over))
            ),
        ]
        slabs.append(plane((run[0], peak + run[1] + 0.16, -along / 2 - over), (0, 0, along + 2 * over), (0, -0.16, 0)))
    top_ = join(slabs)
    walls = join([body, *ends]) if gable else join([body, join(ends).turned("y", 90)])
    groups = [{f"wall {wall}": _aged(walls, high), f"roof {roof}": top_ if gable else top_.turned("y", 90)}]
    groups += _openings(width, depth, storeys, rng)
    if gable:
        groups.append(_opening(1.0, 1.2, 0.0, high + 0.35, depth / 2, rng))
    elif width > 6.5 and rng.random() < 0.7:
        groups += [_dormer(s * width * 0.22, high, depth, pitch, roof) for s in (-1, 1)]
    at = rng.uniform(-0.3, 0.3) * along
    stack = box(0.7, 2.0, 0.7).moved(0.6, peak - 1.1, at) if gable else box(0.7, 2.0, 0.7).moved(at, peak - 1.1, -0.6)
    pots = [lathe([[(0.13, 0.0), (0.1, 0.4), (0.12, 0.42)]], 6).moved(s * 0.16, 2.0, 0) for s in (-1, 1)]
    foot = stack.vertices.mean(axis=0)
    groups += [{"brick": stack}, {"clay": join(pots).moved(foot[0], peak - 1.1, foot[2])}]
    return gather(groups)


def _aged(walls: Mesh, high: float) -> Mesh:
    """Damp at the foot, shade under the eaves."""
    y = walls.vertices[:, 1]
    walls = walls.tinted(corner_shade(y, 0.7, 0.35) * corner_shade(np.minimum(y - high, 0), 0.5, 0.4))
    return walls.tiled(0.25, 0.5)


def _openings(width: float, depth: float, storeys: int, rng: np.random.Generator) -> list[dict[str, Mesh]]:
    groups = []
    count = max(2, int(width / 2.1))
    slots = (np.arange(count) + 0.5) / count * width - width / 2
    door = int(rng.integers(count))
    for storey in range(storeys):
        for k, x in enumerate(slots):
            if storey == 0 and k == door:
                leaf_ = box(1.0, 2.1, 0.12).moved(x, 0, depth / 2)
                jamb = [box(0.16, 2.25, 0.2).moved(x + s * 0.58, 0, depth / 2) for s in (-1, 1)]
                hood = box(1.5, 0.14, 0.6).moved(x, 2.3, depth / 2 + 0.2)
                groups += [
                    {"door": leaf_.tinted(rng.uniform(0.5, 1.2))},
                    {"trim": join([*jamb, hood, box(1.4, 0.16, 0.5).moved(x, 0, depth / 2 + 0.3)])},
                ]
            else:
                groups.append(_opening(0.95, 1.35, x, storey * _STOREY + 0.85, depth / 2, rng, shutters=storey > 0))
        for side in (-1, 1):
            for z in (-depth / 4, depth / 4):
                if rng.random() < 0.55:
                    one = _opening(0.8, 1.2, 0, storey * _STOREY + 0.9, width / 2, rng)
                    groups.append({n: m.turned("y", 90.0 * side).moved(0, 0, z) for n, m in one.items()})
    return groups


def _opening(
    width: float,
    height: float,
    x: float,
    y: float,
    z: float,
    rng: np.random.Generator,
    shutters: bool = False,
) -> dict[str, Mesh]:
    bars, panes = window(width, height, 2, 2, 0.09)
    sky = 0.35 + 0.9 * rng.random() * panes.vertices[:, 1:2] / height
    found = {"frame": bars.moved(x, y, z), "glass": panes.tinted(sky).moved(x, y, z + 0.02)}
    found["trim"] = box(width + 0.3, 0.1, 0.3).moved(x, y - 0.1, z + 0.05)
    if shutters:
        found["shutter"] = join(
            box(0.45, height, 0.07).moved(x + s * (width / 2 + 0.24), y, z + 0.03) for s in (-1, 1)
        ).tinted(rng.uniform(0.7, 1.2))
    return found


def _dormer(x: float, high: float, depth: float, pitch: float, roof: str) -> dict[str, Mesh]:
    """Small gabled window on the street side of the roof."""
    z, y = depth / 2 - 0.9, high + 0.35
    cheek = box(1.3, 1.3, 1.6).tiled(0.4, 0.4).moved(x, y, z - 0.7)
    slabs = [plane((x, y + 1.95, z + 0.3), (0, 0, -2.4), (s * 0.95, -0.75, 0), (1, 1)) for s in (-1, 1)]
    front = surface(
        np.array(
            [
                [(x - 0.65, y + 1.3, z + 0.11), (x, y + 1.3, z + 0.11), (x + 0.65, y + 1.3, z + 0.11)],
                [(x - 0.65, y + 1.31, z + 0.11), (x, y + 1.85, z + 0.11), (x + 0.65, y + 1.31, z + 0.11)],
            ]
        )
    )
    bars, panes = window(0.9, 1.0, 2, 2, 0.08)
    return {
        f"roof {roof}": join(slabs),
        "plain": join([cheek, front]),
        "frame": bars.moved(x, y + 0.2, z + 0.13),
        "glass": panes.tinted(0.7).moved(x, y + 0.2, z + 0.13),
    }


def church(rng: np.random.Generator) -> dict[str, Mesh]:
    """Nave with buttresses and tall windows, a tower with a clock and a pointed helm; door towards +z."""
    nave = house(9.0, 18.0, 3, "stone", "slate", rng)
    groups = [{n: m for n, m in nave.items() if n.startswith(("wall", "roof"))}]
    tower = box(5.0, 19.0, 5.0).tiled(0.16, 0.16).moved(0, 0, 8.5)
    helm = (
        lathe([[(4.0, 0.0), (3.2, 1.2), (0.12, 11.0), (0.0, 11.2)]], 8)
        .turned("y", 22.5)
        .moved(0, 19.0, 8.5)
        .tiled(8, 5)
    )
    groups += [{"wall stone": tower, "roof slate": helm}]
    groups += [
        {"wall stone": box(0.8, 6.0, 1.2).tiled(0.16, 0.16).turned("y", 90).moved(s * 4.9, 0, -7.0 + 3.4 * k)}
        for s in (-1, 1)
        for k in range(4)
    ]
    for k in range(4):
        face = lathe([[(0.0, 0.05), (1.1, 0.05)], [(1.1, 0.05), (1.25, 0.0)]], 24).turned("x", 90).moved(0, 14.5, 2.55)
        hands = [box(0.12, 0.95, 0.05).turned("z", a).moved(0, 14.5, 2.62) for a in (-50.0, 70.0)]
        louvre = [box(1.0, 0.12, 0.2).moved(0, 16.3 + 0.3 * j, 2.5) for j in range(6)]
        for name, mesh in (("trim", face), ("frame dark", join(hands)), ("shutter", join(louvre))):
            groups.append({name: mesh.turned("y", 90.0 * k).moved(0, 0, 8.5)})
    door = box(1.8, 3.2, 0.2).moved(0, 0, 11.0)
    groups += [
        {
            "door": door,
            "trim": join(
                [box(0.3, 3.4, 0.4).moved(s * 1.05, 0, 11.0) for s in (-1, 1)]
                + [box(2.6, 0.35, 0.5).moved(0, 3.3, 11.0)]
            ),
        }
    ]
    return gather(groups)
