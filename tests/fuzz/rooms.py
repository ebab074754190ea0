"""Rooms: the code of each target that is watched for new paths. It must be known before any of it is imported."""

ROOMS = {
    "gltf": ("refdof.scene.gltf", "refdof.scene.mesh_file"),
    "glb": ("refdof.scene.gltf", "refdof.scene.mesh_file"),
    "obj": ("refdof.scene.formats", "refdof.scene.mesh_file"),
    "ply": ("refdof.scene.formats", "refdof.scene.mesh_file"),
    "off": ("refdof.scene.formats", "refdof.scene.mesh_file"),
    "stl": ("refdof.scene.formats", "refdof.scene.mesh_file"),
    "texture": ("refdof.scene.formats",),
    "png": ("refdof.image",),
    "exr": ("refdof.image",),
    "hdr": ("refdof.image",),
    "npy": ("refdof.image",),
    "scene_toml": ("refdof.scene.kit.shot", "tomllib"),
    "lens_toml": ("refdof.optics.systems", "tomllib"),
    "lens_dat": ("refdof.optics.systems",),
    "lens_zmx": ("refdof.optics.systems",),
    "focus_toml": ("refdof.focus.focus_file", "refdof.focus.point", "tomllib"),
    "waivers": ("refdof.oracle.waivers", "tomllib"),
    "pack": ("refdof.oracle.files", "refdof.oracle.expectation", "json"),
    "settings": ("refdof.settings", "refdof.rendering", "refdof.options", "refdof._check"),
}
