"""Ports in GLSL: their texts, faults in them, and one draw of a fragment shader into any number of float targets."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from refdof.stages import Staged
from tests.gl import shader
from tests.ports.cases import mutated

__all__ = ["Prepared", "drawn", "is_caught", "prepared", "source_of", "tolerances_off", "with_fault"]

_FOLDER = Path(__file__).parents[2] / "ports" / "glsl"


def source_of(name: str) -> str:
    """The text of ports/glsl/<name>.frag."""
    return (_FOLDER / f"{name}.frag").read_text()


def with_fault(sources: Mapping[str, str], fault: tuple[str, str, str]) -> dict[str, str]:
    """Shaders by name, with a fault in one of them: its name, what stands there, and what then does."""
    name, old, new = fault
    return {**sources, name: mutated(sources[name], old, new)}


def is_caught(cases: Iterable[np.ndarray]) -> bool:
    """Whether a fault shows in some case: `cases` are how many tolerances its stages are off, at worst.

    Two tolerances: a fault must be told from a right port, and not just. NaN is a fault, too.
    """
    return any(not (np.asarray(worst) <= 2.0).all() for worst in cases)


def tolerances_off(
    found: tuple[Mapping[str, Any], Any], answer: Staged, tolerances: Mapping[str, float]
) -> list[float]:
    """How many tolerances each of these stages is off at its worst, and the picture, "image"; `found` is a port's."""
    ours, theirs = {**answer.stages, "image": answer.image}, {**found[0], "image": found[1]}
    return [float(np.abs(theirs[name] - ours[name]).max() / room) for name, room in tolerances.items()]


@dataclass(frozen=True, eq=False)
class Prepared:
    """A shader with its textures, uniforms and float targets, which can be drawn any number of times."""

    work: shader.Pass
    targets: list[Any]
    textures: dict[str, Any]
    uniforms: dict[str, Any]

    def draw(self) -> None:
        shader.draw(self.work, self.textures, **self.uniforms)

    def pictures(self) -> list[np.ndarray]:
        """What it drew: (H, W, 4) float32 of each target."""
        shape = self.work.shape
        return [np.frombuffer(target.read(alignment=4), dtype="f4").reshape(shape).copy() for target in self.targets]

    def release(self) -> None:
        """Leave nothing on the device."""
        for thing in (*self.textures.values(), self.work.target, *self.targets, self.work.triangle, self.work.program):
            thing.release()


def prepared(
    context: Any, source: str, shape: tuple[int, int], textures: dict[str, Any], outputs: int = 1,
    linear: tuple[str, ...] = (), **uniforms: Any,
) -> Prepared:  # fmt: skip
    """A shader over (H, W) pixels of as many targets as it has outputs.

    textures: images (H, W) or (H, W, C), layers (N, H, W, C), or a list of mip levels (h, w, 4), by the sampler's name.
    Levels are read trilinearly, images in `linear` bilinearly, all else at the nearest texel.
    A fault may leave a name unused, which the compiler then drops: it is passed over.
    """
    height, width = shape
    program = context.program(vertex_shader=shader._FULL_SCREEN_TRIANGLE, fragment_shader=source)
    targets = [context.texture((width, height), 4, dtype="f4") for _ in range(outputs)]
    work = shader.Pass(program, context.vertex_array(program, []), context.framebuffer(targets), (height, width, 4))
    bound = {name: _texture(context, image, name in linear) for name, image in textures.items() if name in program}
    return Prepared(work, targets, bound, {name: value for name, value in uniforms.items() if name in program})


def drawn(
    context: Any, source: str, shape: tuple[int, int], textures: dict[str, Any], outputs: int = 1,
    linear: tuple[str, ...] = (), **uniforms: Any,
) -> list[np.ndarray]:  # fmt: skip
    """What a shader draws over (H, W) pixels: (H, W, 4) float32 of each of its outputs, as in `prepared`."""
    ready = prepared(context, source, shape, textures, outputs, linear, **uniforms)
    ready.draw()
    pictures = ready.pictures()
    ready.release()
    return pictures


def _texture(context: Any, image: Any, linear: bool) -> Any:
    if isinstance(image, list):
        return shader.chain_of(context, image)
    if image.ndim < 4:
        return shader.texture_of(context, image, linear=linear)
    image = np.ascontiguousarray(image, dtype="f4")
    count, height, width, components = image.shape
    texture = context.texture_array((width, height, count), components, image.tobytes(), alignment=4, dtype="f4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    texture.repeat_x = texture.repeat_y = False
    return texture
