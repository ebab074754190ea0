// The studio: what one view knows, what it asks for, and whom it tells of changes.

const PATIENCE_MS = 1500;  // after this long without a coarse picture, the next state is sent all the same
const SETTLED_MS = 250;  // after the last of many small moves, the fine picture is asked for
const RANKS = {coarse: 0, fine: 1, reference: 2};

function makeStudio(model) {
  const ending = new AbortController(), timers = new Map(), waiting = new Map();
  let asks = 0, newest = 0, sent = null, late = false;
  const studio = {
    model,
    scene: null,
    state: null,
    selected: 0,  // index of a point
    places: [],  // of the points in the picture: {x, y, weight, depth} or null
    shown: {id: -1, rank: -1},  // the picture on the canvas
    refreshers: [],  // called after every change
    onPicture: [],  // called with every picture that is shown
    online: true,
    ending: ending.signal,
    say() {}, complain() {},  // set by the picture's lines
  };

  studio.listen = (node, type, act, options = {}) => node.addEventListener(type, act, {...options, signal: ending.signal});

  // A timer by name: a new one replaces the old one.
  studio.later = (name, milliseconds, act) => {
    clearTimeout(timers.get(name));
    timers.set(name, setTimeout(() => { if (!ending.signal.aborted) act(); }, milliseconds));
  };

  studio.refresh = () => {
    if (!studio.state || !studio.scene) return;
    studio.selected = Math.max(0, Math.min(studio.selected, studio.state.points.length - 1));
    for (const refresh of studio.refreshers) refresh();
  };

  // Edit a copy of the state and ask for its pictures; `moving` asks for the coarse one alone.
  studio.change = (edit, moving = false) => {
    if (!studio.state) return;
    const state = structuredClone(studio.state);
    edit(state);
    newest = state.id = newest + 1;
    state.moving = moving;
    studio.state = state;
    studio.refresh();
    send();
  };

  // One of many small moves: the fine picture comes after the last.
  studio.nudge = (edit) => {
    studio.change(edit, true);
    studio.later("settle", SETTLED_MS, () => studio.change(() => {}));
  };

  // While the mouse moves, one state at a time is in the air.
  function send() {
    if (studio.state.moving && sent !== null) { late = true; return; }
    late = false;
    sent = studio.state.id;
    model.set("state", studio.state);
    model.save_changes();
    studio.later("patience", PATIENCE_MS, release);
  }

  function release() {
    sent = null;
    if (late) send();
  }

  studio.point = () => studio.state?.points[studio.selected] ?? null;

  // Send a message and wait for its answer: null after an error, which is said in words.
  studio.ask = (content, buffers) => new Promise((resolve) => {
    const ask = ++asks;
    waiting.set(ask, resolve);
    if (studio.online) model.send({...content, ask}, undefined, buffers);
    else answer(ask, null);
  });

  function answer(ask, value) {
    const resolve = waiting.get(ask);
    waiting.delete(ask);
    resolve?.(value);
  }

  function receive(content, buffers) {
    if (content.kind === "picture") {
      if (sent !== null && content.id >= sent) release();
      const rank = RANKS[content.step] ?? 0, {shown} = studio;
      if (content.id < shown.id || (content.id === shown.id && rank < shown.rank)) return;
      studio.shown = {id: content.id, rank};
      if (content.points) studio.places = content.points;
      for (const act of studio.onPicture) act(content, buffers);
    } else if (content.kind === "error") {
      if (content.ask === undefined && sent !== null && content.id >= sent) release();
      if (content.ask === undefined || waiting.has(content.ask)) studio.complain(content.text);
      answer(content.ask, null);
    } else if (content.kind === "progress") {
      studio.say(content.text, "progress");
    } else {
      answer(content.ask, content);
    }
  }

  // Take a state that Python, or another view of the same model, has set.
  function adopt() {
    const state = model.get("state");
    if (!state || state === studio.state) return;
    const first = studio.state === null;
    newest = Math.max(newest, state.id ?? 0);
    studio.state = state;
    studio.shown = {id: -1, rank: -1};
    studio.refresh();
    if (first && studio.scene) studio.change(() => {});
  }

  function adoptScene() {
    studio.scene = model.get("scene") ?? null;
    studio.refresh();
  }

  function adoptOnline() {
    studio.online = model.get("online") !== false;
    if (!studio.online) {
      sent = null;
      for (const ask of [...waiting.keys()]) answer(ask, null);
    }
    studio.say(null, "online");
  }

  studio.start = () => {
    model.on("msg:custom", receive);
    model.on("change:scene", adoptScene);
    model.on("change:state", adopt);
    model.on("change:online", adoptOnline);
    adoptScene();
    adopt();
  };

  studio.stop = () => {
    model.off("msg:custom", receive);
    model.off("change:scene", adoptScene);
    model.off("change:state", adopt);
    model.off("change:online", adoptOnline);
    ending.abort();
    for (const timer of timers.values()) clearTimeout(timer);
  };

  return studio;
}
