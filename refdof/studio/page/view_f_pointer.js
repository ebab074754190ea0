// The mouse and fingers on the picture.

const SLACK_PX = 5;  // a press that moves less is a click
const TURN = Math.PI;  // radians around the target for a drag as long as the picture is high
const MODES = {focus: "Points", orbit: "Orbit", pan: "Pan"};

function pointing(studio) {
  const {stage, canvas} = studio, fingers = new Map();
  const follow = latestPick(studio), hover = latestPick(studio);
  let drag = null;  // {what, index, x, y, far, more}
  studio.mode = "focus";

  // What a press begins, by button, keys and place.
  function kindOf(event) {
    if (fingers.size > 1) return "pinch";
    if (event.button === 1 || studio.mode === "pan" || (event.button === 2 && event.shiftKey)) return "pan";
    if (event.button === 2 || event.altKey || studio.mode === "orbit") return "orbit";
    return event.target.closest(".marker") ? "marker" : "click";
  }

  studio.listen(stage, "pointerdown", (event) => {
    if (!studio.state) return;
    canvas.focus({preventScroll: true});
    studio.placeCross(studio.pixelOf(event) ?? studio.cross ?? [0, 0], false);
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    try { stage.setPointerCapture(event.pointerId); } catch { /* the pointer is gone already */ }
    const what = kindOf(event);
    drag = {what, x: event.clientX, y: event.clientY, far: false, more: event.shiftKey, turned: drag?.turned ?? false};
    if (what === "marker") {
      drag.index = studio.selected = Number(event.target.closest(".marker").dataset.point);
      studio.refresh();
    }
    event.preventDefault();
  });

  studio.listen(stage, "pointermove", (event) => {
    if (!studio.state) return;
    if (!drag) {
      studio.later("hover", 150, () => lookAt(event));
      return;
    }
    if (!fingers.has(event.pointerId)) return;
    const before = spread();
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (!drag.far && Math.hypot(event.clientX - drag.x, event.clientY - drag.y) < SLACK_PX && drag.what !== "pinch") return;
    drag.far = true;
    if (drag.what === "pinch") return pinched(before, spread());
    const height = canvas.clientHeight || 1;
    const right = (event.clientX - drag.x) / height, down = (event.clientY - drag.y) / height;
    if (drag.what === "orbit") turn(right * TURN, down * TURN);
    else if (drag.what === "pan") move((state) => { state.camera = pan(state.camera, -right, down); });
    else if (drag.what === "marker") {
      const pixel = studio.pixelOf(event), {index} = drag;
      if (pixel) follow(pixel, (answer) => placed(index, answer, true));
      return;
    } else return;
    Object.assign(drag, {x: event.clientX, y: event.clientY});
  });

  function ended(event) {
    fingers.delete(event.pointerId);
    if (!drag || !studio.state) return;
    const {what, far, index, more, turned: changed} = drag;
    drag = fingers.size ? {...drag, what: "pinch"} : null;
    if (drag) return;
    const pixel = studio.pixelOf(event);
    const cancelled = event.type === "pointercancel";
    if (what === "click" && !far && pixel && !cancelled) focusAt(studio, pixel, more);
    else if (what === "marker" && far && pixel && !cancelled) follow(pixel, (answer) => placed(index, answer, false));
    else if (changed || (what === "marker" && far)) studio.change(() => {});
  }
  studio.listen(stage, "pointerup", ended);
  studio.listen(stage, "pointercancel", ended);
  studio.listen(stage, "contextmenu", (event) => event.preventDefault());

  function placed(index, answer, moving) {
    studio.tell(answer);
    if (!studio.state.points[index]) return;
    if (answer.point) putPoint(studio, index, answer, {moving});
    else if (!moving) studio.change(() => {});
  }

  function move(edit) {
    drag.turned = true;
    studio.change(edit, true);
  }

  function turn(around, over) {
    move((state) => { state.camera = orbit(state.camera, around, over); });
  }

  // Middle and distance of two fingers.
  function spread() {
    const [a, b = a] = [...fingers.values()];
    return {x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2, apart: Math.hypot(a[0] - b[0], a[1] - b[1])};
  }

  function pinched(before, now) {
    if (fingers.size < 2) return;
    const height = canvas.clientHeight || 1;
    const factor = before.apart > 0 && now.apart > 0 ? before.apart / now.apart : 1;
    move((state) => {
      state.camera = zoom(orbit(state.camera, ((now.x - before.x) / height) * TURN, ((now.y - before.y) / height) * TURN), factor);
    });
  }

  studio.listen(stage, "wheel", (event) => {
    if (!studio.state || event.ctrlKey) return;
    event.preventDefault();
    const step = Math.max(-100, Math.min(100, event.deltaMode === 0 ? event.deltaY : event.deltaY * 33));
    studio.nudge((state) => { state.camera = zoom(state.camera, 2 ** (step / 500)); });
  }, {passive: false});

  // Depth and circle under the mouse, once it rests and Python has nothing else to do.
  function lookAt(event) {
    const pixel = studio.pixelOf(event);
    if (!pixel || drag || !studio.online || studio.state.moving) return;
    if (studio.shown.id !== studio.state.id || studio.shown.rank < RANKS.fine) return;
    hover(pixel, (answer) => studio.tell(answer));
  }
}
