// Read-out: the numbers of the cursor's pixel. It follows the mode of differences.

const readout = document.getElementById("readout");
const inputs = {x: document.getElementById("at-x"), y: document.getElementById("at-y")};
const ERROR_NAMES = {"": "|error|", signed: "signed error", relative: "relative error", flip: "FLIP"};
const ERRORS = {"": (value, reference) => Math.abs(value - reference), signed: signedError, relative: relativeError};

function drawReadout() {
  for (const axis of ["x", "y"]) if (document.activeElement !== inputs[axis]) inputs[axis].value = state[axis];
  const image = images[state.image], rows = [];
  const value = numbers(image), reference = numbers(images[STANDARD]);
  rows.push([image.name, value, image.unit]);
  if (state.image !== STANDARD && !image.scalar && !image.error) {
    rows.push([images[STANDARD].name, reference]);
    const mode = modeOf(state.image, state.mode), name = about.scored || mode === "flip" ? ERROR_NAMES[mode] : ERROR_NAMES[mode].replace("error", "difference");
    if (mode === "flip") rows.push([name, numbers({plane: image.flip, scalar: true})]);
    else rows.push([name, value && reference && value.map((one, c) => ERRORS[mode](one, reference[c]))]);
  }
  images.forEach((other, k) => {
    if (k !== state.image && (other.scalar || other.error)) rows.push([other.name, numbers(other), other.unit, other.empty]);
  });
  readout.replaceChildren(...rows.map(rowOf));
}

// The numbers of a plane at the cursor; null while it is not decoded, which it is from the first move on.
function numbers({plane: number, scalar, scale = 1}) {
  const codes = ready[number], k = state.y * width + state.x;
  if (codes) return scalar ? [scalars[codes[k]] * scale] : [0, 1, 2].map((c) => light[codes[3 * k + c]]);
  if (state.touched) plane(number).then(drawReadout);
  return null;
}

function rowOf([name, values, unit = "", empty = "inf"]) {
  const row = document.createElement("tr"), head = document.createElement("th");
  head.scope = "row";
  head.textContent = name;
  if (unit.length < 4) head.textContent += unit && ` [${unit}]`;
  row.append(head);
  row.dataset.name = name;
  for (const value of values ?? ["\u2026"]) {
    const cell = document.createElement("td");
    cell.textContent = value === Infinity ? empty : typeof value === "number" ? digits(value) : value;
    row.append(cell);
  }
  return row;
}

// Five digits: two float16 numbers never look alike.
function digits(value) {
  const size = Math.abs(value);
  if (!Number.isFinite(value) || Number.isInteger(value)) return String(value);
  return size < 1e-3 || size >= 1e5 ? value.toExponential(4) : value.toPrecision(5);
}

for (const axis of ["x", "y"]) {
  inputs[axis].max = (axis === "x" ? width : height) - 1;
  inputs[axis].addEventListener("change", () => {
    setCursor(Math.round(Number(inputs.x.value)) || 0, Math.round(Number(inputs.y.value)) || 0);
    inputs[axis].value = state[axis];
  });
}
