// The keyboard on the picture, and the list of keys.

const HELP = [
  ["Arrows", "move the crosshair; with Shift orbit"],
  ["f, o, p", "what arrows and drags do: points, orbit, pan"],
  ["Enter", "make sharp what is under the crosshair"],
  ["Shift+Enter", "add a point there"],
  ["Delete", "remove the selected point"],
  ["n", "select the next point"],
  ["k", "add or remove a key at this frame"],
  ["[ and ]", "a frame back, a frame on"],
  ["Space", "play or pause"],
  ["+ and -", "nearer, farther"],
  ["0 to 5", "the picture, or what is drawn over it"],
  ["?", "this list"],
];
const MOUSE = [
  ["Click", "make sharp what is there"],
  ["Shift+click", "add a point"],
  ["Drag a marker", "move its point"],
  ["Right drag, Alt+drag", "orbit; two fingers do, too"],
  ["Middle drag, Shift+right drag", "pan"],
  ["Wheel, pinch", "nearer, farther"],
];
const ARROWS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
const STEP = 0.02;  // of the picture's height: what an arrow moves the crosshair by

function keyboard(studio, root) {
  const table = (rows) => make("dl", {}, ...rows.flatMap(([keys, text]) => [make("dt", {textContent: keys}), make("dd", {textContent: text})]));
  const help = make("dialog", {className: "help", "aria-label": "Keys and mouse"},
    button(studio, "Close", () => help.close()), make("h3", {textContent: "Keys on the picture"}), table(HELP),
    make("h3", {textContent: "Mouse"}), table(MOUSE));
  const open = () => { if (!help.open) help.showModal(); };
  root.append(help);

  function arrow([right, down], shift) {
    const mode = shift ? "orbit" : studio.mode;
    if (mode === "orbit") return studio.nudge((state) => { state.camera = orbit(state.camera, right * ANGLE, down * ANGLE); });
    if (mode === "pan") return studio.nudge((state) => { state.camera = pan(state.camera, right * SHIFT, -down * SHIFT); });
    const [width, height] = studio.state.size, step = Math.max(1, Math.round(height * STEP));
    const [x, y] = cross();
    studio.placeCross([Math.min(width - 1, Math.max(0, x + right * step)), Math.min(height - 1, Math.max(0, y + down * step))]);
  }

  function cross() {
    return studio.cross ?? studio.state.size.map((length) => Math.floor(length / 2));
  }

  function select(index) {
    studio.selected = index;
    studio.refresh();
  }

  function setMode(mode) {
    studio.mode = mode;
    studio.refresh();
  }

  // What a key does, or undefined.
  function actionOf(event) {
    const {key, shiftKey: shift} = event, {state, scene} = studio;
    if (key in ARROWS) return () => arrow(ARROWS[key], shift);
    if (/^[0-9]$/.test(key)) {
      const overlay = scene.overlays[Number(key)];
      return overlay && (() => studio.change((next) => { next.overlay = overlay; }));
    }
    return {
      Enter: () => { studio.placeCross(cross()); focusAt(studio, studio.cross, shift); },
      Delete: () => removePoint(studio),
      Backspace: () => removePoint(studio),
      n: () => select(state.points.length ? (studio.selected + 1) % state.points.length : 0),
      k: () => studio.toggleKey(),
      "[": () => studio.goTo(state.frame - 1),
      "]": () => studio.goTo(state.frame + 1),
      " ": () => studio.playOrPause(),
      "+": () => studio.zoomBy(NEARER), "=": () => studio.zoomBy(NEARER), "-": () => studio.zoomBy(1 / NEARER),
      f: () => setMode("focus"), o: () => setMode("orbit"), p: () => setMode("pan"),
      Escape: () => studio.hideCross(),
      "?": open,
    }[key];
  }

  studio.listen(studio.canvas, "keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !studio.state || !studio.scene) return;
    const act = actionOf(event);
    if (!act) return;
    event.preventDefault();
    event.stopPropagation();  // a notebook has keys of its own
    act();
  });
  studio.listen(studio.canvas, "focus", () => {
    if (studio.state && studio.canvas.matches(":focus-visible")) studio.placeCross(cross());
  });
  studio.listen(studio.canvas, "blur", () => studio.hideCross());
  return button(studio, "Keys", open, {"aria-label": "Keys and mouse"});
}
