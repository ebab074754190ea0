"""Embree, called from compiled code: the library that embreex ships, loaded through ctypes.

The only file that knows Embree. `Tracer` owns a device and a scene; kernels get plain integers (addresses) and call
through `refdof._jit.call_address`. Embree decides in float32 *which* triangle a ray meets; kernels recompute depth
and barycentrics in float64 from that triangle.

Ray packets are rows of a float32 array (ROWS, LANES): Embree's RTCRayHit16, or its RTCRayHit8 on processors without
16 lanes, where Embree traces the rays of a wider packet one by one. The integer rows are the same memory seen as int32.
The width decides nothing but which triangle a ray meets that runs through an edge, within Embree's roundings.

References
----------
.. [1] Wald et al. (2014), Embree: A Kernel Framework for Efficient CPU Ray Tracing, SIGGRAPH.
"""

import ctypes
import importlib.util
import weakref
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from refdof._check import Float, Index
from refdof._jit import thread_count
from refdof.raster.rays.ray_filters import collect, hole_words, let_through
from refdof.raster.rays.surfaces import Surfaces

__all__ = [
    "LANES",
    "ROWS",
    "Collector",
    "Row",
    "Tracer",
    "new_collector",
    "new_packets",
    "new_query",
    "new_tracer",
]

ROWS = 22  # 12 of the ray, 10 of the hit


class Row:
    """Row numbers inside a packet."""

    ORG_X, ORG_Y, ORG_Z, TNEAR, DIR_X, DIR_Y, DIR_Z, TIME, TFAR, MASK, ID, FLAGS = range(12)
    NG_X, NG_Y, NG_Z, U, V, PRIM, GEOM, INST, INST_PRIM = range(12, 21)


_TRIANGLE, _VERTEX_BUFFER, _INDEX_BUFFER = 0, 1, 0
_FLOAT3, _UINT3 = 0x9003, 0x5003
_ROBUST = 4  # scene flag: no ray slips between triangles that share an edge
# Spatial splits, so that boxes of long thin triangles, such as fences, overlap less. With the flag for robustness
# Embree leaves them out, whatever the quality, unless the builder is named; boxes and triangles are robust still.
# At most twice as many references as triangles: 1.2 times, Embree's default, leave half of the gain.
_TREE = "tri_accel=bvh4.triangle4v,tri_builder=sah_fast_spatial,max_spatial_split_replications=2"
_COHERENT, _INVOKE_FILTER = 1 << 16, 1 << 1  # query flags
_VERSION_PROPERTY, _NATIVE_16_PROPERTY = 0, 34
_SUPPORTED_MAJOR = 4  # the layout of rays and hits above is that of Embree 4

_P = ctypes.c_void_p
_SIGNATURES = {
    "rtcNewDevice": (_P, [ctypes.c_char_p]),
    "rtcReleaseDevice": (None, [_P]),
    "rtcGetDeviceProperty": (ctypes.c_ssize_t, [_P, ctypes.c_int]),
    "rtcGetDeviceError": (ctypes.c_int, [_P]),
    "rtcNewScene": (_P, [_P]),
    "rtcReleaseScene": (None, [_P]),
    "rtcSetSceneFlags": (None, [_P, ctypes.c_int]),
    "rtcCommitScene": (None, [_P]),
    "rtcNewGeometry": (_P, [_P, ctypes.c_int]),
    "rtcReleaseGeometry": (None, [_P]),
    "rtcSetNewGeometryBuffer": (
        _P,
        [_P, ctypes.c_int, ctypes.c_uint, ctypes.c_int, ctypes.c_size_t, ctypes.c_size_t],
    ),
    "rtcCommitGeometry": (None, [_P]),
    "rtcAttachGeometry": (ctypes.c_uint, [_P, _P]),
}


class Collector(NamedTuple):
    """Memory in which one ray collects every triangle it meets.

    `context` int32 is Embree's query context: two words of Embree's, then room, the count of hits, and their ids.
    """

    ray: Float  # (24,) float32: RTCRayHit
    ray_integers: Index  # the same memory as int32
    context: Index
    arguments: Index
    room: int
    ray_address: int
    arguments_address: int


@dataclass(frozen=True, eq=False)
class Tracer:
    """Addresses that kernels need: the scene, and Embree's closest-hit functions for packets and single rays.

    holes: what `let_through` reads, None for an opaque scene; `surfaces` keeps that memory.
    """

    scene: int
    packet: int
    single: int
    holes: Index | None = None
    surfaces: Surfaces | None = None


