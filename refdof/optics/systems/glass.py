"""Glass: the refractive index of a material at a wavelength.

Three forms: Sellmeier's equation, [1]; index and Abbe number at the d line; one index for all wavelengths.

References
----------
.. [1] Sellmeier (1871), Zur Erklaerung der abnormen Farbenfolge im Spectrum einiger Substanzen, Annalen der Physik 219.
.. [2] SCHOTT, Optical Glass Data Sheets: coefficients B1 .. C3 of each glass.
.. [3] Malitson (1965), Interspecimen Comparison of the Refractive Index of Fused Silica, JOSA 55(10).
.. [4] Malitson (1963), A Redetermination of Some Optical Properties of Calcium Fluoride, Applied Optics 2(11).
.. [5] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, section 4.
"""

import math
from dataclasses import dataclass
from typing import Any

from refdof._check import InputError, as_choice, as_number

__all__ = ["AIR", "GLASSES", "LINE_C", "LINE_D", "LINE_F", "Glass", "glass_of"]

LINE_C, LINE_D, LINE_F = 0.6562725, 0.5875618, 0.4861327  # Fraunhofer's lines [um]
_SHORTEST, _LONGEST = 0.3, 2.5  # [um]: where makers measure
_MOST = 10.0  # no transparent material has this index


@dataclass(frozen=True)
class Glass:
    """A transparent material: either `n_d` (with `v_d`) or Sellmeier's `b` and `c`.

    Parameters
    ----------
    name : str
        As its maker writes it.
    n_d : float or None
        Index at the d line (587.5618 nm), >= 1; None: Sellmeier's equation gives it.
    v_d : float
        Abbe number (n_d - 1) / (n_F - n_C), > 0; ``inf``, the default, is one index for all wavelengths.
        The index follows Cauchy, n = p + q / wavelength^2, and has n_d and n_F - n_C exactly.
    b, c : 0 to 6 floats each, as many of one as of the other
        Sellmeier's coefficients; `c` [um^2] are squares of resonance wavelengths, as SCHOTT prints them.
    source : str
        Where the numbers were published.

    Raises
    ------
    InputError
        If both forms or none are given, or a number is out of range.
    """

    name: str
    n_d: float | None = None
    v_d: float = math.inf
    b: tuple[float, ...] = ()
    c: tuple[float, ...] = ()
    source: str = ""

    def __post_init__(self) -> None:
        for word in ("name", "source"):
            if not isinstance(getattr(self, word), str):
                raise InputError(f"{word}: got {type(getattr(self, word)).__name__}; allowed is text")
        if self.n_d is not None:
            object.__setattr__(self, "n_d", as_number("n_d", self.n_d, minimum=1.0, maximum=_MOST))
        object.__setattr__(self, "v_d", as_number("v_d", self.v_d, above=0.0, finite=False))
        for word in ("b", "c"):
            object.__setattr__(self, word, _coefficients(word, getattr(self, word)))
        if len(self.b) != len(self.c):
            raise InputError(f"c: got {len(self.c)} numbers; allowed are as many as b has, {len(self.b)}")
        if (self.n_d is None) == (not self.b):
            raise InputError(f"n_d: got {self.n_d} with {len(self.b)} coefficients b; allowed is one of the two")
        if self.b and not math.isinf(self.v_d):
            raise InputError(f"v_d: got {self.v_d:g} with coefficients b; allowed is one of the two")

    def index(self, wavelength_um: float) -> float:
        """Refractive index at a vacuum wavelength [um] of 0.3 to 2.5.

        Raises
        ------
        InputError
            If the wavelength is out of range, or the material has no real index >= 1 there.
        """
        wavelength = as_number("wavelength_um", wavelength_um, minimum=_SHORTEST, maximum=_LONGEST)
        square = wavelength * wavelength
        if self.n_d is not None:
            slope = (self.n_d - 1.0) / self.v_d / (LINE_F**-2 - LINE_C**-2)
            index = self.n_d + slope * (1.0 / square - LINE_D**-2)
        else:
            excess = sum(
                b * square / (square - c) if square != c else -1.0 for b, c in zip(self.b, self.c, strict=True)
            )
            index = math.sqrt(max(1.0 + excess, 0.0))
        if not 1.0 <= index <= _MOST:
            raise InputError(f"wavelength_um: got {wavelength:g}; allowed is one at which {self.name} is transparent")
        return index

    def abbe_number(self) -> float:
        """V_d = (n_d - 1) / (n_F - n_C); ``inf`` without dispersion."""
        spread = self.index(LINE_F) - self.index(LINE_C)
        return (self.index(LINE_D) - 1.0) / spread if spread else math.inf


