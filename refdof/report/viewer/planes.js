// Planes: what is embedded, decoded when it is first asked for.

const about = JSON.parse(document.getElementById("about").textContent);
const {width, height, images, crops} = about;
const isFloat = about.encoding === "float16";
const STANDARD = 0;  // what methods stand beside: the reference, or the pinhole picture
const light = isFloat ? lightOfFloat16() : lightOfDisplay();
const waiting = [], ready = [];  // promises of planes, and planes, by number

// The linear value of each code: of float16 bits, or of a display level.
function lightOfFloat16() {
  return Float32Array.from({length: 65536}, (_, bits) => {
    const sign = bits >> 15 ? -1 : 1, exponent = (bits >> 10) & 31, fraction = bits & 1023;
    if (exponent === 31) return fraction ? NaN : sign * Infinity;
    return sign * (exponent === 0 ? fraction * 2 ** -24 : (1 + fraction / 1024) * 2 ** (exponent - 15));
  });
}

function lightOfDisplay() {
  return Float32Array.from({length: 256}, (_, level) => {
    const value = level / 255;
    return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  });
}

// A plane as an array of codes. Its text leaves the page, so that it is kept once only.
function plane(number) {
  waiting[number] ??= decode(document.getElementById("plane-" + number)).then((codes) => ready[number] = codes);
  return waiting[number];
}

async function decode(element) {
  const letters = atob(element.textContent), bytes = new Uint8Array(letters.length);
  for (let k = 0; k < bytes.length; k++) bytes[k] = letters.charCodeAt(k);
  const isPicture = element.dataset.kind === "png";
  element.remove();
  if (isPicture) {
    const bitmap = await createImageBitmap(new Blob([bytes], {type: "image/png"}));
    const context = new OffscreenCanvas(width, height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const rgba = context.getImageData(0, 0, width, height).data;
    const levels = new Uint16Array(3 * width * height);
    for (let k = 0, o = 0; o < rgba.length; o += 4) for (let c = 0; c < 3; c++) levels[k++] = rgba[o + c];
    return levels;
  }
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const halves = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = halves.length / 2, codes = new Uint16Array(count);
  for (let k = 0; k < count; k++) codes[k] = halves[k] | halves[count + k] << 8;
  return codes;
}
