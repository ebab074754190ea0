"""Right ports written otherwise: other orders of operations, other legal texels at ties. None may fail."""

from typing import NamedTuple

from tests.oracle.mutations.row import text_of

__all__ = ["VARIANTS", "Variant"]


class Variant(NamedTuple):
    """A right port: some replacements in a port's text."""

    port: str
    name: str
    changes: tuple[tuple[str, str], ...]

    @property
    def text(self) -> str:
        """The changed text."""
        return text_of(self.port, *self.changes)


_C = (
    ("as it is",),
    ("unrolled, and with other roundings",
     ("static void depth_of_field(",
      '__attribute__((optimize("fast-math", "unroll-loops"))) static void depth_of_field(')),
    ("mix by a difference",
     ("color[c] / total * (1.0f - m) + color_at(p, tap_u, tap_v, c) * m",
      "color[c] / total + (color_at(p, tap_u, tap_v, c) - color[c] / total) * m")),
    ("fused multiplication and addition", ("return a * (1.0f - down) + b * down;", "return fmaf(b - a, down, a);")),
    ("squares of depths are compared",
     ("p->depth[texel] > p->depth[center]", "p->depth[texel] * p->depth[texel] > p->depth[center] * p->depth[center]")),
    ("inverse depths are compared",
     ("p->depth[texel] > p->depth[center]", "1.0f / p->depth[texel] < 1.0f / p->depth[center]")),
    ("signed circles are compared", ("p->depth[texel] > p->depth[center]", "p->coc[texel] > p->coc[center]")),
    ("places in double precision",
     ("u + cosf(angle) * pixel_u * radius", "(float)(u + cos(angle) * pixel_u * radius)"),
     ("v + sinf(angle) * pixel_v * radius * p->row_step", "(float)(v + sin(angle) * pixel_v * radius * p->row_step)")),
    ("places in pixels",
     ("u + cosf(angle) * pixel_u * radius", "((float)x + 0.5f + cosf(angle) * radius) / (float)p->width"),
     ("v + sinf(angle) * pixel_v * radius * p->row_step",
      "((float)y + 0.5f + sinf(angle) * radius * p->row_step) / (float)p->height")),
    ("the texel before the border", ("floorf(u * (float)p->width)", "ceilf(u * (float)p->width) - 1.0f")),
    ("the texel behind the border", ("floorf(u * (float)p->width)", "floorf(u * (float)p->width + 1e-5f)")),
    ("circles are cut with their sign",
     ("fminf(fabsf(p->coc[texel]), p->max_blur_size)",
      "fabsf(fmaxf(fminf(p->coc[texel], p->max_blur_size), -p->max_blur_size))")),
    ("powers written otherwise", ("return t * t * (3.0f - 2.0f * t);", "return 3.0f * t * t - 2.0f * t * t * t;")),
    ("taps of no weight are not read",
     ("color[c] / total * (1.0f - m) + color_at(p, tap_u, tap_v, c) * m",
      "m > 0.0f ? color[c] / total * (1.0f - m) + color_at(p, tap_u, tap_v, c) * m : color[c] / total")),
)  # fmt: skip

_GLSL = (
    ("as it is",),
    ("coordinates of a varying",
     ("uniform vec2 uPixelSize;", "uniform vec2 uPixelSize; in vec2 vTexCoord;"),
     ("depthOfField(gl_FragCoord.xy * uPixelSize)", "depthOfField(vTexCoord)")),
    ("the size of the picture by a quotient",
     ("gl_FragCoord.xy * uPixelSize)", "gl_FragCoord.xy / (1.0 / uPixelSize))")),
    ("mix written out", ("mix(color / total, tapColor, m)", "color / total * (1.0 - m) + tapColor * m")),
    ("smoothstep written out",
     ("float m = smoothstep(radius - 0.5, radius + 0.5, tapSize);",
      "float t = clamp(tapSize - radius + 0.5, 0.0, 1.0); float m = t * t * (3.0 - 2.0 * t);")),
    ("squares of depths are compared",
     ("tapDepth > centerDepth", "tapDepth * tapDepth > centerDepth * centerDepth")),
    ("inverse depths are compared", ("tapDepth > centerDepth", "1.0 / tapDepth < 1.0 / centerDepth")),
    ("depth by integer coordinates",
     ("texture(uDepth, place).r * uFar",
      "texelFetch(uDepth, clamp(ivec2(floor(place / uPixelSize)), ivec2(0), textureSize(uDepth, 0) - 1), 0).r * uFar")),
    ("the texel behind the border", ("texture(uDepth, place)", "texture(uDepth, place + 1e-7)")),
    ("the texel before the border", ("texture(uDepth, place)", "texture(uDepth, place - 1e-7)")),
    ("angles are multiples",
     ("float radius = uRadScale;", "float radius = uRadScale; float tap = 0.0;"),
     ("vec2(cos(angle), sin(angle))", "vec2(cos(tap * GOLDEN_ANGLE), sin(tap * GOLDEN_ANGLE))"),
     ("total += 1.0;", "total += 1.0; tap += 1.0;")),
    ("sizes relative to the largest",
     ("return abs(coc) * uMaxBlurSize;", "return min(abs(coc * uMaxBlurSize), uMaxBlurSize);")),
    ("clamp for min", ("min(tapSize, centerSize * uBehindFactor)", "clamp(tapSize, 0.0, centerSize * uBehindFactor)")),
)  # fmt: skip

_WGSL = (
    ("as it is",),
    ("mix written out",
     ("mix(color / total, colorAt(place), m)", "color / total * (1.0 - m) + colorAt(place) * m")),
    ("one step of fma for a place",
     ("texCoord + vec2f(cos(angle), sin(angle)) * settings.uPixelSize * radius",
      "fma(vec2f(cos(angle), sin(angle)), settings.uPixelSize * radius, texCoord)")),
    ("depth by integer coordinates",
     ("textureSampleLevel(uDepth, depthSampler, place, 0.0).r",
      "textureLoad(uDepth, clamp(vec2i(floor(place / settings.uPixelSize)), vec2i(0), "
      "vec2i(textureDimensions(uDepth)) - 1), 0).r")),
)  # fmt: skip

_HOST = (
    ("depth in scene units", ("stored = depth / far", "stored = depth"), ('"uFar": far,', '"uFar": 1.0,')),
    ("colour with alpha",
     ("texture_of(context, color,", "texture_of(context, np.pad(color, ((0, 0), (0, 0), (0, 1))),")),
    ("the result as NPY", ('image.astype("<f4").tofile(out / "image.f32")', 'np.save(out / "image.npy", image)')),
)  # fmt: skip

VARIANTS = tuple(
    Variant(port, name, tuple(changes))
    for port, rows in (("c", _C), ("glsl", _GLSL), ("wgsl", _WGSL), ("host", _HOST))
    for name, *changes in rows
)
