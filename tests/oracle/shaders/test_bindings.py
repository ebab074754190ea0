"""Bindings of shaders in GLSL: what names mean, by a file, and files that are refused."""

import pytest

from refdof import InputError
from tests.oracle.shaders.cases import CONSTANTS, DEVICE, REVERSED, statuses, varying
from tests.ports.cases import mutated

pytestmark = pytest.mark.gl

SUFFIX = "frag"


@pytest.mark.parametrize(("depth", "word"), [(DEVICE, "device"), (REVERSED, "reversed")])
def test_depth_of_other_kinds_has_to_be_named(outcomes, depth, word):
    with pytest.raises(InputError, match=r"^tDepth: may hold depth of several kinds.*cameraNear"):
        outcomes(varying(depth))
    assert statuses(outcomes(varying(depth), f'tDepth = "{word}"')) == CONSTANTS


def test_depth_in_alpha(outcomes):
    text = varying().replace("texture2D(tDepth, p).r", "texture2D(tDepth, p).a")
    bindings = 'tDepth = { value = "color, depth / far", filter = "nearest" }'
    assert statuses(outcomes(text, bindings)) == CONSTANTS


def test_bindings_give_numbers_by_expressions(outcomes):
    text = mutated(varying(), "uniform float focusDistance, focusScale;", "uniform float uInverse, uStrength;")
    text = mutated(text, "gather(vUv, focusDistance, focusScale)", "gather(vUv, 1.0 / uInverse, uStrength)")
    bindings = 'uInverse = "1 / focus"\nuStrength = "coc_scale / max_blur_size"\n'
    assert statuses(outcomes(text, bindings)) == CONSTANTS
    assert statuses(outcomes(text, bindings.replace("/ max_blur_size", "/ 10")))[:4] != ["pass"] * 4


@pytest.mark.parametrize(
    ("bindings", "said"),
    [
        ("tDepth =", "bindings: got .*allowed is a TOML file"),
        ('tDeep = "device"', "bindings: tDeep: is not read by the shader; allowed are .*tDepth"),
        ('tDepth = "depht / far"', "bindings: tDepth: got .*allowed are the names color, depth"),
        ('tDepth = "__import__(1)"', "bindings: tDepth: got .*allowed are numbers"),
        ('tDepth = "far"', "bindings: tDepth: got 'far'; allowed is a picture"),
        ('tDepth = { value = "depth", filter = "cubic" }', "bindings: tDepth: filter"),
        ('tDepth = "color, depth, coc"', "bindings: tDepth: got 5 channels; allowed are 4"),
        ('texelSize = "far"', "bindings: texelSize: got 1 numbers; allowed are 2"),
        ('texelSize = "coc"', "bindings: texelSize: got 'coc'; allowed are the names angle_start"),
    ],
)
def test_bad_bindings(outcomes, bindings, said):
    with pytest.raises(InputError, match=said):
        outcomes(varying(), bindings)
