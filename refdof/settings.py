"""Settings: parameters of methods, as words of the command line."""

from typing import Any

from refdof._check import InputError
from refdof.rendering import make_params

__all__ = ["setting_of", "settings_by_method", "settings_of"]


def settings_of(texts: list[str], **options: Any) -> dict[str, Any]:
    """'key=value' lines, and options of the same meaning where they are given, as {key: value}."""
    values: dict[str, Any] = {}
    pairs = [setting_of(text) for text in texts]
    for key, value in [*pairs, *((name, value) for name, value in options.items() if value is not None)]:
        if key in values:
            got = f"{values[key]!r:.80} and {value!r:.80}"
            raise InputError(f"{key[:80]}: got {got}; allowed is one value")
        values[key] = value
    return values


def setting_of(text: str) -> tuple[str, Any]:
    """'key=value' as a name and a number, a truth value or a word."""
    key, equals, value = text.partition("=")
    if not equals or not key or not key.isprintable():
        raise InputError(f"set: got {text[:80]!r}; allowed is KEY=VALUE")
    for parse in (int, float, {"true": True, "false": False, "None": None}.__getitem__):
        try:
            return key, parse(value)
        except (ValueError, KeyError):
            continue
    return key, value


def settings_by_method(texts: list[str], methods: list[str], presets: list[str]) -> dict[str, dict[str, Any]]:
    """'method.key=value' lines as {method: {key: value}}."""
    params: dict[str, dict[str, Any]] = {name: {} for name in methods}
    for key, value in settings_of(texts).items():
        method, dot, field = key.partition(".")
        if not dot or method not in params:
            known = f", METHOD one of {', '.join(methods)}"
            raise InputError(f"set: got {f'{key}={value}'[:80]!r}; allowed is METHOD.KEY=VALUE{known}")
        params[method][field] = value
    for method, values in params.items():
        for preset in presets:
            make_params(method, values, preset)
    return params
