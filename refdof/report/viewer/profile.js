// Row profile: what is shown along the cursor's row, pixel by pixel, below the picture's own columns.

const profile = document.getElementById("profile");
const curves = {reference: profile.querySelector(".reference"), shown: profile.querySelector(".shown")};
let profiled = "";

// Steps in a drawing whose x is the pixel's column and whose y is the value; a gap where there is no finite number.
function stepsOf(values, first) {
  const parts = [];
  let open = false;
  for (let x = 0; x < width; x++) {
    const value = values[first + x];
    if (Number.isFinite(value)) parts.push(open ? `V${value}H${x + 1}` : `M${x} ${value}H${x + 1}`);
    open = Number.isFinite(value);
  }
  return parts.join("");
}

function drawProfile(field) {
  const start = state.y * width, name = `${field.index} ${field.mode} ${state.y}`;
  if (profiled !== name) {
    profiled = name;
    curves.shown.setAttribute("d", stepsOf(field.values, start));
    curves.reference.setAttribute("d", field.reference ? stepsOf(field.reference, start) : "");
  }
  // Place it: columns as on the stage, values between the least and the most in sight.
  const ratio = devicePixelRatio, tall = profile.clientHeight, edge = 20;
  const first = Math.min(width - 1, Math.max(0, Math.floor(-state.left / state.zoom)));
  const last = Math.max(first + 1, Math.min(width, Math.ceil((view.width - state.left) / state.zoom)));
  let [low, high] = extent(field.values, start + first, start + last);
  if (field.reference) {
    const [least, most] = extent(field.reference, start + first, start + last);
    [low, high] = [Math.min(low, least), Math.max(high, most)];
  }
  low = Math.min(low, 0);
  if (high <= low) high = low + 1;
  const scale = (tall - 2 * edge) / (high - low), zero = tall - edge + low * scale;
  const place = `matrix(${state.zoom / ratio} 0 0 ${-scale} ${state.left / ratio} ${zero})`;
  for (const curve of Object.values(curves)) curve.setAttribute("transform", place);
  const axis = profile.querySelector(".zero"), mark = profile.querySelector(".cursor");
  for (const end of ["y1", "y2"]) axis.setAttribute(end, zero);
  for (const end of ["x1", "x2"]) mark.setAttribute(end, (state.left + (state.x + 0.5) * state.zoom) / ratio);
  document.getElementById("profile-title").textContent = `row ${state.y}: ${meaning(field)}`;
  document.getElementById("profile-range").textContent = `${plain(low)} to ${plain(high)}`;
  document.getElementById("profile-reference").hidden = !field.reference;
}
