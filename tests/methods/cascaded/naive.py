"""Naive twin of the cascaded layers, after the paper's equations in its own units: depths and diameters in metres.

Everything is float64; layers are kept, one after the other, and convolved tap by tap in two dimensions.
"""

import math

import numpy as np


class Lens:
    """A camera of the paper: focal length f, f-number, focus distance [m], pixel pitch on the sensor [m]."""

    def __init__(self, f, f_number, z_focus, pitch):
        self.f, self.n, self.z_focus, self.pitch = f, f_number, z_focus, pitch

    def coc(self, z):
        """Eq. (1), a diameter."""
        return abs(self.f**2 * (z - self.z_focus) / (z * self.n * (self.z_focus - self.f)))

    def d1(self, d):
        """Eq. (6): in front of the focal plane."""
        return self.z_focus * self.f**2 / (self.f**2 + d * self.n * (self.z_focus - self.f))

    def d2(self, d):
        """Eq. (7): behind it; infinite where Eq. (8) does not hold."""
        if not d < self.f**2 / (self.n * (self.z_focus - self.f)):
            return math.inf
        return self.z_focus * self.f**2 / (self.f**2 - d * self.n * (self.z_focus - self.f))

    def layer_coc(self, n):
        """Eqs. (10), (14), (15): d = 4 sigma, sigma^2 summed up step by step."""
        variance = 0.0
        for step in range(1, n + 1):
            variance += step**2
        return 4.0 * math.sqrt(variance) * self.pitch

    def anchor(self, k, k_focus):
        """Eq. (9)."""
        mean = (self.layer_coc(abs(k - k_focus)) + self.layer_coc(abs(k + 1 - k_focus))) / 2.0
        return self.d1(mean) if k < k_focus else self.d2(mean)


def layer_count(lens, z_near, z_far):
    """(k_focus, K): the fewest layers whose extended cores hold the nearest and the farthest depth."""
    front = back = 0
    while lens.anchor(-front - 1, 0) > z_near:
        front += 1
    while lens.anchor(back, 0) < z_far:
        back += 1
    return front, front + back + 1


def weight(lens, z, k, k_focus, count, first, boundary):
    """Eqs. (3) and (4), the falling ramp put right; layers 0 and K - 1 reach to the eye and to infinity.

    In their cores the ramps of layers 1 and K - 2 end at the anchor that one more layer would have, or ("hard") there
    are none.
    """

    def anchor(i):
        return lens.anchor(i, k_focus)

    low = -math.inf if k == 0 else anchor(k - 1)
    high = math.inf if k == count - 1 else anchor(k)
    if low <= z <= high:
        return 1.0
    if boundary == "hard" and ((z < low and k == 1) or (z > high and k == count - 2)):
        return 0.0
    if z < low:
        return max((z - anchor(k - 2)) / (low - anchor(k - 2)), 0.0)
    if not first:
        return 0.0
    if math.isinf(anchor(k + 1)):
        return (1.0 / z) / (1.0 / high)  # a ramp to infinity, in 1 / z
    return max((anchor(k + 1) - z) / (anchor(k + 1) - high), 0.0)


def over(a, b):
    return a + (1.0 - a[..., 3:]) * b


def blurred(image, sigma, border):
    """A Gaussian up to 3 sigma, tap by tap; outside is the nearest pixel ("clamp"), or 0."""
    if sigma == 0.0:
        return image
    reach = math.ceil(3.0 * sigma)
    height, width = image.shape[:2]
    out, total = np.zeros_like(image), 0.0
    for dx in range(-reach, reach + 1):
        for dy in range(-reach, reach + 1):
            tap = math.exp(-(dx * dx + dy * dy) / (2.0 * sigma * sigma))
            total += tap
            for y, x in np.ndindex(height, width):
                j, i = min(max(y - dy, 0), height - 1), min(max(x - dx, 0), width - 1)
                if border == "clamp" or (j, i) == (y - dy, x - dx):
                    out[y, x] += tap * image[j, i]
    return out / total


def layers(color, depth, lens, boundary):
    """Eq. (2): (k_focus, the K layers (H, W, 4)) of color (M, H, W, 3) and depth (M, H, W), NaN for no surface."""
    present = depth[~np.isnan(depth)]
    k_focus, count = layer_count(lens, present.min(), present.max())
    made = []
    for k in range(count):
        layer = np.zeros((*depth.shape[1:], 4))
        for y, x in np.ndindex(depth.shape[1:]):
            for m in range(len(depth)):
                if not np.isnan(depth[m, y, x]):
                    w = weight(lens, depth[m, y, x], k, k_focus, count, m == 0, boundary)
                    layer[y, x] = over(layer[y, x], np.append(w * color[m, y, x], w))
        made.append(layer)
    return k_focus, made


def picture(color, depth, lens, cascade, border, boundary):
    """The whole method: (H, W, 3)."""
    k_focus, parts = layers(color, depth, lens, boundary)
    empty = np.zeros_like(parts[0])
    if cascade:

        def composed(k):  # Eq. (13)
            if k == k_focus:
                return parts[k]
            inner = k + 1 if k > k_focus else k - 1
            if not 0 <= inner < len(parts):
                return blurred(parts[k], abs(k - k_focus), border)
            both = over(parts[k], composed(inner)) if k > k_focus else over(composed(inner), parts[k])
            return blurred(both, abs(k - k_focus), border)

        front = composed(k_focus - 1) if k_focus > 0 else empty
        back = composed(k_focus + 1) if k_focus + 1 < len(parts) else empty
        whole = over(front, over(parts[k_focus], back))  # Eq. (12)
    else:
        whole = empty
        for k in range(len(parts)):
            n = abs(k - k_focus)
            whole = over(whole, blurred(parts[k], math.sqrt(sum(i * i for i in range(n + 1))), border))  # Eq. (11)
    return whole[..., :3] / whole[..., 3:]