def _coefficients(name: str, value: Any) -> tuple[float, ...]:
    if not isinstance(value, list | tuple) or len(value) > 6:
        raise InputError(f"{name}: got {type(value).__name__}; allowed is a list of up to 6 numbers")
    return tuple(as_number(f"{name}[{k}]", number) for k, number in enumerate(value))


AIR = Glass("air", 1.0)

# B1, B2, B3, C1, C2, C3, [2].
_SCHOTT: dict[str, tuple[float, ...]] = {
    "N-BK7": (1.03961212, 0.231792344, 1.01046945, 0.00600069867, 0.0200179144, 103.560653),
    "N-K5": (1.08511833, 0.199562005, 0.930511663, 0.00661099503, 0.024110866, 111.982777),
    "N-BAK4": (1.28834642, 0.132817724, 0.945395373, 0.00779980626, 0.0315631177, 105.965875),
    "N-BAF10": (1.5851495, 0.143559385, 1.08521269, 0.00926681282, 0.0424489805, 105.613573),
    "N-SK2": (1.28189012, 0.257738258, 0.96818604, 0.0072719164, 0.0242823527, 110.377773),
    "N-SK16": (1.34317774, 0.241144399, 0.994317969, 0.00704687339, 0.0229005, 92.7508526),
    "N-SSK8": (1.44857867, 0.117965926, 1.06937528, 0.00869310149, 0.0421566593, 111.300666),
    "N-LAK9": (1.46231905, 0.344399589, 1.15508372, 0.00724270156, 0.0243353131, 85.4686868),
    "N-LAK22": (1.14229781, 0.535138441, 1.04088385, 0.00585778594, 0.0198546147, 100.834017),
    "N-FK51A": (0.971247817, 0.216901417, 0.904651666, 0.00472301995, 0.0153575612, 168.68133),
    "F2": (1.34533359, 0.209073176, 0.937357162, 0.00997743871, 0.0470450767, 111.886764),
    "N-F2": (1.39757037, 0.159201403, 1.2686543, 0.00995906143, 0.0546931752, 119.248346),
    "SF2": (1.40301821, 0.231767504, 0.939056586, 0.0105795466, 0.0493226978, 112.405955),
    "N-SF2": (1.47343127, 0.163681849, 1.36920899, 0.0109019098, 0.0585683687, 127.404933),
    "N-SF5": (1.52481889, 0.187085527, 1.42729015, 0.011254756, 0.0588995392, 129.141675),
    "N-SF6": (1.77931763, 0.338149866, 2.08734474, 0.0133714182, 0.0617533621, 174.01759),
    "N-SF10": (1.62153902, 0.256287842, 1.64447552, 0.0122241457, 0.0595736775, 147.468793),
    "N-SF11": (1.73759695, 0.313747346, 1.89878101, 0.013188707, 0.0623068142, 155.23629),
}
_OTHERS = [
    Glass(
        "fused silica",
        b=(0.6961663, 0.4079426, 0.8974794),
        c=(0.0684043**2, 0.1162414**2, 9.896161**2),
        source="Malitson 1965",  # [3]
    ),
    Glass(
        "calcium fluoride",
        b=(0.5675888, 0.4710914, 3.8484723),
        c=(0.050263605**2, 0.1003909**2, 34.649040**2),
        source="Malitson 1963",  # [4]
    ),
    # N-BK7, rounded as [5] prints it under the name BK47, a glass that does not exist.
    Glass("paper-BK7", b=(1.039, 0.232, 1.010), c=(0.006, 0.020, 103.6), source="Lee, Eisemann & Seidel 2010"),
]
_DATA_SHEET = "SCHOTT optical glass data sheet"
GLASSES: dict[str, Glass] = {
    "air": AIR,
    **{name: Glass(name, b=row[:3], c=row[3:], source=_DATA_SHEET) for name, row in _SCHOTT.items()},
    **{glass.name: glass for glass in _OTHERS},
}


def glass_of(name: str) -> Glass:
    """The glass of that name in `GLASSES`.

    Raises
    ------
    InputError
        If there is none; the nearest name is said.
    """
    return GLASSES[as_choice("glass", name, GLASSES)]
