"""WGSL fragment and compute shaders through wgpu, on Mesa's lavapipe: float32 textures in, a float32 picture out.

The only file that imports wgpu. Always the software renderer, for the reasons of `refdof.oracle.shaders.drawing.glsl`.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import wgpu

from .slots import Given, ShaderFault, Slot
from .wgsl_text import Module, compiler_message, module_of, vertex_shader

__all__ = ["WGSL"]

_FORMATS = {1: "r32float", 2: "rg32float", 4: "rgba32float"}
_LAYOUTS: dict[str, dict[str, Any]] = {
    "texture": {"texture": {"sample_type": "float", "view_dimension": "2d"}},
    "sampler": {"sampler": {"type": "filtering"}},
    "uniform": {"buffer": {"type": "uniform"}},
    "storage": {"storage_texture": {"access": "write-only", "format": "rgba32float", "view_dimension": "2d"}},
}
_KINDS = {"i": "<i4", "u": "<u4", "b": "<u4"}  # of int, ivec2 .., else float32


class WGSL:
    """A device and, after `compile`, a shader."""

    def __init__(self) -> None:
        try:
            adapters = wgpu.gpu.enumerate_adapters_sync()
        except Exception as error:  # each layer below has its own kind
            raise ShaderFault(f"there is no Vulkan (needs Mesa's lavapipe): {error}") from None
        software = [one for one in adapters if one.info["adapter_type"] == "CPU"]
        software = [one for one in software if one.info["backend_type"] == "Vulkan"]
        if not software:
            raise ShaderFault("there is no software renderer for Vulkan; needed is Mesa's lavapipe")
        self._device: Any = software[0].request_device_sync(required_features=["float32-filterable"])

    def compile(self, text: str) -> list[Slot]:
        """Compile a module and say what its entry point reads."""
        device = self._device
        try:
            self._code = device.create_shader_module(code=text)
            self._module = module_of(text)
            self._corner = device.create_shader_module(code=vertex_shader(self._module.inputs))
            self._groups = self._group_layouts(self._module)
            self._layout = device.create_pipeline_layout(bind_group_layouts=self._groups)
            if all(own for _, _, own in self._module.overrides.values()):
                self._pipeline({})
        except wgpu.GPUError as error:
            raise ShaderFault(compiler_message(str(error))) from None
        slots = [Slot(name, "uniform", kind, own) for name, (_, kind, own) in self._module.overrides.items()]
        for variable in self._module.variables:
            if variable.kind in ("texture", "sampler"):
                reads = self._module.samples.get(variable.name, ())
                slots.append(Slot(variable.name, variable.kind, variable.kind, False, reads))
            slots += [Slot(member.name, "uniform", member.type) for member in variable.members]
        return slots

    def draw(self, size: tuple[int, int], given: Given) -> np.ndarray:
        """Draw a picture (H, W, 3) of `size` (W, H)."""
        device, module = self._device, self._module
        usage = wgpu.TextureUsage.RENDER_ATTACHMENT | wgpu.TextureUsage.STORAGE_BINDING | wgpu.TextureUsage.COPY_SRC
        target = device.create_texture(size=(*size, 1), format="rgba32float", usage=usage | wgpu.TextureUsage.COPY_DST)
        self._write(target, np.full((size[1], size[0], 4), np.nan, "<f4"))  # what is not written is no number
        entries: list[list[dict[str, Any]]] = [[] for _ in self._groups]
        for one in module.variables:
            resource: Any
            if one.kind == "texture":
                resource = self._texture(given.textures[one.name]).create_view()
            elif one.kind == "sampler":
                chosen = given.filters[one.name]
                resource = device.create_sampler(mag_filter=chosen, min_filter=chosen)
            elif one.kind == "storage":
                resource = target.create_view()
            else:
                data = np.zeros(one.size, dtype=np.uint8)
                for member in one.members:
                    kind = _KINDS.get(member.type[0], "<f4")
                    numbers = np.array(given.uniforms[member.name]).astype(kind).view(np.uint8)
                    data[member.offset : member.offset + len(numbers)] = numbers
                buffer = device.create_buffer_with_data(data=data.tobytes(), usage=wgpu.BufferUsage.UNIFORM)
                resource = {"buffer": buffer, "offset": 0, "size": one.size}
            entries[one.group].append({"binding": one.binding, "resource": resource})
        bound = [
            device.create_bind_group(layout=layout, entries=bindings)
            for layout, bindings in zip(self._groups, entries, strict=True)
        ]
        constants = {
            key: given.uniforms[name][0] for name, (key, _, _) in module.overrides.items() if name in given.uniforms
        }
        self._run(self._pipeline(constants), bound, target, size)
        data = device.queue.read_texture(
            {"texture": target}, {"bytes_per_row": 16 * size[0], "rows_per_image": size[1]}, (*size, 1)
        )
        return np.frombuffer(data, dtype="<f4").reshape(size[1], size[0], 4)[:, :, :3]

    def _pipeline(self, constants: Mapping[str, float]) -> Any:
        stage = {"module": self._code, "entry_point": self._module.entry, "constants": constants}
        if self._module.stage == "compute":
            return self._device.create_compute_pipeline(layout=self._layout, compute=stage)
        return self._device.create_render_pipeline(
            layout=self._layout,
            vertex={"module": self._corner, "entry_point": "corner", "buffers": []},
            primitive={"topology": "triangle-list"},
            fragment={**stage, "targets": [{"format": "rgba32float"}]},
        )

    def _run(self, pipeline: Any, bound: list[Any], target: Any, size: tuple[int, int]) -> None:
        encoder = self._device.create_command_encoder()
        if self._module.stage == "compute":
            work = encoder.begin_compute_pass()
        else:
            view = {"view": target.create_view(), "load_op": "load", "store_op": "store"}
            work = encoder.begin_render_pass(color_attachments=[view])
        work.set_pipeline(pipeline)
        for group, one in enumerate(bound):
            work.set_bind_group(group, one)
        if self._module.stage == "compute":
            groups = (-(-side // step) for side, step in zip(size, self._module.workgroup, strict=True))
            work.dispatch_workgroups(*groups)
        else:
            work.draw(3)
        work.end()
        self._device.queue.submit([encoder.finish()])

    def _group_layouts(self, module: Module) -> list[Any]:
        stage = getattr(wgpu.ShaderStage, module.stage.upper())
        entries: list[list[dict[str, Any]]] = [
            [] for _ in range(max((one.group for one in module.variables), default=-1) + 1)
        ]
        for one in module.variables:
            entries[one.group].append({"binding": one.binding, "visibility": stage, **_LAYOUTS[one.kind]})
        return [self._device.create_bind_group_layout(entries=given) for given in entries]

    def _texture(self, image: np.ndarray) -> Any:
        """A texture of an image (H, W, C)."""
        height, width, components = image.shape
        if components == 3:
            image = np.concatenate([image, np.ones((height, width, 1), dtype=image.dtype)], axis=2)
        usage = wgpu.TextureUsage.TEXTURE_BINDING | wgpu.TextureUsage.COPY_DST
        made = self._device.create_texture(size=(width, height, 1), format=_FORMATS[image.shape[2]], usage=usage)
        self._write(made, image)
        return made

    def _write(self, texture: Any, image: np.ndarray) -> None:
        height, width, components = image.shape
        self._device.queue.write_texture(
            {"texture": texture},
            np.ascontiguousarray(image, dtype="<f4").tobytes(),
            {"bytes_per_row": 4 * width * components, "rows_per_image": height},
            (width, height, 1),
        )
