// The panel of files: open, drop, save, and the command line.

const MOST_BYTES = 256 * 2 ** 20;

function filesPanel(studio, root) {
  const name = make("input", {type: "text", value: "shot", maxLength: 200, spellcheck: false});
  const list = make("select", {"aria-label": "Scene, lens or focus file"});
  const chooser = make("input", {type: "file", "aria-label": "A mesh from this computer"});
  const command = make("textarea", {className: "command", readOnly: true, rows: 3, hidden: true, spellcheck: false, "aria-label": "Command line"});
  const done = make("p", {className: "hint", role: "status"});
  const opener = button(studio, "Open", open);
  let shownFor = null;

  async function open() {
    if (!list.value) return;
    await take(studio.ask({kind: "open", name: list.value}), "Opening " + list.value);
  }

  async function drop(file) {
    if (!file) return;
    if (file.size > MOST_BYTES) return studio.complain(`${file.name}: got ${file.size} bytes; allowed are ${MOST_BYTES}`);
    await take(studio.ask({kind: "drop", name: file.name}, [await file.arrayBuffer()]), "Sending " + file.name);
  }

  // Wait for a file to be opened, and ask for its picture.
  async function take(answer, words) {
    done.textContent = words + " ...";
    const opened = await answer;
    done.textContent = opened ? `Opened ${opened.name}.` : "";
    if (opened) studio.change(() => {});
  }

  function named(ending) {
    const given = name.value.trim() || "shot";
    return given.toLowerCase().endsWith(ending) ? given : given + ending;
  }

  async function save(what, ending) {
    const full = named(ending);
    const saved = await studio.ask({kind: "save", what, name: full, state: studio.state});
    done.textContent = saved ? `Saved ${saved.name}.` : "";
    if (saved && what === "focus") listed(saved.name);
    if (saved?.command) showCommand(saved.command);
  }

  // What was saved can be opened.
  function listed(saved) {
    const known = studio.scene.files?.focus ?? [];
    if (known.includes(saved)) return;
    studio.scene = {...studio.scene, files: {...studio.scene.files, focus: [...known, saved].sort()}};
    studio.refresh();
  }

  function showCommand(text) {
    command.hidden = false;
    command.value = text;
    shownFor = studio.state.id;
  }

  async function copy() {
    const file = named(".toml");
    const answer = await studio.ask({kind: "command", name: file, state: studio.state});
    if (!answer) return;
    showCommand(answer.text);
    const needs = / --(focus-)?points /.test(answer.text) ? ` It reads ${file}, which Save focus.toml writes.` : "";
    try {
      await navigator.clipboard.writeText(answer.text);
      done.textContent = "Copied." + needs;
    } catch {
      command.focus();
      command.select();
      done.textContent = "Selected: copy it with the browser's keys." + needs;
    }
  }

  const carriesFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes("Files");
  studio.listen(root, "dragover", (event) => {
    if (!carriesFiles(event)) return;
    event.preventDefault();
    root.classList.add("over");
  });
  studio.listen(root, "dragleave", (event) => { if (!root.contains(event.relatedTarget)) root.classList.remove("over"); });
  studio.listen(root, "drop", (event) => {
    if (!carriesFiles(event)) return;
    event.preventDefault();
    root.classList.remove("over");
    drop(event.dataTransfer.files[0]);
  });
  studio.listen(chooser, "change", async () => {
    await drop(chooser.files[0]);
    chooser.value = "";
  });

  studio.refreshers.push(() => {
    const none = "no files in the folder";
    const {scenes = [], lenses = [], focus = []} = studio.scene.files ?? {}, kept = list.value;
    const group = (label, names) => ({label, options: names.map((one) => [one, one])});
    const groups = [group("Built in", studio.scene.scenes ?? []), group("Scenes", scenes), group("Lenses", lenses), group("Focus points", focus)];
    const filled = groups.filter((one) => one.options.length);
    setOptions(list, filled.length ? filled : [["", none]]);
    if (kept) list.value = kept;
    if (list.selectedIndex < 0) list.selectedIndex = 0;
    opener.disabled = list.value === "";
    if (shownFor !== null && shownFor !== studio.state.id) command.hidden = true;
  });
  return section("Files",
    make("div", {className: "tools open"}, list, opener),
    row("Or drop a mesh here", chooser),
    row("Name", name),
    make("div", {className: "tools"}, button(studio, "Save focus.toml", () => save("focus", ".toml")),
      button(studio, "Save PNG", () => save("png", ".png")), button(studio, "Save EXR", () => save("exr", ".exr")),
      button(studio, "Copy command", copy)),
    command, done);
}
