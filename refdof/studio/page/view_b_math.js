// Numbers: the camera's moves, and keyframes.

const add = (a, b, scale = 1) => a.map((value, k) => value + scale * b[k]);
const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const times = (a, scale) => a.map((value) => value * scale);
const unit = (a) => times(a, 1 / (Math.hypot(...a) || 1));

// Turn a vector about a unit axis: Rodrigues' formula.
function turned(vector, axis, angle) {
  const cosine = Math.cos(angle);
  const along = times(axis, dot(axis, vector) * (1 - cosine));
  return add(add(times(vector, cosine), cross(axis, vector), Math.sin(angle)), along);
}

const STEEPEST = 0.05;  // radians between the view and the upright, at least

// Turn the eye about the target: around the upright, and over it.
function orbit(camera, around, over) {
  const up = unit(camera.up);
  const offset = turned(add(camera.eye, camera.target, -1), up, -around);
  const right = unit(cross(up, offset));
  const steep = Math.acos(Math.min(1, Math.max(-1, dot(up, unit(offset)))));
  const wanted = Math.min(Math.PI - STEEPEST, Math.max(STEEPEST, steep - over));
  return {...camera, eye: add(camera.target, turned(offset, right, wanted - steep))};
}

// Move eye and target side by side, by shares of the picture's height at the target.
function pan(camera, right, up) {
  const offset = add(camera.eye, camera.target, -1);
  const height = 2 * Math.hypot(...offset) * Math.tan((camera.fov_y * Math.PI) / 360);
  const aside = unit(cross(camera.up, offset));
  const upright = unit(cross(offset, aside));
  const move = add(times(aside, right * height), upright, up * height);
  return {...camera, eye: add(camera.eye, move), target: add(camera.target, move)};
}

// Bring the eye nearer to the target: factor below 1.
function zoom(camera, factor) {
  return {...camera, eye: add(camera.target, add(camera.eye, camera.target, -1), factor)};
}

// The value of a number or of keyframes [[frame, value], ...] at a frame: the monotone cubic of Fritsch and Butland, flat
// at both ends, as Python has it.
function valueAt(given, frame) {
  if (!Array.isArray(given)) return given;
  const last = given.length - 1;
  if (frame <= given[0][0]) return given[0][1];
  if (frame >= given[last][0]) return given[last][1];
  const k = given.findIndex((key) => key[0] > frame) - 1;
  const width = (j) => given[j + 1][0] - given[j][0];
  const steep = (j) => (given[j + 1][1] - given[j][1]) / width(j);
  const slope = (j) => {
    if (j === 0 || j === last || steep(j - 1) * steep(j) <= 0) return 0;
    const before = 2 * width(j) + width(j - 1), behind = width(j) + 2 * width(j - 1);
    return (before + behind) / (before / steep(j - 1) + behind / steep(j));
  };
  const t = (frame - given[k][0]) / width(k), s = 1 - t;
  return s * s * (1 + 2 * t) * given[k][1] + t * t * (1 + 2 * s) * given[k + 1][1]
    + width(k) * t * s * (s * slope(k) - t * slope(k + 1));
}

function hasKey(given, frame) {
  return Array.isArray(given) && given.some((key) => key[0] === frame);
}

// With this value at a frame: a new keyframe among keyframes, else the number itself.
function withValue(given, frame, value) {
  if (!Array.isArray(given)) return value;
  return [...given.filter((key) => key[0] !== frame), [frame, value]].sort((a, b) => a[0] - b[0]);
}

// With a keyframe more or less; without any it is a number again.
function withKey(given, frame, on) {
  const value = valueAt(given, frame);
  if (on) return withValue(Array.isArray(given) ? given : [], frame, value);
  const rest = Array.isArray(given) ? given.filter((key) => key[0] !== frame) : [];
  return rest.length ? rest : value;
}
