// Colours: a picture through exposure and sRGB, a map through a table of colours.

const LEVELS = 511;  // of a map; odd, so that zero is in the middle
const NAN_COLOR = rgba(255, 0, 255), INF_COLOR = rgba(0, 150, 170);
const MAGMA = ["000004", "1c1044", "4f127b", "812581", "b5367a", "e55064", "fb8761", "fec287", "fcfdbf"].map(rgbOf);
const sequential = tableOf(MAGMA);
const diverging = tableOf([[120, 230, 255], [30, 110, 230], [0, 0, 0], [230, 90, 20], [255, 225, 120]]);

// A colour as ImageData holds it, its four bytes in one number.
function rgba(red, green, blue) {
  return (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
}

function rgbOf(text) {
  return [0, 2, 4].map((k) => parseInt(text.slice(k, k + 2), 16));
}

// The colour at 0 .. 1 along anchors of equal distance.
function between(anchors, t) {
  const at = t * (anchors.length - 1), k = Math.min(Math.floor(at), anchors.length - 2);
  return anchors[k].map((low, c) => Math.round(low + (anchors[k + 1][c] - low) * (at - k)));
}

function tableOf(anchors) {
  return Uint32Array.from({length: LEVELS}, (_, k) => rgba(...between(anchors, k / (LEVELS - 1))));
}

// The display level of each code at an exposure.
function displayOfCode(stops) {
  const gain = 2 ** stops;
  return Uint8ClampedArray.from(light, (value) => {
    const v = Math.min(1, Math.max(0, value * gain));
    return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
  });
}

// Fill `pixels`, an ImageData of box.width x box.height, with this window of a field.
function paint(pixels, box, field, stops) {
  const target = new Uint32Array(pixels.data.buffer);
  if (field.codes) paintPicture(target, box, field, displayOfCode(stops));
  else paintMap(target, box, field, rangeOf(field, stops), isDiverging(field) ? diverging : sequential);
}

function paintPicture(target, box, {codes, values}, display) {
  for (let row = 0, o = 0; row < box.height; row++) {
    let k = (box.y + row) * width + box.x;
    for (let column = 0; column < box.width; column++, k++) {
      const value = values[k];
      if (Number.isFinite(value)) target[o++] = rgba(display[codes[3 * k]], display[codes[3 * k + 1]], display[codes[3 * k + 2]]);
      else target[o++] = value !== value ? NAN_COLOR : INF_COLOR;
    }
  }
}

function paintMap(target, box, {values}, [low, high], table) {
  const scale = high > low ? (LEVELS - 1) / (high - low) : 0;
  for (let row = 0, o = 0; row < box.height; row++) {
    let k = (box.y + row) * width + box.x;
    for (let column = 0; column < box.width; column++, k++) {
      const value = values[k];
      if (Number.isFinite(value)) target[o++] = table[Math.min(LEVELS - 1, Math.max(0, Math.round((value - low) * scale)))];
      else target[o++] = value !== value ? NAN_COLOR : INF_COLOR;
    }
  }
}

// The colours of a map as a CSS gradient.
function gradientOf(field) {
  const table = isDiverging(field) ? diverging : sequential, steps = 16;
  const colors = Array.from({length: steps + 1}, (_, k) => cssOf(table[Math.round(k / steps * (LEVELS - 1))]));
  return `linear-gradient(90deg, ${colors})`;
}

function cssOf(color) {
  return `rgb(${[color & 255, color >> 8 & 255, color >> 16 & 255]})`;
}
