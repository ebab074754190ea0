"""Zemax's sequential lens files (.zmx): spherical and flat surfaces, their glass, their clear radii and the stop.

What is read: MODE, NAME, NOTE, UNIT, and of every SURF: TYPE STANDARD, CURV (1 / radius), DISZ (thickness), GLAS (name,
or model glass of index and Abbe number), DIAM and CLAP (clear **radius**), STOP. SURF 0 is the scene and the last one
the sensor. Surfaces between air and air that are not the stop do nothing, and are left out. What changes the lens and
is not read (aspheres, tilts, mirrors, odd apertures, several configurations) is an error that names it.
"""

import math
import re
from dataclasses import dataclass, field, replace

from refdof._check import InputError, as_number
from refdof.optics.systems.glass import GLASSES
from refdof.optics.systems.rows import Material, Row, check_count, system_from
from refdof.optics.systems.system import LensSystem

__all__ = ["parse_zemax"]

_MILLIMETRES = {"MM": 1.0, "CM": 10.0, "IN": 25.4, "METER": 1000.0}
_LONGEST_SOURCE = 400  # characters of the notes
_TYPES = {
    "COORDBRK": "a coordinate break (tilt or decentre)",
    "EVENASPH": "an even asphere",
    "ODDASPHE": "an odd asphere",
    "XASPHERE": "an extended asphere",
    "TOROIDAL": "a toroidal surface",
    "BICONICX": "a biconic surface",
    "PARAXIAL": "a paraxial lens",
    "DGRATING": "a grating",
}
_APERTURES = ("ELAP", "ELOB", "OBSC", "SPID", "SQAP", "SQOB", "USAP", "UOBS")
_PLACEHOLDERS = (0.0, 1.5)  # n_d that Zemax writes where the catalogue has the glass


@dataclass
class _Record:
    """A SURF of the file: the words behind each keyword, at most one line of each."""

    number: int
    words: dict[str, list[str]] = field(default_factory=dict)


def parse_zemax(file: str, text: str, name: str) -> LensSystem:
    """The lens system of a file's text; its notes are the source, and `name` is used if it names nothing.

    Raises
    ------
    InputError
        If it is no sequential file, something in it is not supported, or the surfaces make no lens.
    """
    head, records, notes = _split(file, text)
    if head.get("MODE", ["SEQ"])[:1] != ["SEQ"]:
        raise InputError(f"{file}: MODE {' '.join(head['MODE'])[:40]} is not supported; allowed is SEQ")
    unit = " ".join(head.get("UNIT", ["MM"])[:1]).upper()
    if unit not in _MILLIMETRES:
        raise InputError(f"{file}: UNIT: got {unit[:40]!r}; allowed are {', '.join(_MILLIMETRES)}")
    if head.get("MNUM", ["1"])[:1] != ["1"]:
        raise InputError(f"{file}: MNUM: several configurations (a zoom) are not supported; allowed is one")
    if len(records) < 3:
        raise InputError(f"{file}: got {len(records)} SURF; allowed are 3 at least: the scene, a surface, the sensor")
    if [record.number for record in records] != list(range(len(records))):
        raise InputError(f"{file}: SURF: got numbers out of order; allowed are 0, 1, 2 and so on")
    rows: list[Row] = []
    for record in records[:-1]:
        try:
            _check_supported(record.words)
            if record.number > 0:
                _append(rows, record, _MILLIMETRES[unit])
        except InputError as error:
            raise InputError(f"{file}: SURF {record.number}: {error}") from None
    if _value("CURV", records[-1].words, "0") != 0.0:
        raise InputError(f"{file}: SURF {records[-1].number}: a curved sensor is not supported; allowed is CURV 0")
    title = " ".join(head.get("NAME", [])) or name
    return system_from(file, title, " ".join(notes)[:_LONGEST_SOURCE], rows)


def _split(file: str, text: str) -> tuple[dict[str, list[str]], list[_Record], list[str]]:
    """Keywords outside of surfaces, the surfaces, and the text of the notes."""
    head: dict[str, list[str]] = {}
    records: list[_Record] = []
    notes: list[str] = []
    for line in text.splitlines():
        key, *words = line.split() or [""]
        if key == "SURF":
            if not words or not re.fullmatch(r"[0-9]{1,9}", words[0]):
                raise InputError(f"{file}: SURF: got {' '.join(words)[:40]!r}; allowed is a number")
            records.append(_Record(int(words[0])))
            check_count(file, len(records))
        elif key == "NOTE":
            notes.extend(words[1:])
        elif records and line[:1].isspace():
            records[-1].words.setdefault(key, words)
        elif key:
            head.setdefault(key, words)
    return head, records, notes


def _check_supported(words: dict[str, list[str]]) -> None:
    kind = " ".join(words.get("TYPE", ["STANDARD"])[:1])
    if kind != "STANDARD":
        said = _TYPES.get(kind, "another kind of surface")
        raise InputError(f"TYPE {kind[:40]}: {said} is not supported; allowed is STANDARD")
    if _value("CONI", words, "0") != 0.0:
        raise InputError(f"CONI: got {words['CONI'][0]}, a conic asphere, which is not supported; allowed is 0")
    if words.get("GLAS", [""])[:1] == ["MIRROR"]:
        raise InputError("GLAS MIRROR: a mirror is not supported; allowed is a lens")
    for key in _APERTURES:
        if key in words:
            raise InputError(f"{key}: an aperture that is not a disc is not supported; allowed are DIAM and CLAP")
    if "CLAP" in words and _value("CLAP", words, "0") != 0.0:
        raise InputError("CLAP: a ring as an aperture is not supported; allowed is an inner radius of 0")


def _append(rows: list[Row], record: _Record, scale: float) -> None:
    """Add a surface to `rows`; one that does nothing only adds its thickness."""
    words = record.words
    thickness = scale * _value("DISZ", words, "0")
    material = _material(words["GLAS"]) if "GLAS" in words else 1.0
    is_stop = "STOP" in words
    if not is_stop and material == 1.0 and (not rows or rows[-1].material == 1.0):
        if thickness < 0.0:
            raise InputError(f"DISZ: got {thickness / scale:g}; allowed is a thickness >= 0")
        if rows:
            rows[-1] = replace(rows[-1], thickness=rows[-1].thickness + thickness)
        return
    curvature = _value("CURV", words, "0")
    radius = math.inf if curvature == 0.0 else scale / curvature
    clear = words["CLAP"][1:2] if "CLAP" in words else words.get("DIAM", ["0"])[:1]
    diameter = 2.0 * scale * _number("DIAM", "".join(clear))
    rows.append(Row(f"SURF {record.number}", radius, thickness, material, diameter, is_stop))


def _material(words: list[str]) -> Material:
    """A named glass; the file's own index and Abbe number, where the name is unknown and it has them."""
    if not words:
        raise InputError("GLAS: got no name; allowed is the name of a glass")
    named = {glass.upper(): glass for glass in GLASSES}.get(words[0].upper())
    if named is not None:
        return named
    if len(words) >= 5:
        n_d, v_d = _number("GLAS: index", words[3]), _number("GLAS: Abbe number", words[4])
        if words[0].startswith("___") or n_d not in _PLACEHOLDERS:
            return (n_d, v_d) if v_d != 0.0 else n_d
    return words[0]


def _value(key: str, words: dict[str, list[str]], default: str) -> float:
    return _number(key, "".join(words.get(key, [default])[:1]))


def _number(name: str, word: str) -> float:
    return as_number(name, word.replace("_", "?"))  # Python reads 1_0 as 10
