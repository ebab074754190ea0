"""Materials as rays and rasteriser read them: texels, and how opaque a surface is."""
