"""Shaders of porters, drawn without a host of theirs: GLSL through moderngl, WGSL through wgpu."""

from refdof.oracle.shaders.source import ShaderSource, of_shader

__all__ = ["ShaderSource", "of_shader"]
