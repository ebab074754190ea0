"""glTF files: their header, cameras, node animation, skins and morph targets."""
