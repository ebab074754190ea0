// The viewer: shows the image, mode and exposure of `state`.

let shown = null;  // the field on the stage

async function refresh() {
  const {image, mode} = state;
  drawBar();
  const field = await fieldOf(image, mode);
  if (state.image !== image || state.mode !== mode) return;
  shown = field;
  paint(pixels, {x: 0, y: 0, width, height}, shown, state.stops);
  picture.getContext("2d").putImageData(pixels, 0, 0);
  drawLegend();
  drawFacts();
  moved();
  setTimeout(() => { if (shown === field) drawHistogram(field); });
  drawCrops();
}

// After the cursor, the zoom or the place has changed.
function moved() {
  if (!shown) return;
  drawPicture();
  drawReadout();
  drawProfile(shown);
  drawHistogramCursor(shown);
}

// What is on the stage, and what its colours stand for.
function drawLegend() {
  const image = images[state.image], colors = document.getElementById("colors");
  const words = document.getElementById("legend-words");
  view.dataset.shown = `${state.image} ${state.mode} ${state.stops}`;
  view.setAttribute("aria-label", `${image.name}; ${meaning(shown)}`);
  colors.hidden = shown.codes !== null;
  if (shown.codes) {
    const none = state.mode && state.image !== STANDARD && !image.error && !image.scalar ? `; no ${ERROR_NAMES[state.mode]} of it` : "";
    words.textContent = `${image.name}, exposure ${state.stops > 0 ? "+" : ""}${state.stops} stops, sRGB${none}`;
    return;
  }
  const [low, high] = rangeOf(shown, state.stops);
  colors.style.background = gradientOf(shown);
  words.textContent = `${meaning(shown)}: ${plain(low)} to ${plain(high)}`;
}

// Parameters and command of the picture.
function drawFacts() {
  const {name, params = [], command = ""} = images[state.image];
  document.getElementById("facts-title").textContent = name;
  document.getElementById("facts").replaceChildren(...params.flatMap(([key, value]) => {
    const term = document.createElement("dt"), text = document.createElement("dd");
    term.textContent = key;
    text.textContent = value;
    return [term, text];
  }));
  const shownCommand = command || document.getElementById("command")?.textContent || "";
  document.getElementById("facts-command").textContent = shownCommand;
  document.getElementById("facts-how").hidden = !shownCommand;
}

document.getElementById("copy").addEventListener("click", async (event) => {
  const command = document.getElementById("facts-command"), button = event.currentTarget;
  getSelection().selectAllChildren(command);  // for Ctrl+C, where the clipboard is closed to pages
  try {
    await navigator.clipboard.writeText(command.textContent);
    button.textContent = "Copied";
  } catch {
    button.textContent = "Selected: press Ctrl+C";
  }
  setTimeout(() => { button.textContent = "Copy"; }, 2000);
});

resize();
refresh().catch((error) => {
  document.getElementById("legend-words").textContent = `The images cannot be decoded; a browser of 2023 or later is needed. ${error}`;
});
