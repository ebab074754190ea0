"""Usual names: what shaders call the pictures and numbers of depth of field, in the words of expressions.

A name is taken without prefixes such as u_, u or t before a capital, without underscores and in lower case: uPixelSize,
u_pixel_size and pixelSize are one.
"""

import re

__all__ = ["known_names", "sampler_meaning", "usual_number", "usual_texture"]

_TEXTURES = {
    "color": """texture tex color colour colortexture colourtexture colortex texturecolor texcolor colormap colorbuffer
        diffuse diffmap diffusemap diffusetexture scene scenetexture scenecolor scenetex image img
        input inputtexture inputimage inputbuffer inputcolor
        inputimagetexture inputtex source sourcetexture src maintex maintexture channel0 tex0 texture0 colortex0
        framebuffer frame screen screentexture screentex rendertexture renderedtexture rendered basetexture
        bglrenderedtexture map backbuffer rt rgb""",
    "depth / far": """depth depthtexture depthtex texturedepth texdepth depthmap depthbuffer depthimage scenedepth
        lineardepth lineardepthtexture zbuffer depthsampler sceneDepthTexture depthsource depthtex0 bgldepthtexture
        cameradepthtexture depthscene""",
    "coc": """coc coctexture coctex texturecoc cocmap cocbuffer circleofconfusion circles coctex0""",
}
_NUMBERS = {
    "1 / width, 1 / height": """pixelsize texelsize texel pixel onepixel invresolution inverseresolution invsize
        rcpresolution resolutioninverse invscreensize inversesize texturetexelsize maintextexelsize texeldelta
        gbufferinvsize invtexturesize pixelstep texelstep screenpixelsize invviewport""",
    "width, height": """resolution res size screensize texturesize viewport viewportsize imagesize renderersize
        windowsize screenresolution viewresolution framesize rendersize textureresolution dimensions bufferresolution
        screen""",
    "width": "width texturewidth screenwidth imagewidth renderwidth bglrenderedtexturewidth viewportwidth viewwidth",
    "height": """height textureheight screenheight imageheight renderheight bglrenderedtextureheight viewportheight
        viewheight""",
    "1 / width": "texelwidth pixelwidth invwidth",
    "1 / height": "texelheight pixelheight invheight",
    "width / height": "aspect aspectratio",
    "far": "far zfar farz camerafar farplane farclip farclipplane cameraFarPlane fardistance maxdepth depthfar camfar",
    "near": "near znear nearz cameranear nearplane nearclip nearclipplane neardistance mindepth depthnear camnear",
    "near, far": "nearfar cameranearfar clipplanes",
    "focus": """focus focuspoint focusdistance focusdepth focaldepth focaldistance focalplane focalpoint focuspos
        focusplane focalplanedistance""",
    "coc_scale / max_blur_size": "focusscale",
    "coc_scale": "cocscale",
    "max_blur_size": """maxblursize maxblur maxcoc maxradius maxblurradius maxcocradius maxcocsize
        maxbokehsize""",
    "rad_scale": "radscale radiusscale radiusstep",
    "behind_factor": "behindfactor",
    "angle_step": "goldenangle",
    "row_step": "rowstep",
    "0": "time frame timedelta deltatime framerate seed",
    "0, 0, 0, 0": "mouse",
}
_WIDER = {
    ("width, height", 3): "width, height, 1",
    ("width, height", 4): "width, height, 1 / width, 1 / height",
    ("1 / width, 1 / height", 4): "1 / width, 1 / height, width, height",
}


def _plain(name: str) -> str:
    """A name without prefix, underscores and case."""
    bare = re.sub(r"^(?:[ugmst]_|_)|^[utsgmic](?=[A-Z])", "", name)
    return bare.replace("_", "").lower()


def _table(words: dict[str, str]) -> dict[str, str]:
    return {word.lower(): meaning for meaning, listed in words.items() for word in listed.split()}


_TEXTURE_OF, _NUMBER_OF = _table(_TEXTURES), _table(_NUMBERS)


def usual_texture(name: str) -> str | None:
    """What a texture of this name holds, as an expression."""
    return _TEXTURE_OF.get(_plain(name))


def usual_number(name: str, count: int, keys: set[str]) -> str | None:
    """What `count` numbers of this name are, as an expression over `keys`, the names of a case's numbers."""
    word = _plain(name)
    meaning = _NUMBER_OF.get(word) or next((key for key in sorted(keys) if key.replace("_", "") == word), None)
    return None if meaning is None else _WIDER.get((meaning, count), meaning)


def known_names(kind: str) -> str:
    """One usual name for each meaning: for errors."""
    words = _TEXTURES if kind == "texture" else _NUMBERS
    return ", ".join(listed.split()[0] for listed in words.values())


def sampler_meaning(name: str) -> str | None:
    """A filter, or what the texture holds that a sampler of this name is for."""
    word = _plain(name)
    for part in ("sampler", "samp", "smp"):
        word = word.replace(part, "")
    filters = {"linear": "linear", "bilinear": "linear", "nearest": "nearest", "point": "nearest"}
    return filters.get(word) or _TEXTURE_OF.get(word)
