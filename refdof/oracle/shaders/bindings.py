"""Bindings: what each name that a shader reads is given, by a file or by the usual names.

1. Read a file of bindings                          `read_bindings`
2. Find the meaning of all names, or say which none  `meanings_of`
3. Work out their values for a case                  `Meanings.values`
"""

import ast
import os
import tomllib
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float, InputError, as_choice
from refdof._files import as_plain_file
from refdof.oracle.shaders.case import PICTURES, CaseValues, filter_of
from refdof.oracle.shaders.drawing.slots import COUNTS, Given, Slot
from refdof.oracle.shaders.expressions import evaluate, names_in, parsed
from refdof.oracle.shaders.names import known_names, sampler_meaning, usual_number, usual_texture
from refdof.oracle.sources import NotSupported

__all__ = ["FILTERS", "Binding", "Meanings", "meanings_of", "read_bindings"]

FILTERS = ("nearest", "linear")
_LARGEST_FILE = 2**20


class Binding(NamedTuple):
    """An expression, as written and as read, and the filter of a texture or sampler, None: as the case has it."""

    text: str
    tree: ast.expr
    filter: str | None = None


class Meanings(NamedTuple):
    """The meaning of every name that a shader reads."""

    uniforms: dict[str, Binding]
    textures: dict[str, Binding]
    samplers: dict[str, str | tuple[str, ...]]
    slots: dict[str, Slot]

    def parameters(self) -> set[str]:
        """Numbers that the shader takes as such, and does not hold as constants.

        The scale of circles does not count: it is divided by the largest blur, whether that is a constant or not.
        """
        found = [names_in(binding.tree) for binding in self.uniforms.values()]
        return set().union(*(names for names in found if "coc_scale" not in names))

    def values(self, case: CaseValues) -> Given:
        """What the shader is given for a case.

        Raises
        ------
        NotSupported
            If the case has no number for a uniform, or its filters cannot be had with these textures.
        """
        uniforms = {}
        for name, binding in self.uniforms.items():
            missing = names_in(binding.tree) - set(case.numbers)
            if not missing:
                uniforms[name] = _numbers(self.slots[name], binding, case.numbers)
            elif not self.slots[name].has_default:
                raise NotSupported(f"{name}: the case has no {', '.join(sorted(missing))}")
        everything = {**case.numbers, **case.pictures}
        textures = {name: _picture(name, evaluate(one.tree, everything), case) for name, one in self.textures.items()}
        filters = {name: one.filter or filter_of(name, one.tree, case) for name, one in self.textures.items()}
        for name, meaning in self.samplers.items():
            filters[name] = meaning if isinstance(meaning, str) else _shared(name, meaning, filters)
        return Given(uniforms, textures, filters)


