// The panels of the view and of the lens.

const OVERLAYS = {
  none: "the picture", coc: "circle of confusion", focus: "what is in focus", depth: "depth", layers: "layers", error: "error",
};
const KINDS = {
  thin: "thin lens", plane: "tilt-shift plane", distance: "one distance", surface: "focal surface", file: "lens file",
};
const ANGLE = Math.PI / 24;  // radians that a button or an arrow key turns by
const SHIFT = 0.05;  // picture heights that they move by
const NEARER = 0.85;
const SIZES = [0.25, 0.5, 0.75, 1, 1.5, 2];

function viewPanel(studio) {
  const change = (edit) => studio.change(edit);
  const method = choice(studio, "Method", (value) => change((state) => { state.method = value; }));
  const size = choice(studio, "Size", (value) => change((state) => { state.size = value.split("x").map(Number); }));
  const overlay = choice(studio, "Show", (value) => change((state) => { state.overlay = value; }));
  const mode = choice(studio, "Drag and arrows", (value) => { studio.mode = value; studio.refresh(); });
  const tool = (text, label, act) => button(studio, text, act, {"aria-label": label, title: label});
  const tools = make("div", {className: "tools"},
    tool("+", "Nearer", () => studio.zoomBy(NEARER)), tool("\u2212", "Farther", () => studio.zoomBy(1 / NEARER)),
    button(studio, "Reset view", () => change((state) => { state.camera = structuredClone(studio.scene.camera); })));
  setOptions(mode.select, [["focus", "points and crosshair"], ["orbit", "orbit"], ["pan", "pan"]]);

  studio.zoomBy = (factor) => studio.nudge((state) => { state.camera = zoom(state.camera, factor); });
  studio.refreshers.push(() => {
    const {scene, state} = studio;
    setOptions(method.select, scene.methods.map(({name, kind}) => [name, kind ? `${name} (${kind})` : name]));
    const sizes = SIZES.map((scale) => scene.size.map((length) => Math.max(8, Math.round(length * scale))));
    if (!sizes.some((known) => String(known) === String(state.size))) sizes.push(state.size);
    sizes.sort((a, b) => a[0] - b[0]);
    setOptions(size.select, sizes.map(([width, height]) => [`${width}x${height}`, `${width} \u00d7 ${height}`]));
    setOptions(overlay.select, scene.overlays.map((name) => [name, OVERLAYS[name] ?? name]));
    method.select.value = state.method;
    size.select.value = state.size.join("x");
    overlay.select.value = state.overlay;
    mode.select.value = studio.mode;
    studio.stage.dataset.mode = studio.mode;
  });
  return section("Picture", method.node, size.node, overlay.node, mode.node, tools);
}

function lensPanel(studio) {
  const kind = choice(studio, "Lens", (value) => setKind(studio, value));
  const file = choice(studio, "File", (value) => studio.change((state) => { state.lens.file = value; state.lens.f_number = null; }));
  const stop = slider(studio, "f-number", stops, setStop, {min: "0"});
  const focus = slider(studio, "Focus", distances, chooseFocus, {min: "0", placeholder: "\u221e"});
  const length = slider(studio, "Focal length", lengths, (value, moving) => {
    if (value > 0) studio.change((state) => { state.lens.focal_length = value; }, moving);
    else studio.refresh();
  }, {min: "0"});
  const infinity = button(studio, "\u221e", () => setFocus(studio, null, false), {"aria-label": "Focus at infinity", title: "Focus at infinity"});
  focus.node.append(infinity);
  let widest = null;  // the f-number that the slider begins at, of the scene's own lens

  const isFile = () => studio.state.lens.kind === "file";
  const lengthOf = (lens) => lens.focal_length ?? 1;
  const numberOf = (lens) => lengthOf(lens) / (2 * lens.radius);

  function stops() {
    if (isFile()) return logScale(1, 32);
    const {lens} = studio.state;
    widest = numberOf({...lens, radius: studio.scene.lens.radius});
    return logScale(widest / 4, widest * 32);
  }

  function setStop(value, moving) {
    if (isFile()) studio.change((state) => { state.lens.f_number = value > 0 ? value : null; }, moving);
    else if (value > 0) studio.change((state) => { state.lens.radius = lengthOf(state.lens) / (2 * value); }, moving);
    else studio.refresh();
  }

  // Distances: logarithmic over the scene's depths, infinity at the slider's end.
  function distances() {
    const [near, far] = studio.scene.depths ?? [];
    const low = near > 0 ? near : studio.scene.diagonal / 100;
    const scale = logScale(low, far > low && Number.isFinite(far) ? far : Math.max(low * 10, studio.scene.diagonal));
    return {
      value: (share) => (share > 0.995 ? null : scale.value(share / 0.99)),
      share: (value) => (value === null ? 1 : Math.min(0.99, 0.99 * scale.share(value))),
    };
  }

  function chooseFocus(value, moving) {
    if (value === null || value > 0) setFocus(studio, value, moving);
    else studio.refresh();
  }

  function lengths() {
    const near = studio.scene.depths?.[0] ?? studio.scene.diagonal;
    return logScale(near / 1000, near * 0.9);
  }

  studio.refreshers.push(() => {
    const {scene, state: {lens}} = studio, followed = ["distance", "plane", "surface"].includes(lens.kind);
    setOptions(kind.select, Object.entries(KINDS).filter(([name]) => name !== "file" || scene.lens_files.length));
    kind.select.value = lens.kind;
    file.node.hidden = !isFile();
    const own = scene.files?.lenses ?? [];
    setOptions(file.select, [
      {label: "With refdof", options: scene.lens_files.map((name) => [name, name])},
      ...(own.length ? [{label: "In the folder", options: own.map((name) => [name, name])}] : []),
    ]);
    file.select.value = lens.file ?? "";
    stop.number.placeholder = isFile() ? "open" : "";
    stop.set(isFile() ? lens.f_number : numberOf(lens), {words: isFile() ? "empty: wide open" : `radius ${short(lens.radius)}`});
    focus.set(lens.focus, {disabled: followed, words: followed ? "set by the points" : "scene units"});
    infinity.hidden = followed;
    length.node.hidden = isFile();
    length.set(lens.focal_length ?? null, {words: "scene units"});
  });
  return section("Lens", kind.node, file.node, stop.node, focus.node, length.node);
}
