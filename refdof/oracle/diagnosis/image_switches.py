"""Image switches: mistakes of what is done to colours, and to the picture as a whole."""

from dataclasses import replace
from typing import Any

from refdof.oracle.diagnosis.model import Model, Operations
from refdof.oracle.diagnosis.samples import Shot
from refdof.oracle.diagnosis.switches import Change, Switch, setting

__all__ = ["image_switches"]

_ENCODE, _DECODE = 1.0 / 2.2, 2.2
_GAMMAS: dict[str, tuple[Operations, Operations]] = {
    "output is encoded by a gamma of 2.2": ((), (("gamma", _ENCODE),)),
    "output is cut at 1 and encoded by a gamma of 2.2": ((), (("clamp_gamma", _ENCODE),)),
    "output is encoded as sRGB": ((), (("srgb_encode", 0.0),)),
    "output is cut at 1 and encoded as sRGB": ((), (("clamp_srgb_encode", 0.0),)),
    "output is decoded by a gamma of 2.2": ((), (("gamma", _DECODE),)),
    "output is decoded as sRGB": ((), (("srgb_decode", 0.0),)),
    "input is encoded by a gamma of 2.2": ((("gamma", _ENCODE),), ()),
    "input is encoded as sRGB": ((("srgb_encode", 0.0),), ()),
    "input is decoded by a gamma of 2.2": ((("gamma", _DECODE),), ()),
    "input is decoded as sRGB": ((("srgb_decode", 0.0),), ()),
    "colours are blurred with a gamma of 2.2": ((("gamma", _ENCODE),), (("gamma", _DECODE),)),
    "colours are blurred as sRGB": ((("srgb_encode", 0.0),), (("srgb_decode", 0.0),)),
    "colours are decoded by a gamma of 2.2, blurred and encoded": ((("gamma", _DECODE),), (("gamma", _ENCODE),)),
    "colours are decoded as sRGB, blurred and encoded": ((("srgb_decode", 0.0),), (("srgb_encode", 0.0),)),
}
_TONES: dict[str, tuple[str, float]] = {
    "Reinhard": ("reinhard", 0.0), "1 - exp(-colour)": ("exposure", 1.0), "ACES": ("aces", 0.0),
}  # fmt: skip
_ROUNDINGS: dict[str, tuple[str, float]] = {
    "8 bits": ("levels", 255.0), "10 bits": ("levels", 1023.0), "half floats": ("half_float", 0.0),
}  # fmt: skip
_EARLY = {
    ("sharp", 0.1), ("sharp", 0.25), ("sharp", 0.5), ("sharp", 1.0), ("sharp", 1.5), ("sharp", 2.0), ("sharp", 3.0),
    ("sky", 1.0), ("sky", 0.99), ("sky", 0.9),
}  # fmt: skip


def image_switches() -> list[Switch]:
    """Mistakes of the stage image."""
    return [*_colors(), *_pictures()]


def _then(model: Model, before: Operations, after: Operations) -> Model:
    return replace(model, before=model.before + before, after=model.after + after)


def _after(name: str) -> Change:
    return lambda model, value: _then(model, (), ((name, value),))


def _before(name: str) -> Change:
    return lambda model, value: _then(model, ((name, value),), ())


def _colors() -> list[Switch]:
    def named(table: dict[str, tuple[str, float]], early: bool) -> Change:
        def change(model: Model, value: str) -> Model:
            return _then(model, (table[value],), ()) if early else _then(model, (), (table[value],))

        return change

    gains = (0.25, 0.5, 0.8, 0.98, 0.995, 1.005, 1.02, 1.25, 2.0, 4.0)
    offsets = (-0.5, -0.1, -0.01, -0.002, 0.002, 0.01, 0.1, 0.5)
    said = {"gain": gains, "offset": offsets}
    return [
        Switch(
            "gamma",
            lambda model, value: _then(model, *_GAMMAS[value]),
            tuple(_GAMMAS),
            lambda s, v: {"words": v, "value": ""},
        ),
        Switch("gamma", _after("gamma"), (0.3, 0.4, 0.6, 0.8, 1.2, 1.8, 2.4), _power, fits=True),
        Switch("tone_map", named(_TONES, False), tuple(_TONES), lambda s, v: {"words": v}),
        Switch("tone_map", named(_TONES, True), tuple(_TONES), lambda s, v: {"words": f"{v}, before the blur"}),
        Switch("clamp", _after("clamp"), (1.0,), lambda s, v: {"value": v, "words": ""}),
        Switch("clamp", _before("clamp"), (1.0,), lambda s, v: {"value": v, "words": " before the blur"}),
        *(Switch(name, _after(name), values, fits=True) for name, values in said.items()),
        Switch(
            "channels",
            lambda model, value: _then(model, (), ((value, 0.0),)),
            ("BGR", "GRB", "RBG", "GBR", "BRG", "RRR", "grey"),
            lambda s, v: {"words": v},
        ),
        Switch("quantized", named(_ROUNDINGS, False), tuple(_ROUNDINGS), lambda s, v: {"words": v}),
        Switch("quantized", named(_ROUNDINGS, True), tuple(_ROUNDINGS), lambda s, v: {"words": f"{v} before the blur"}),
    ]


def _power(shot: Shot, value: float) -> dict[str, Any]:
    return {"words": "output is raised to the power of ", "value": value}


def _pictures() -> list[Switch]:
    shifts = [(x, y) for y in (-1, 0, 1) for x in (-1, 0, 1) if (x, y) != (0, 0)] + [(2, 0), (-2, 0), (0, 2), (0, -2)]

    def early(shot: Shot, value: tuple[str, float]) -> dict[str, Any]:
        words = f"with circles below {value[1]:.4g} px" if value[0] == "sharp" else "at the far plane"
        return {"words": words}

    def half(model: Model, value: float) -> Model:
        moved = (model.shift_color[0] + value, model.shift_color[1] + value)
        return replace(model, half=True, shift_color=moved, shift_center_color=moved)

    axes = {"x": "left to right", "y": "top to bottom", "xy": "both ways"}
    return [
        Switch("flipped", setting("flip"), tuple(axes), lambda s, v: {"words": axes[v]}),
        Switch("image_shift", setting("image_shift"), shifts, lambda s, v: {"x": v[0], "y": v[1]}),
        Switch("half_resolution", half, (0.0, 0.5)),
        Switch("early_out", setting("early_out"), sorted(_EARLY), early),
        Switch("no_blur", setting("max_taps"), (0,)),
    ]
