// Histogram of what is shown: counts on a logarithmic scale, and how many pixels are no finite number.

const BINS = 64;
const chart = document.getElementById("histogram");
let counted = null;

// {low, high, counts, nan, inf}: the last bin holds its upper end, too.
function histogramOf(values) {
  const [low, high] = extent(values), counts = new Array(BINS).fill(0), scale = high > low ? BINS / (high - low) : 0;
  let nan = 0, inf = 0, sum = 0;
  for (let k = 0; k < values.length; k++) {
    const value = values[k];
    if (value !== value) nan++;
    else if (value === Infinity || value === -Infinity) inf++;
    else {
      counts[Math.min(BINS - 1, Math.floor((value - low) * scale))]++;
      sum += value;
    }
  }
  return {low, high, counts, nan, inf, mean: sum / Math.max(1, values.length - nan - inf)};
}

function drawHistogram(field) {
  if (counted !== field) {
    counted = field;
    const {low, high, counts, nan, inf, mean} = field.histogram ??= histogramOf(field.values);
    const tallest = Math.log1p(Math.max(...counts, 1)), step = (high - low) / BINS;
    const bars = counts.map((count, k) => {
      const tall = 60 * Math.log1p(count) / tallest;
      const bar = inSvg("rect", {x: k, y: 60 - tall, width: 1, height: tall, "data-count": count});
      bar.append(inSvg("title"));
      bar.lastChild.textContent = `${plain(low + k * step)} to ${plain(low + (k + 1) * step)}: ${count} pixels`;
      return bar;
    });
    chart.querySelector("g").replaceChildren(...bars);
    document.getElementById("histogram-title").textContent = meaning(field);
    document.getElementById("histogram-low").textContent = plain(low);
    document.getElementById("histogram-mean").textContent = "mean " + plain(mean);
    document.getElementById("histogram-high").textContent = plain(high);
    document.getElementById("histogram-nan").textContent = nan;
    document.getElementById("histogram-inf").textContent = inf;
  }
  drawHistogramCursor(field);
}

// Where the cursor's pixel is.
function drawHistogramCursor(field) {
  if (counted !== field) return;
  const {low, high} = field.histogram, value = field.values[state.y * width + state.x];
  const mark = chart.querySelector("line"), at = high > low ? (value - low) / (high - low) * BINS : 0;
  mark.toggleAttribute("hidden", !Number.isFinite(value));
  if (Number.isFinite(value)) for (const end of ["x1", "x2"]) mark.setAttribute(end, at);
}

function inSvg(name, attributes = {}) {
  const element = document.createElementNS(chart.namespaceURI, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}

// A number in few digits.
function plain(value) {
  if (!Number.isFinite(value)) return String(value);
  return String(Number(value.toPrecision(4)));
}
