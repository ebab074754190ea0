// Fields: one number for each pixel of what is shown. Maps of errors, the histogram and the row profile are made of them.

const OFFSET = 0.01;  // added to the reference's magnitude in a relative error: black does not divide by zero
const RANGES = {signed: 0.25, relative: 1, flip: 1};  // what a map ends at, without exposure
const scalars = light.length === 65536 ? light : lightOfFloat16();  // planes of one number are float16 in any page
const weights = [0.2126, 0.7152, 0.0722];  // of luminance
const fields = new Map();

const luminance = (codes, k) => weights[0] * light[codes[3 * k]] + weights[1] * light[codes[3 * k + 1]] + weights[2] * light[codes[3 * k + 2]];
const signedError = (value, reference) => value - reference;
const relativeError = (value, reference) => (value - reference) / (Math.abs(reference) + OFFSET);

// The mode in which an image is shown: what has no error is shown as it is.
function modeOf(index, mode) {
  const image = images[index];
  if (index === STANDARD || image.scalar || image.error) return "";
  return mode === "flip" && image.flip === undefined ? "" : mode;
}

// What is shown of an image: {index, mode, codes, values, reference}; `codes` only of pictures, `reference`, the values
// beside them in a profile, only of pictures that have one. The last few are kept.
async function fieldOf(index, wanted) {
  const mode = modeOf(index, wanted), key = index + mode;
  let found = fields.get(key);
  if (!found) {
    found = await newField(index, mode);
    fields.set(key, found);
    for (const old of fields.keys()) if (fields.size > 4) fields.delete(old);
  }
  return found;
}

async function newField(index, mode) {
  const image = images[index], count = width * height;
  const field = {index, mode, codes: null, reference: null, values: new Float64Array(count)};
  const {values} = field;
  if (image.scalar || mode === "flip") {
    const codes = await plane(image.scalar ? image.plane : image.flip), scale = image.scale ?? 1;
    for (let k = 0; k < count; k++) values[k] = scalars[codes[k]] * scale;
    return field;
  }
  const [codes, standard] = await Promise.all([plane(image.plane), plane(images[STANDARD].plane)]);
  if (mode === "") {
    field.codes = codes;
    for (let k = 0; k < count; k++) values[k] = luminance(codes, k);
    if (index !== STANDARD && !image.error) field.reference = (await fieldOf(STANDARD, "")).values;
    return field;
  }
  const error = mode === "signed" ? signedError : relativeError;
  for (let k = 0; k < count; k++) values[k] = error(luminance(codes, k), luminance(standard, k));
  return field;
}

// Smallest and largest finite number.
function extent(values, first = 0, last = values.length) {
  let low = Infinity, high = -Infinity;
  for (let k = first; k < last; k++) {
    const value = values[k];
    if (value < low && value !== -Infinity) low = value;
    if (value > high && value !== Infinity) high = value;
  }
  return low > high ? [0, 0] : [low, high];
}

// What black and white of a map stand for; exposure makes the range of an error smaller.
function rangeOf(field, stops) {
  const image = images[field.index];
  if (image.scalar) {
    const [low, high] = field.extent ??= extent(field.values);
    const most = Math.max(Math.abs(low), Math.abs(high));
    return image.signed ? [-most, most] : [low, high];
  }
  const most = RANGES[field.mode] * 2 ** -stops;
  return [field.mode === "flip" ? 0 : -most, most];
}

const isDiverging = (field) => Boolean(images[field.index].signed) || field.mode === "signed" || field.mode === "relative";

// What the numbers of a field are, in words.
function meaning(field) {
  const {name, unit} = images[field.index], standard = images[STANDARD].name;
  if (unit) return `${name} [${unit}]`;
  if (field.mode === "flip") return `FLIP of ${name}`;
  if (field.mode === "signed") return `${name} \u2212 ${standard}, luminance`;
  if (field.mode === "relative") return `(${name} \u2212 ${standard}) / (|${standard}| + ${OFFSET}), luminance`;
  return `${name}, luminance`;
}
