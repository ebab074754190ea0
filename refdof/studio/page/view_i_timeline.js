// The timeline: frames, keys of the selected point, play.

const LONGEST = 100000;  // frames
const FRAME_MS = 1000 / 24;

function timeline(studio) {
  const play = button(studio, "Play", () => studio.playOrPause(), {className: "play"});
  const range = make("input", {type: "range", step: "1", "aria-label": "Frame, slider"});
  const frame = make("input", {type: "number", step: "1", "aria-label": "Frame"});
  const first = make("input", {type: "number", step: "1"}), last = make("input", {type: "number", step: "1"});
  const track = make("div", {className: "track"});
  const key = button(studio, "Add key", toggleKey);
  const node = make("section", {className: "timeline", "aria-label": "Timeline"},
    make("div", {className: "tools"}, play, key, row("Frame", frame), row("from", first), row("to", last)),
    make("div", {className: "lane"}, track, range));
  let playing = false, limits = null, limitsOf = null, started = 0;

  studio.goTo = (wanted, moving = false) => {
    const kept = Math.min(limits[1], Math.max(limits[0], Math.round(wanted)));
    studio.change((state) => { state.frame = kept; }, moving);
  };

  studio.play = (on) => {
    if (!studio.state || on === playing) return;
    playing = on;
    if (on) step();
    else studio.change(() => {});
  };

  studio.playOrPause = () => studio.play(!playing);

  // The next frame: asked for when the coarse picture of the last one has come.
  function step() {
    if (!playing || !studio.online) return;
    started = performance.now();
    const next = studio.state.frame + 1;
    studio.goTo(next > limits[1] ? limits[0] : next, true);
  }

  studio.onPicture.push(({id}) => {
    if (!playing || id !== studio.state.id) return;
    studio.later("play", Math.max(0, FRAME_MS - (performance.now() - started)), step);
  });

  const keyedWords = (point) => Object.keys(KEYED).filter((word) => Array.isArray(point[word]));

  // A key of all three at this frame, or none of them.
  function toggleKey() {
    const index = studio.selected;
    studio.change((state) => {
      const point = state.points[index], words = Object.keys(KEYED);
      if (!point) return;
      const on = !words.some((word) => hasKey(point[word], state.frame));
      for (const word of words) point[word] = withKey(point[word], state.frame, on);
    });
  }
  studio.toggleKey = toggleKey;

  const whole = (text, otherwise) => (text.trim() !== "" && Number.isInteger(Number(text)) ? Number(text) : otherwise);
  studio.listen(range, "input", () => studio.goTo(Number(range.value), true));
  studio.listen(range, "change", () => studio.goTo(Number(range.value)));
  studio.listen(frame, "change", () => studio.goTo(whole(frame.value, studio.state.frame)));
  for (const [k, input] of [[0, first], [1, last]]) {
    studio.listen(input, "change", () => {
      limits[k] = Math.min(LONGEST, Math.max(-LONGEST, whole(input.value, limits[k])));
      if (limits[1] <= limits[0]) limits[1 - k] = limits[k] + (k ? -1 : 1);
      studio.refresh();
    });
  }

  function drawKeys(point) {
    const keys = point ? keyedWords(point).flatMap((word) => point[word].map(([at]) => [word, at])) : [];
    const inside = keys.filter(([, at]) => at >= limits[0] && at <= limits[1]);
    while (track.childElementCount > inside.length) track.lastChild.remove();
    while (track.childElementCount < inside.length) {
      const mark = button(studio, "", () => studio.goTo(Number(mark.dataset.frame)), {tabIndex: -1});
      track.append(mark);
    }
    inside.forEach(([word, at], k) => {
      const mark = track.children[k];
      Object.assign(mark.dataset, {word, frame: at});
      mark.title = `${KEYED[word]}: key at frame ${at}`;
      mark.setAttribute("aria-label", mark.title);
      mark.style.left = (100 * (at - limits[0])) / (limits[1] - limits[0]) + "%";
    });
  }

  studio.refreshers.push(() => {
    const {scene, state} = studio, point = studio.point();
    if (limitsOf !== scene.name) {
      limitsOf = scene.name;
      limits = scene.frames && scene.frames[1] > scene.frames[0] ? [...scene.frames] : [0, 48];
    }
    Object.assign(range, {min: String(limits[0]), max: String(limits[1])});
    range.value = String(state.frame);
    for (const [input, value] of [[frame, state.frame], [first, limits[0]], [last, limits[1]]]) {
      if (!hasFocus(input)) input.value = String(value);
    }
    play.textContent = playing ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(playing));
    const here = point !== null && Object.keys(KEYED).some((word) => hasKey(point[word], state.frame));
    key.textContent = here ? "Remove key" : "Add key";
    key.disabled = point === null;
    drawKeys(point);
  });
  return node;
}