def read_bindings(file: str | os.PathLike[str]) -> dict[str, Binding]:
    """Read lines `name = "expression"` or `name = { value = "expression", filter = "linear" }`, TOML.

    Raises
    ------
    InputError
        If the file is not of that kind.
    """
    path = as_plain_file("bindings", file)
    try:
        with path.open("rb") as stream:
            content = tomllib.loads(stream.read(_LARGEST_FILE).decode("utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"bindings: got {str(file)!r} ({error}); allowed is a TOML file") from None
    return {name: _binding(f"bindings: {name}", value) for name, value in content.items()}


def meanings_of(found: Iterable[Slot], given: Mapping[str, Binding], keys: set[str]) -> Meanings:
    """Give every slot a meaning. `keys`: the names of the numbers that cases have.

    Raises
    ------
    InputError
        If a name has none, or a binding does not fit.
    """
    slots = {slot.name: slot for slot in found}
    meanings = Meanings({}, {}, {}, slots)
    for name, binding in given.items():
        if name not in slots:
            raise InputError(f"bindings: {name}: is not read by the shader; allowed are {', '.join(slots) or 'none'}")
        allowed = _allowed(slots[name].kind, keys)
        if not names_in(binding.tree) <= set(allowed):
            raise InputError(f"bindings: {name}: got {binding.text!r}; allowed are the names {', '.join(allowed)}")
    near = next((slot.name for slot in slots.values() if _is_near(slot, keys)), None)
    for name, slot in slots.items():
        if slot.kind == "texture":
            meanings.textures[name] = given.get(name) or _texture(name, near)
        elif slot.kind == "uniform":
            bound = given.get(name) or _number(slot, keys)
            if bound is not None:
                meanings.uniforms[name] = bound
    for name, slot in slots.items():
        if slot.kind == "sampler" and name in given:
            meanings.samplers[name] = as_choice(f"bindings: {name}", given[name].text, FILTERS)
        elif slot.kind == "sampler":
            meanings.samplers[name] = _sampler(slot, meanings)
    for name in meanings.textures:
        if not names_in(meanings.textures[name].tree) & set(PICTURES):
            raise InputError(f"bindings: {name}: got {meanings.textures[name].text!r}; allowed is a picture")
    return meanings


def _allowed(kind: str, keys: set[str]) -> tuple[str, ...]:
    """Names that the expression of a slot may have."""
    if kind == "sampler":
        return FILTERS
    return (*(PICTURES if kind == "texture" else ()), *sorted(keys))


def _binding(name: str, value: Any) -> Binding:
    chosen = None
    if isinstance(value, dict):
        if not set(value) <= {"value", "filter"} or "value" not in value:
            raise InputError(f"{name}: got {', '.join(value) or 'nothing'}; allowed are value and filter")
        chosen = as_choice(f"{name}: filter", value["filter"], FILTERS) if "filter" in value else None
        value = value["value"]
    if isinstance(value, list):
        value = ", ".join(str(part) for part in value)
    text = str(value).lower() if isinstance(value, bool) else str(value)
    text = {"true": "1", "false": "0"}.get(text, text)
    return Binding(text, parsed(name, text), chosen)


def _texture(name: str, near: str | None) -> Binding:
    meaning = usual_texture(name)
    if meaning is None:
        raise InputError(
            f"{name}: is a texture of unknown meaning; allowed are usual names ({known_names('texture')}), "
            f'or a line of a file of bindings such as {name} = "color"'
        )
    if meaning == "depth / far" and near is not None:
        raise InputError(
            f"{name}: may hold depth of several kinds, as the shader also reads {near}; "
            f'allowed is a file of bindings that says {name} = "device", "reversed" or "depth / far"'
        )
    return Binding(meaning, parsed(name, meaning))


def _number(slot: Slot, keys: set[str]) -> Binding | None:
    count = COUNTS.get(slot.type)
    meaning = None if count is None else usual_number(slot.name, count, keys)
    if meaning is None:
        if slot.has_default:
            return None
        raise InputError(
            f"{slot.name}: is a uniform ({slot.type}) that nothing binds; allowed are usual names "
            f"({known_names('uniform')}, and {', '.join(sorted(keys))}), a value in the shader, or a line of a file of "
            f'bindings such as {slot.name} = "coc_scale / 2"'
        )
    bound = Binding(meaning, parsed(slot.name, meaning))
    parts = len(bound.tree.elts) if isinstance(bound.tree, ast.Tuple) else 1
    if parts != count:
        raise InputError(f"{slot.name}: is {slot.type}, {count} numbers; allowed are the {parts} of {meaning!r}")
    return bound


def _is_near(slot: Slot, keys: set[str]) -> bool:
    """Whether it is the near plane, which only those read whose depth is not linear, or may not be."""
    meaning = usual_number(slot.name, COUNTS.get(slot.type, 0), keys)
    return slot.kind == "uniform" and meaning in ("near", "near, far")


def _sampler(slot: Slot, meanings: Meanings) -> str | tuple[str, ...]:
    """A filter, or the textures whose filter it has."""
    reads = tuple(name for name in slot.reads if name in meanings.textures)
    if reads:
        return reads
    meaning = sampler_meaning(slot.name)
    if meaning in FILTERS:
        return str(meaning)
    alike = tuple(name for name, binding in meanings.textures.items() if binding.text == meaning)
    if alike:
        return alike
    raise InputError(
        f"{slot.name}: is a sampler of unknown meaning; allowed is one that is used beside a texture, a name such as "
        f'linearSampler or depthSampler, or a line of a file of bindings such as {slot.name} = "linear"'
    )


def _shared(name: str, textures: tuple[str, ...], filters: Mapping[str, str]) -> str:
    found = {filters[texture] for texture in textures}
    if len(found) > 1:
        kinds = ", ".join(f"{texture} is {filters[texture]}" for texture in textures)
        raise InputError(
            f"{name}: reads textures of several filters ({kinds}); allowed are one sampler each, textureLoad, "
            f'or a line of a file of bindings such as {name} = "linear"'
        )
    return found.pop()


def _numbers(slot: Slot, binding: Binding, numbers: Mapping[str, float]) -> list[float]:
    value = evaluate(binding.tree, numbers)
    parts = [float(part) for part in (value if isinstance(value, tuple) else (value,))]
    count = COUNTS.get(slot.type)
    if count != len(parts):
        raise InputError(f"bindings: {slot.name}: got {len(parts)} numbers; allowed are {count or 'none'}: {slot.type}")
    return parts


def _picture(name: str, value: Any, case: CaseValues) -> Float:
    """(H, W, C) float32, C up to 4."""
    planes = [np.atleast_3d(part) for part in (value if isinstance(value, tuple) else (value,))]
    if sum(plane.shape[2] for plane in planes) > 4:
        raise InputError(f"bindings: {name}: got {sum(plane.shape[2] for plane in planes)} channels; allowed are 4")
    shape = case.pictures["depth"].shape
    planes = [np.broadcast_to(plane, (*shape, plane.shape[2])) for plane in planes]
    with np.errstate(over="ignore"):
        return np.concatenate(planes, axis=2).astype(np.float32)
