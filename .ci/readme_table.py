"""Put the first table that `refdof compare` wrote, and what its reference is worth, between the README's markers.

Usage: readme_table.py TABLE.md
"""

import sys
from pathlib import Path

START, END = "<!-- compare table -->", "<!-- end -->"

readme = Path(__file__).parent.parent / "README.md"
before, _, rest = readme.read_text(encoding="utf-8").partition(START)
_, _, after = rest.partition(END)
lines = Path(sys.argv[1]).read_text(encoding="utf-8").splitlines()
end = next(k for k, line in enumerate(lines) if line.startswith("Reference:"))
table, reference = "\n".join(line for line in lines[:end] if line.startswith("|")), lines[end]
readme.write_text(f"{before}{START}\n\n{table}\n\n{reference}\n{END}{after}", encoding="utf-8")
