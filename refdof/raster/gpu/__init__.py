"""GPU: triangles, depth and textures, rounded as a graphics pipeline rounds them."""
