"""Naive twins of the artefact metrics: plain loops over pixels, without arrays, written from docs/metrics.md."""

import math


def pairs(coc):
    """Depth edges: every two neighbours whose circles jump, beyond the slope on either side."""
    height, width = len(coc), len(coc[0])
    found = []
    for y in range(height):
        for x in range(width):
            for dy, dx in ((1, 0), (0, 1)):
                v, u = y + dy, x + dx
                if v >= height or u >= width:
                    continue
                jump = coc[v][u] - coc[y][x]
                before = coc[y][x] - coc[y - dy][x - dx] if y >= dy and x >= dx else 0.0
                after = coc[v + dy][u + dx] - coc[v][u] if v + dy < height and u + dx < width else 0.0
                if abs(jump) > 0.5 and abs(jump - before) > 0.5 and abs(jump - after) > 0.5:
                    found.append(((y, x), (v, u)))
    return found


def nearer(depth, pair):
    a, b = pair
    return b if depth[b[0]][b[1]] < depth[a[0]][a[1]] else a


def masks(depth, coc):
    """{name: {(y, x), ...}}."""
    places = [(y, x) for y in range(len(coc)) for x in range(len(coc[0]))]
    radius = {(y, x): abs(coc[y][x]) for y, x in places}
    edges = pairs(coc)
    found = {name: set() for name in ("in_focus", "in_front", "behind", "occlusion", "sharp", "continuous")}
    for p in places:
        value = coc[p[0]][p[1]]
        found["in_focus" if radius[p] <= 0.5 else "in_front" if value < 0 else "behind"].add(p)
        if any(math.dist(p, q) < radius[nearer(depth, pair)] - 0.5 for pair in edges for q in pair):
            found["occlusion"].add(p)
        front = [q for q in places if coc[q[0]][q[1]] < -0.5]
        if radius[p] <= 0.5 and all(math.dist(p, q) >= radius[q] + 1 for q in front):
            found["sharp"].add(p)
        wide = [
            math.dist(p, q) < 2 * max(map(radius.get, pair)) or math.dist(p, q) < 2 * radius[p]
            for pair in edges
            for q in pair
        ]
        if radius[p] > 0.5 and not any(wide):
            found["continuous"].add(p)
    return found


def mean(rgb):
    return sum(rgb) / 3.0


def noise(error, y, x):
    """Root mean square over 5 x 5 pixels, the picture mirrored at its borders."""
    height, width = len(error), len(error[0])
    total = 0.0
    for j in range(y - 2, y + 3):
        for i in range(x - 2, x + 3):
            v = -j - 1 if j < 0 else 2 * height - 1 - j if j >= height else j
            u = -i - 1 if i < 0 else 2 * width - 1 - i if i >= width else i
            total += mean(error[v][u]) ** 2
    return math.sqrt(total / 25.0)


def around(picture, y, x, half):
    """Means of the channels within a square."""
    rows = range(max(0, y - half), min(len(picture), y + half + 1))
    columns = range(max(0, x - half), min(len(picture[0]), x + half + 1))
    return [mean(picture[v][u]) for v in rows for u in columns]


def rmse(region, reference, image, error):
    if not region:
        return math.nan
    square = noisy = 0.0
    for y, x in region:
        for c in range(3):
            square += (image[y][x][c] - reference[y][x][c]) ** 2
            noisy += error[y][x][c] ** 2
    return math.sqrt(max(0.0, (square - noisy) / (3 * len(region))))


def artefacts(depth, coc, color, error, reference, image):
    """All metrics but those of lamps; lists of lists."""
    found = masks(depth, coc)
    out = {
        f"rmse_{name}": rmse(found[name], reference, image, error)
        for name in ("in_focus", "in_front", "behind", "occlusion")
    }
    leaks = []
    for y, x in sorted(found["sharp"]):
        allowed = around(reference, y, x, 1) + around(color, y, x, 1)
        value = mean(image[y][x])
        leak = value - max(allowed) if value > max(allowed) else min(0.0, value - min(allowed))
        leaks.append((leak, noise(error, y, x)))
    out["leakage"] = sum(leak for leak, _ in leaks) / len(leaks) if leaks else math.nan
    out["leakage_worst"] = max([0.0, *(abs(leak) - 4 * s for leak, s in leaks)]) if leaks else math.nan
    steps = []
    for pair in pairs(coc):
        y, x = nearer(depth, pair)
        if coc[y][x] < -0.5:
            (v, u), (t, s) = pair
            room = 4 * math.hypot(noise(error, v, u), noise(error, t, s))
            seen = abs(mean(image[v][u]) - mean(image[t][s]))
            steps.append(seen - abs(mean(reference[v][u]) - mean(reference[t][s])) - room)
    out["boundary_step"] = max([0.0, *steps]) if steps else math.nan
    squares = 0.0
    for y, x in found["continuous"]:
        half = 1
        while half < abs(coc[y][x]):
            half *= 2
        allowed, value = around(reference, y, x, half), mean(image[y][x])
        beyond = max(value - max(allowed), min(allowed) - value) - 4 * noise(error, y, x)
        squares += max(0.0, beyond) ** 2
    out["ringing"] = math.sqrt(squares / len(found["continuous"])) if found["continuous"] else math.nan
    return out


def moments(spot):
    """Energy, centroid, RMS radius and anisotropy of a list of lists of numbers, by the sums of the principal axes."""
    cells = [(x + 0.5, y + 0.5, light) for y, row in enumerate(spot) for x, light in enumerate(row)]
    energy = sum(light for _, _, light in cells)
    mx = sum(x * light for x, _, light in cells) / energy
    my = sum(y * light for _, y, light in cells) / energy
    spreads = []
    for k in range(3600):  # the variance along each of many directions
        c, s = math.cos(math.pi * k / 3600), math.sin(math.pi * k / 3600)
        spreads.append(sum(light * ((x - mx) * c + (y - my) * s) ** 2 for x, y, light in cells) / energy)
    long, short = max(spreads), min(spreads)
    return energy, mx, my, math.sqrt(long + short), (long - short) / (long + short)
