"""Write the matrix into docs/stability.md: run every case with every method, and replace what is between the markers.

Run it from the root of the repository after a change of a method: ``python benchmarks/stability.py``. Look at what
became degraded; `refdof/stability/degraded.py` says why each such cell is.
"""

import sys
from pathlib import Path

from refdof.stability import counts_of, markdown_section, matrix

PAGE = Path(__file__).resolve().parents[1] / "docs" / "stability.md"
BEGIN, END = "<!-- matrix -->\n", "<!-- /matrix -->"


def main() -> None:
    def tell(what: str, done: int, count: int) -> None:
        print(f"\r{done}/{count} {what[:40]:40}", end="", file=sys.stderr, flush=True)

    cells = matrix(tell=tell)
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    _, end, after = rest.partition(END)
    if not end:
        sys.exit(f"{PAGE}: has no markers {BEGIN.strip()} and {END}")
    PAGE.write_text(before + BEGIN + "\n" + markdown_section(cells) + "\n" + END + after, encoding="utf-8")
    print(f"\n{counts_of(cells)}", file=sys.stderr)


if __name__ == "__main__":
    main()
