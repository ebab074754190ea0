// Focus by pointing: what a click, a drag of a marker, or a key does to the points and the lens.

const PLAIN_POINT = {name: "", offset: 0, aperture: 1, weight: 1, falloff: 3, keep: false};
const NOTHING = "The background has no surface: nothing there can be made sharp.";

function ask(studio, pixel) {
  return studio.ask({kind: "pick", pixel, state: studio.state});
}

// Make sharp what is at a pixel: moves a point (the selected one), or makes the first; `more` adds one.
async function focusAt(studio, pixel, more = false) {
  const answer = await ask(studio, pixel);
  if (!answer) return;
  studio.tell({...answer, coc_px: null});  // that of the lens before the change
  const {points, lens: {kind}} = studio.state, fresh = more && points.length > 0;
  if (!answer.point) {
    if (kind !== "thin" && kind !== "file") studio.complain(NOTHING);
    else setFocus(studio, null, false);
    return;
  }
  studio.selected = fresh ? points.length : studio.selected;
  putPoint(studio, studio.selected, answer, {kind: fresh && kind === "thin" ? "surface" : kind});
}

// Put a point where a pick has found a surface; a lens with one distance is focused there.
function putPoint(studio, index, answer, {moving = false, kind = studio.state.lens.kind} = {}) {
  const [x, y] = answer.pixel;
  studio.places = studio.places.slice();
  studio.places[index] = {x: x + 0.5, y: y + 0.5, weight: 1, depth: answer.depth};
  studio.change((state) => {
    const {triangle, barycentrics} = answer.point;
    state.points[index] = {...PLAIN_POINT, ...(state.points[index] ?? answer.point), triangle, barycentrics};
    state.lens.kind = kind;
    if (kind === "thin" || kind === "file") state.lens.focus = answer.depth;
  }, moving);
}

// Set the distance in focus; a lone point of a lens with one distance is no longer where it was.
function setFocus(studio, distance, moving) {
  studio.change((state) => {
    state.lens.focus = distance;
    if (state.points.length === 1) state.points = [];
  }, moving);
}

function removePoint(studio) {
  if (!studio.point()) return;
  const index = studio.selected;
  studio.places = studio.places.filter((_, k) => k !== index);
  studio.change((state) => {
    state.points.splice(index, 1);
    if (!state.points.length && state.lens.kind !== "file") state.lens.kind = "thin";
  });
}

// Kinds that follow points need one: the middle of the picture, or what is below it.
async function setKind(studio, kind) {
  if (["distance", "plane", "surface"].includes(kind) && !studio.state.points.length) {
    const [width, height] = studio.state.size;
    for (const share of [0.5, 0.7, 0.9]) {
      const answer = await ask(studio, [Math.floor(width / 2), Math.floor(height * share)]);
      if (!answer) break;
      if (!answer.point) continue;
      studio.change((state) => {
        state.lens.kind = kind;
        state.points = [{...PLAIN_POINT, ...answer.point}];
      });
      return;
    }
    studio.complain("This lens follows points, and there is none: click on a surface first.");
    studio.refresh();
    return;
  }
  studio.change((state) => {
    state.lens.kind = kind;
    if (kind === "file") state.lens.file ??= studio.scene.lens_files[0] ?? null;
  });
}

// Picks while the mouse moves: one in the air, then the newest.
function latestPick(studio) {
  let wanted = null, busy = false;
  return async (pixel, act) => {
    wanted = {pixel, act};
    if (busy) return;
    busy = true;
    while (wanted) {
      const {pixel: place, act: then} = wanted;
      wanted = null;
      const answer = await ask(studio, place);
      if (answer && !studio.ending.aborted) then(answer);
    }
    busy = false;
  };
}
