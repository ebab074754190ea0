// Stage: where the picture lies on the screen, and which pixel is under the cursor. All images keep the same place.

const view = document.getElementById("view");
const picture = new OffscreenCanvas(width, height), pixels = new ImageData(width, height);
const state = {
  image: STANDARD, mode: "", stops: 0,
  zoom: 1, left: 0, top: 0, fitted: true,  // of the picture's top left corner, in device pixels
  x: width >> 1, y: height >> 1, touched: false,  // the cursor's pixel, and whether somebody has moved it
};
const pointers = new Map();  // that press on the stage

function drawPicture() {
  const context = view.getContext("2d");
  context.fillStyle = "#2b2d31";
  context.fillRect(0, 0, view.width, view.height);
  context.imageSmoothingEnabled = state.zoom < 1;
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, state.left, state.top, width * state.zoom, height * state.zoom);
  const side = Math.max(state.zoom, 8), line = devicePixelRatio;
  const x = state.left + (state.x + 0.5) * state.zoom, y = state.top + (state.y + 0.5) * state.zoom;
  for (const [color, grown] of [["#000", 2 * line], ["#fff", line]]) {
    context.strokeStyle = color;
    context.lineWidth = line;
    context.strokeRect(x - side / 2 - grown, y - side / 2 - grown, side + 2 * grown, side + 2 * grown);
  }
}

// Match the canvas to the window; the place that was zoomed to stays.
function resize() {
  view.width = Math.max(1, Math.round(view.clientWidth * devicePixelRatio));
  view.height = Math.max(1, Math.round(view.clientHeight * devicePixelRatio));
  if (state.fitted) fit(); else moved();
}

function fit() {
  state.fitted = true;
  state.zoom = Math.min(view.width / width, view.height / height);
  if (state.zoom > 1) state.zoom = Math.floor(state.zoom);
  state.left = Math.round((view.width - width * state.zoom) / 2);
  state.top = Math.round((view.height - height * state.zoom) / 2);
  moved();
}

// Zoom by a factor; the point (x, y) of the stage [device px] stays.
function zoomBy(factor, x, y) {
  const zoom = Math.min(256, Math.max(0.02, state.zoom * factor));
  state.left = x - (x - state.left) * zoom / state.zoom;
  state.top = y - (y - state.top) * zoom / state.zoom;
  state.zoom = zoom;
  state.fitted = false;
  moved();
}

function zoomAtCursor(factor) {
  zoomBy(factor, state.left + (state.x + 0.5) * state.zoom, state.top + (state.y + 0.5) * state.zoom);
}

// Show a window of the picture as large as it can be, with its middle under the cursor.
function zoomTo(box) {
  state.zoom = Math.min(256, view.width / box.width, view.height / box.height);
  if (state.zoom > 1) state.zoom = Math.floor(state.zoom);
  state.left = Math.round(view.width / 2 - (box.x + box.width / 2) * state.zoom);
  state.top = Math.round(view.height / 2 - (box.y + box.height / 2) * state.zoom);
  state.fitted = false;
  setCursor(box.x + (box.width >> 1), box.y + (box.height >> 1));
}

// Put the cursor on a pixel of the picture, and the pixel on the stage.
function setCursor(x, y) {
  state.x = Math.min(width - 1, Math.max(0, x));
  state.y = Math.min(height - 1, Math.max(0, y));
  state.touched = true;
  const shift = (at, size) => Math.min(0, size - at - state.zoom) || Math.max(0, -at);
  const dx = shift(state.left + state.x * state.zoom, view.width), dy = shift(state.top + state.y * state.zoom, view.height);
  state.left += dx;
  state.top += dy;
  if (dx || dy) state.fitted = false;
  moved();
}

function pixelAt(event) {
  const x = Math.floor((event.offsetX * devicePixelRatio - state.left) / state.zoom);
  const y = Math.floor((event.offsetY * devicePixelRatio - state.top) / state.zoom);
  return x >= 0 && x < width && y >= 0 && y < height ? {x, y} : null;
}

view.addEventListener("wheel", (event) => {
  if (event.deltaY === 0) return;
  event.preventDefault();
  zoomBy(2 ** (-event.deltaY / 300), event.offsetX * devicePixelRatio, event.offsetY * devicePixelRatio);
}, {passive: false});
view.addEventListener("pointerdown", (event) => {
  view.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, event);
  Object.assign(state, pixelAt(event) ?? {}, {touched: true});
  moved();
});
for (const end of ["pointerup", "pointercancel"]) view.addEventListener(end, (event) => pointers.delete(event.pointerId));
view.addEventListener("pointermove", (event) => {
  const before = pointers.get(event.pointerId);
  if (before) {
    state.left += (event.offsetX - before.offsetX) * devicePixelRatio / pointers.size;
    state.top += (event.offsetY - before.offsetY) * devicePixelRatio / pointers.size;
    state.fitted = false;
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
    pointers.set(event.pointerId, event);
    if (other) {  // two fingers zoom about the one that rests
      const far = (one) => Math.hypot(one.offsetX - other.offsetX, one.offsetY - other.offsetY) || 1;
      return zoomBy(far(event) / far(before), other.offsetX * devicePixelRatio, other.offsetY * devicePixelRatio);
    }
  }
  Object.assign(state, pixelAt(event) ?? {}, {touched: true});
  moved();
});
view.addEventListener("dblclick", fit);
addEventListener("resize", resize);
