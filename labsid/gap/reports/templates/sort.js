"use strict";
// A click on a column title sorts the table by it; a second click reverses the order. Empty values stay at the end.
const table = document.getElementById("records");
for (const [column, title] of [...table.tHead.rows[0].cells].entries()) {
  if (!title.dataset.first) continue;
  const button = document.createElement("button");
  button.append(...title.childNodes);
  title.append(button);
  button.addEventListener("click", () => {
    const first = title.dataset.first;
    const last = first === "ascending" ? "descending" : "ascending";
    const order = title.getAttribute("aria-sort") === first ? last : first;
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    title.setAttribute("aria-sort", order);
    const sign = order === "ascending" ? 1 : -1;
    const numeric = title.classList.contains("number");
    const value = (row) => row.cells[column].dataset.value;
    const compare = (a, b) => {
      if (value(a) === "" || value(b) === "") return (value(a) === "") - (value(b) === "");
      return sign * (numeric ? value(a) - value(b) : value(a).localeCompare(value(b), undefined, { numeric: true }));
    };
    table.tBodies[0].append(...[...table.tBodies[0].rows].sort(compare));
  });
}
