// Bar: buttons, list, exposure and keys. Every key has a button or a field, too.

const bar = document.getElementById("images"), list = document.getElementById("list");
const exposure = document.getElementById("exposure"), help = document.getElementById("help");
const NEXT_MODE = {"": "signed", signed: "relative", relative: "", flip: "signed"};
const KEYS = {
  d: () => setMode(NEXT_MODE[state.mode]),
  f: () => setMode(state.mode === "flip" ? "" : "flip"),
  e: () => setStops(state.stops - 0.5),
  E: () => setStops(state.stops + 0.5),
  a: fit,
  "+": () => zoomAtCursor(2),
  "-": () => zoomAtCursor(0.5),
  "?": () => { if (help.open) help.close(); else help.showModal(); },
  ArrowRight: () => show((state.image + 1) % images.length),
  ArrowLeft: () => show((state.image + images.length - 1) % images.length),
};
const STEPS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};  // of the cursor, with Shift

images.forEach((image, index) => {
  const button = document.createElement("button"), cap = document.createElement("kbd");
  if (image.key) {
    cap.textContent = image.key;
    button.append(cap);
    KEYS[image.key] = () => show(index);
  }
  button.append(image.name);
  button.addEventListener("click", () => show(index));
  bar.append(button);
  list.append(new Option(image.name, index));
});

function show(index) {
  state.image = index;
  refresh();
}

function setMode(mode) {
  state.mode = mode;
  refresh();
}

function setStops(stops) {
  state.stops = Math.min(10, Math.max(-10, stops));
  refresh();
}

function drawBar() {
  [...bar.children].forEach((button, index) => button.setAttribute("aria-pressed", index === state.image));
  list.value = state.image;
  exposure.value = state.stops;
  document.getElementById("stops").textContent = (state.stops > 0 ? "+" : "") + state.stops + " stops";
  for (const button of document.querySelectorAll("[data-key]")) {
    const on = {d: state.mode === "signed" || state.mode === "relative", f: state.mode === "flip"}[button.dataset.key];
    if (on !== undefined) button.setAttribute("aria-pressed", on);
  }
}

// What a key does; fields keep the keys that they need.
function pressed(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const field = event.target.closest?.("input, select, textarea");
  if (field && (field.type !== "range" || event.key.startsWith("Arrow"))) return;
  const step = event.shiftKey && STEPS[event.key];
  const act = step ? () => setCursor(state.x + step[0], state.y + step[1]) : Object.hasOwn(KEYS, event.key) ? KEYS[event.key] : null;
  if (!act || (help.open && event.key !== "?")) return;
  event.preventDefault();
  act();
}

document.addEventListener("keydown", pressed);
list.addEventListener("change", () => show(Number(list.value)));
exposure.addEventListener("input", () => setStops(Number(exposure.value)));
for (const button of document.querySelectorAll("[data-key]")) button.addEventListener("click", () => KEYS[button.dataset.key]());
for (const button of document.querySelectorAll("table.scores button[data-row]")) {
  const index = images.findIndex((image) => image.method) + Number(button.dataset.row);
  button.addEventListener("click", () => {
    show(index);
    view.scrollIntoView({block: "center"});
  });
}
