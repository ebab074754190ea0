"""Put the table that `refdof compare` wrote between the README's markers: readme_table.py TABLE.md."""

import sys
from pathlib import Path

START, END = "<!-- compare table -->", "<!-- end -->"

readme = Path(__file__).parent.parent / "README.md"
before, _, rest = readme.read_text(encoding="utf-8").partition(START)
_, _, after = rest.partition(END)
table = Path(sys.argv[1]).read_text(encoding="utf-8").strip()
readme.write_text(f"{before}{START}\n\n{table}\n\n{END}{after}", encoding="utf-8")