def new_tracer(vertices: Float, faces: Index, surfaces: Surfaces | None = None) -> Tracer:
    """Build the acceleration structure over triangles.

    Parameters
    ----------
    vertices : (V, 3) float
        Near the origin and at moderate scale: Embree works in float32.
    faces : (F, 3) int
    surfaces : Surfaces, or None
        The same triangles, for packets that pass through their holes; None: there are none.
    """
    library = _library()
    device = library.rtcNewDevice(f"threads={thread_count()},{_TREE}".encode())
    version = library.rtcGetDeviceProperty(device, _VERSION_PROPERTY)
    if version // 10000 != _SUPPORTED_MAJOR:
        library.rtcReleaseDevice(device)
        raise RuntimeError(f"Embree {version} has another ray layout; install embreex 4")
    scene = library.rtcNewScene(device)
    library.rtcSetSceneFlags(scene, _ROBUST)
    if len(faces):
        geometry = library.rtcNewGeometry(device, _TRIANGLE)
        _fill(library, geometry, _VERTEX_BUFFER, _FLOAT3, np.ascontiguousarray(vertices, dtype=np.float32))
        _fill(library, geometry, _INDEX_BUFFER, _UINT3, np.ascontiguousarray(faces, dtype=np.uint32))
        library.rtcCommitGeometry(geometry)
        library.rtcAttachGeometry(scene, geometry)
        library.rtcReleaseGeometry(geometry)
    library.rtcCommitScene(scene)
    error = library.rtcGetDeviceError(device)
    if error:
        raise RuntimeError(f"Embree could not build the scene: error {error}")
    addresses = (_address(getattr(library, f"rtcIntersect{LANES}")), _address(library.rtcIntersect1))
    holes = None if surfaces is None or not len(surfaces.cutouts.material) else hole_words(surfaces)
    tracer = Tracer(scene, *addresses, holes, surfaces)
    weakref.finalize(tracer, _release, library, scene, device)
    return tracer


def new_packets(count: int) -> Float:
    """Working memory (count, ROWS, LANES) float32 for packets of rays, aligned as Embree wants it."""
    return _aligned(count * ROWS * LANES * 4).view(np.float32).reshape(count, ROWS, LANES)


def new_query(tracer: Tracer, coherent: bool) -> Index:
    """(32,) int32: valid lanes, room for 16, then RTCIntersectArguments, which ask for coherent traversal or not.

    Rays pass through the tracer's holes.
    """
    query = _aligned(128).view(np.int32)
    query[:16] = -1
    query[16] = _COHERENT if coherent else 0
    query[17] = -1  # every feature
    if tracer.holes is not None:
        query[16] |= _INVOKE_FILTER
        query[18:22] = np.array([tracer.holes.ctypes.data, let_through.address], dtype=np.int64).view(np.int32)
    return query


def _aligned(size: int) -> np.ndarray:
    """`size` zero bytes that start on a 64-byte boundary."""
    memory = np.zeros(size + 64, dtype=np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start : start + size]


def _library() -> ctypes.CDLL:
    found_at = importlib.util.find_spec("embreex")  # importing it would load all of trimesh
    if found_at is None or found_at.origin is None:
        raise ImportError("the package embreex is not installed")
    package = Path(found_at.origin).parent
    folders = [
        package.parent / "embreex.libs",
        package / ".dylibs",
        package.parent / "embreex.dylibs",
        package,
    ]
    found = [path for folder in folders for path in sorted(folder.glob("*embree4*")) if path.is_file()]
    if not found:
        raise RuntimeError("the embreex package holds no Embree library; reinstall embreex")
    library = ctypes.CDLL(str(found[0]))
    for name, (result, arguments) in _SIGNATURES.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library


def _lanes() -> int:
    """Rays of a packet that this processor traces together."""
    library = _library()
    device = library.rtcNewDevice(b"threads=1")
    native = library.rtcGetDeviceProperty(device, _NATIVE_16_PROPERTY)
    library.rtcReleaseDevice(device)
    return 16 if native else 8


def _fill(library: ctypes.CDLL, geometry: int, kind: int, layout: int, values: np.ndarray) -> None:
    address = library.rtcSetNewGeometryBuffer(geometry, kind, 0, layout, 12, len(values))
    ctypes.memmove(address, values.ctypes.data, values.nbytes)


def _address(function: object) -> int:
    return int(ctypes.cast(function, ctypes.c_void_p).value or 0)  # type: ignore[arg-type]


def _release(library: ctypes.CDLL, scene: int, device: int) -> None:
    library.rtcReleaseScene(scene)
    library.rtcReleaseDevice(device)


def new_collector(room: int) -> Collector:
    """Memory for one ray and up to `room` triangles along it; more are counted but not kept."""
    ray = _aligned(96).view(np.float32)
    context = _aligned(16 + 4 * room).view(np.int32)
    context[0] = context[1] = -1
    context[2] = room
    arguments = _aligned(32).view(np.int32)
    arguments[0] = _INVOKE_FILTER
    arguments[1] = -1
    arguments[2:4] = np.array([context.ctypes.data], dtype=np.int64).view(np.int32)
    arguments[4:6] = np.array([collect.address], dtype=np.int64).view(np.int32)
    return Collector(ray, ray.view(np.int32), context, arguments, room, ray.ctypes.data, arguments.ctypes.data)


LANES = _lanes()
