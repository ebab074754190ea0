// A click on a heading sorts its table; a second click turns the order around. What is no number goes last.
for (const heading of document.querySelectorAll("table.scores th[data-sort]")) {
  const button = document.createElement("button");
  button.append(...heading.childNodes);
  heading.append(button);
  button.addEventListener("click", () => {
    const table = heading.closest("table"), column = heading.cellIndex;
    const sign = heading.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    const key = (row) => {
      const text = row.cells[column].dataset.value ?? row.cells[column].textContent.trim();
      if (heading.dataset.sort === "text") return text;
      return text === "inf" ? Infinity : Number(text);
    };
    const compare = (a, b) => {
      const x = key(a), y = key(b);
      if (Number.isNaN(x) || Number.isNaN(y)) return Number.isNaN(x) - Number.isNaN(y);
      return (x < y ? -1 : x > y ? 1 : 0) * sign;
    };
    const rows = [...table.tBodies[0].rows].sort(compare);
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", sign < 0 ? "descending" : "ascending");
    table.tBodies[0].append(...rows);
  });
}
