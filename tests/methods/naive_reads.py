"""Texture reads for naive twins, in plain Python."""


def read(image, x, y):
    """Bilinear, clamped to the edge; texel (i, j) has its centre at (i + 0.5, j + 0.5)."""
    height, width = image.shape[:2]
    x, y = min(max(x - 0.5, 0.0), width - 1.0), min(max(y - 0.5, 0.0), height - 1.0)
    i, j = min(int(x), max(width - 2, 0)), min(int(y), max(height - 2, 0))
    total = 0.0
    for row in (j, min(j + 1, height - 1)):
        for column in (i, min(i + 1, width - 1)):
            wide = max(0.0, 1.0 - abs(x - column)) if width > 1 else 0.5
            high = max(0.0, 1.0 - abs(y - row)) if height > 1 else 0.5
            total = total + wide * high * image[row, column]
    return total
