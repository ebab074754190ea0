"""Naive twin of the trace: one ray in 50 decimal digits, the textbook's sphere and Snell's law, nothing shared.

The sphere is |o + t d - m|^2 = R^2 with centre m, both roots are found, and the one nearest to the vertex is taken.
Snell's law is applied to the part of the direction along the surface. Departures: none; it is slow.
"""

from decimal import Decimal, localcontext


def trace_one(system, origin, direction, wavelength_um, *, reverse=False):
    """(point, direction, passed) as floats, in the order of `refdof.optics.systems.trace.trace`."""
    with localcontext() as context:
        context.prec = 50
        point, way, passed = _through(system, origin, direction, wavelength_um, reverse)
        return [float(x) for x in point], [float(x) for x in way], passed


def _through(system, origin, direction, wavelength_um, reverse):
    point = [Decimal(float(x)) for x in origin]
    way = _unit([Decimal(float(x)) for x in direction])
    indices = [Decimal(float(n)) for n in system.indices(wavelength_um)]
    places, z = [], Decimal(0)
    for surface in system.surfaces:
        places.append(z)
        z += Decimal(surface.thickness)
    order = list(range(len(places)))
    for k in reversed(order) if reverse else order:
        surface = system.surfaces[k]
        before, behind = (indices[k + 1], indices[k]) if reverse else (indices[k], indices[k + 1])
        vertex = [Decimal(0), Decimal(0), places[k]]
        if abs(surface.radius) == float("inf"):
            if way[2] == 0:
                return point, way, False
            t = (places[k] - point[2]) / way[2]
            hit = _at(point, way, t)
            normal = [Decimal(0), Decimal(0), Decimal(1)]
        else:
            radius = Decimal(surface.radius)
            centre = [Decimal(0), Decimal(0), places[k] + radius]
            offset = [p - m for p, m in zip(point, centre, strict=True)]
            b = 2 * _dot(offset, way)
            c = _dot(offset, offset) - radius * radius
            discriminant = b * b - 4 * c
            if discriminant <= 0:
                return point, way, False
            hits = [_at(point, way, (-b + sign * discriminant.sqrt()) / 2) for sign in (-1, 1)]
            hit = min(hits, key=lambda h: _dot(_minus(h, vertex), _minus(h, vertex)))
            normal = _unit(_minus(hit, centre))
        point = hit
        if point[0] ** 2 + point[1] ** 2 > Decimal(surface.semi_diameter) ** 2:
            return point, way, False
        if _dot(normal, way) < 0:
            normal = [-x for x in normal]
        # n sin i = n' sin i' for the part of the direction that lies in the surface.
        cosine = _dot(normal, way)
        tangent = [(w - cosine * n) * before / behind for w, n in zip(way, normal, strict=True)]
        rest = 1 - _dot(tangent, tangent)
        if rest <= 0:
            return point, way, False
        way = [t + rest.sqrt() * n for t, n in zip(tangent, normal, strict=True)]
    return point, way, True


def _dot(a, b):
    return sum((x * y for x, y in zip(a, b, strict=True)), Decimal(0))


def _minus(a, b):
    return [x - y for x, y in zip(a, b, strict=True)]


def _at(point, way, t):
    return [p + t * w for p, w in zip(point, way, strict=True)]


def _unit(a):
    length = _dot(a, a).sqrt()
    return [x / length for x in a]
