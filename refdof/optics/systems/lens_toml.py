"""lens.toml, the project's own lens file: read strictly, and written.

name = "Double Gauss 50 mm f/2"
source = "US patent 2,673,491, Tronnier"
unit = "mm"

[[surface]]              # from the scene to the sensor
radius = 29.475          # > 0: the centre of curvature is towards the sensor; 0 or inf: flat
thickness = 3.76         # to the next surface; of the last one to the sensor, or 0: where it is sharp
glass = [1.67, 47.1]     # behind the surface: a name, an index, or [n_d, V_d]
diameter = 25.2          # clear, across
stop = true              # on one surface
"""

import math
from collections.abc import Mapping
from typing import Any

from refdof._check import InputError, as_bool, as_number
from refdof._toml import check_keys, parse, quoted, shown
from refdof.optics.systems.glass import AIR, GLASSES, Glass
from refdof.optics.systems.rows import Material, Row, check_count, system_from
from refdof.optics.systems.system import LensSystem

__all__ = ["lens_text", "parse_toml"]

_TOP = ("name", "source", "unit", "surface")
_SURFACE = ("radius", "thickness", "glass", "diameter")


def parse_toml(file: str, text: str) -> LensSystem:
    """The lens system of a file's text.

    Raises
    ------
    InputError
        If a key is missing or unknown (the nearest one is said), a value is bad, or the surfaces make no lens.
    """
    table = parse(file, text, "a lens")
    check_keys(file, table, _TOP)
    for key in ("name", "source"):
        if not isinstance(table[key], str) or not table[key].strip():
            raise InputError(f"{file}: {key}: got {table[key]!r:.80}; allowed is a sentence")
    if table["unit"] != "mm":
        raise InputError(f"{file}: unit: got {table['unit']!r:.80}; allowed is 'mm'")
    surfaces = table["surface"]
    if not isinstance(surfaces, list) or not all(isinstance(surface, dict) for surface in surfaces):
        raise InputError(f"{file}: surface: got no tables; allowed are tables [[surface]]")
    check_count(file, len(surfaces))
    rows = []
    for number, surface in enumerate(surfaces, 1):
        try:
            rows.append(_row(f"surface {number}", surface))
        except InputError as error:
            raise InputError(f"{file}: surface {number}: {error}") from None
    return system_from(file, table["name"], table["source"], rows)


def lens_text(system: LensSystem) -> str:
    """The text of a lens.toml; read again it is the same lens.

    Raises
    ------
    InputError
        If a glass is neither a named one nor an index with or without an Abbe number.
    """
    lines = [f"name = {quoted('name', system.name)}", f"source = {quoted('source', system.source)}", 'unit = "mm"']
    for surface in system.surfaces:
        lines += [
            "",
            "[[surface]]",
            f"radius = {shown(surface.radius)}",
            f"thickness = {shown(surface.thickness)}",
            f"glass = {_glass_text(surface.glass)}",
            f"diameter = {shown(2.0 * surface.semi_diameter)}",
            *(["stop = true"] if surface.is_stop else []),
        ]
    return "\n".join(lines) + "\n"


def _row(place: str, surface: Mapping[str, Any]) -> Row:
    check_keys("", surface, _SURFACE, ("stop",))
    return Row(
        place,
        as_number("radius", surface["radius"], finite=False),
        as_number("thickness", surface["thickness"]),
        _material(surface["glass"]),
        as_number("diameter", surface["diameter"]),
        as_bool("stop", surface.get("stop", False)),
    )


def _material(value: Any) -> Material:
    if isinstance(value, str):
        return value
    if isinstance(value, list) and len(value) == 2:
        return as_number("glass: n_d", value[0]), as_number("glass: V_d", value[1])
    if isinstance(value, list | dict):
        raise InputError(f"glass: got a {type(value).__name__}; allowed is a name, an index or [n_d, V_d]")
    return as_number("glass", value)


def _glass_text(glass: Glass) -> str:
    if glass == AIR or GLASSES.get(glass.name) == glass:
        return quoted("glass", glass.name)
    if glass.n_d is None:
        raise InputError(f"glass: got {glass.name!r}; allowed is a named glass, an index, or an index and Abbe number")
    return shown(glass.n_d) if math.isinf(glass.v_d) else f"[{shown(glass.n_d)}, {shown(glass.v_d)}]"
