// The panel of the focus points: a list of them, and what is set of the selected one.

const KEYED = {offset: "Offset", aperture: "Blur", weight: "Weight"};  // what may have keyframes

function pointsPanel(studio) {
  const list = make("div", {className: "points", role: "group", "aria-label": "Focus points"});
  const hint = make("p", {className: "hint"});
  const name = make("input", {type: "text", maxLength: 200});
  const keep = make("input", {type: "checkbox"});
  const falloff = slider(studio, "Falloff", () => linearScale(1, 8), (value, moving) => {
    if (value >= 1) edit((point) => { point.falloff = value; }, moving);
    else studio.refresh();
  }, {min: "1", max: "8"});
  falloff.node.classList.add("falloff");
  const rows = Object.entries(KEYED).map(([word, label]) => keyedRow(word, label));
  const editor = make("div", {className: "editor"}, row("Name", name), ...rows.map((one) => one.node), falloff.node,
    row("Keep", keep, make("small", {textContent: "counts when hidden or outside, too"})),
    button(studio, "Delete point", () => removePoint(studio), {className: "delete"}));

  function edit(act, moving = false) {
    const index = studio.selected;
    studio.change((state) => { if (state.points[index]) act(state.points[index], state.frame); }, moving);
  }

  function scaleOf(word) {
    if (word === "aperture") return linearScale(0, 1);
    if (word === "weight") return linearScale(0, 4);
    const reach = (studio.scene.diagonal || 2) / 2;
    return {  // finer about 0
      value: (share) => Math.sign(share - 0.5) * (2 * Math.abs(share - 0.5)) ** 2 * reach,
      share: (value) => 0.5 + 0.5 * Math.sign(value) * Math.sqrt(Math.min(1, Math.abs(value) / reach)),
    };
  }

  function keyedRow(word, label) {
    const key = button(studio, "\u25c7", () => edit((point, frame) => {
      point[word] = withKey(point[word], frame, !hasKey(point[word], frame));
    }), {className: "key"});
    const one = slider(studio, label, () => scaleOf(word), (value, moving) => {
      if (value === null) studio.refresh();
      else edit((point, frame) => { point[word] = withValue(point[word], frame, value); }, moving);
    });
    one.node.append(key);
    return {...one, word, label, key};
  }

  studio.listen(name, "change", () => edit((point) => { point.name = name.value; }));
  studio.listen(keep, "change", () => edit((point) => { point.keep = keep.checked; }));

  function drawList() {
    const {points} = studio.state;
    while (list.childElementCount > points.length) list.lastChild.remove();
    while (list.childElementCount < points.length) {
      const index = list.childElementCount;
      list.append(button(studio, "", () => { studio.selected = index; studio.refresh(); }));
    }
    points.forEach((point, k) => {
      list.children[k].textContent = point.name ? `${k + 1} ${point.name}` : `Point ${k + 1}`;
      list.children[k].setAttribute("aria-pressed", String(k === studio.selected));
    });
  }

  studio.refreshers.push(() => {
    const point = studio.point(), {frame, points, lens} = studio.state;
    drawList();
    editor.hidden = !point;
    hint.textContent = !points.length ? "Click on the picture to make something sharp; shift-click adds more points."
      : lens.kind === "thin" ? "Focused where you clicked. Offset, blur and weight count with a focal surface: shift-click adds a second point."
      : lens.kind === "file" ? "Focused where you clicked. Offset, blur and weight count with a focal surface or a plane: choose one as the lens."
        : "Click moves the selected point, shift-click adds one. Drag the markers.";
    if (!point) return;
    if (!hasFocus(name)) name.value = point.name;
    keep.checked = point.keep;
    falloff.set(point.falloff, {words: "2 to 4 works well"});
    for (const {word, label, key, set} of rows) {
      const keyed = Array.isArray(point[word]), here = hasKey(point[word], frame);
      const count = keyed ? point[word].length : 0;
      set(valueAt(point[word], frame), {words: keyed ? `${count} ${count === 1 ? "key" : "keys"}` : NOTES[word]});
      key.textContent = here ? "\u25c6" : "\u25c7";
      key.title = `${here ? "Remove" : "Set"} a key of ${label.toLowerCase()} at frame ${frame}`;
      key.setAttribute("aria-label", key.title);
      key.setAttribute("aria-pressed", String(here));
    }
  });
  return section("Focus points", list, hint, editor);
}

const NOTES = {offset: "0 is sharp", aperture: "of the lens radius", weight: "beside others"};
