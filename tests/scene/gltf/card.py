"""A glTF card by hand: a quad of 2 x 1 in the plane z = 0, whose parts a test changes."""

import io
import json

import numpy as np
from PIL import Image

from tests.animated_gltf import Builder
from tests.mesh_fixtures import uri

PLACES = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], dtype=np.float32)
UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], dtype=np.float32)  # v runs downwards
FACES = [[0, 1, 2], [0, 2, 3]]


class Card(Builder):
    """The quad is node 0 with mesh 0, one primitive, and material 0 if there is one."""

    def __init__(self, material=None, places=PLACES, faces=FACES, **attributes):
        super().__init__()
        named = {"TEXCOORD_0": UV, **attributes}
        words = {} if material is None else {"material": 0}
        self.node(root=True, mesh=self.mesh((places, faces, named, words)))
        if material is not None:
            self.header["materials"] = [material]

    @property
    def primitive(self):
        return self.header["meshes"][0]["primitives"][0]

    def picture(self, pixels, kind="png", sampler=None, **words):
        """One more texture; returns its number."""
        out = io.BytesIO()
        Image.fromarray(np.asarray(pixels, dtype=np.uint8)).save(out, kind, **words)
        return self.texture(uri(f"image/{kind}", out.getvalue()), sampler)

    def texture(self, address, sampler=None):
        images, textures = (self.header.setdefault(key, []) for key in ("images", "textures"))
        images.append({"uri": address})
        textures.append({"source": len(images) - 1})
        if sampler is not None:
            samplers = self.header.setdefault("samplers", [])
            samplers.append(sampler)
            textures[-1]["sampler"] = len(samplers) - 1
        return len(textures) - 1

    def uses(self, *names, required=False):
        self.header["extensionsUsed"] = [*self.header.get("extensionsUsed", []), *names]
        if required:
            self.header["extensionsRequired"] = [*self.header.get("extensionsRequired", []), *names]
        return self

    def beside(self, folder, name):
        """Write the file with its buffer beside, under this name."""
        (folder / name).write_bytes(self.data)
        return json.dumps({**self.header, "buffers": [{"byteLength": len(self.data), "uri": name.replace(" ", "%20")}]})


def base(texture=None, **words):
    """A material with a texture of the base colour."""
    rough = {} if texture is None else {"baseColorTexture": {"index": texture}}
    return {"pbrMetallicRoughness": rough, **words}
