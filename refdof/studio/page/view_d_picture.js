// The picture: the canvas, the markers on it, and the lines of words below.

const OFFLINE = "The server is gone. The picture stays, and your changes are kept; trying again every 2 seconds.";

function pictureView(studio) {
  const canvas = make("canvas", {
    tabIndex: 0, width: 4, height: 3, className: "picture", role: "application",
    "aria-label": "Picture. Enter makes sharp what is under the crosshair; question mark lists the keys.",
  });
  const crosshair = make("div", {className: "crosshair", hidden: true});
  const markers = make("div", {className: "markers"});
  const stage = make("div", {className: "stage"}, canvas, markers, crosshair);
  const status = make("p", {className: "status", role: "status"});
  const alert = make("p", {className: "alert", role: "alert"});
  const legend = make("p", {className: "legend", hidden: true});
  const readout = make("p", {className: "readout", textContent: "Point at the picture: depth and circle of confusion."});
  const node = make("div", {className: "view"}, stage, status, alert, legend, readout);
  const small = make("canvas");
  let progress = "", summary = "Waiting for the first picture.", faulty = -1;

  studio.canvas = canvas;
  studio.stage = stage;
  studio.cross = null;  // place of the crosshair in pixels of the picture

  studio.say = (text, what) => {
    if (what === "progress") progress = text ?? "";
    else if (what !== "online") summary = text;
    status.textContent = !studio.online ? OFFLINE : progress || summary;
    status.classList.toggle("busy", progress !== "" && studio.online);
    node.dataset.online = String(studio.online);
  };

  studio.complain = (text) => {
    alert.textContent = text;
    faulty = studio.state?.id ?? -1;
  };

  studio.tell = ({point, depth, coc_px: circle, pixel}) => {
    const words = [`x ${pixel[0]}, y ${pixel[1]}`];
    if (point === null && depth === null) words.push("background");
    if (depth !== null && depth !== undefined) words.push(`depth ${short(depth)}`);
    if (circle !== null && circle !== undefined) words.push(`circle of confusion ${short(Math.abs(circle))} px`);
    readout.textContent = words.join(" \u00b7 ");
  };

  studio.placeCross = (place, seen = true) => {
    studio.cross = place;
    crosshair.hidden = !seen;
    position(crosshair, place[0] + 0.5, place[1] + 0.5);
  };

  studio.hideCross = () => { crosshair.hidden = true; };

  // The pixel of the fine picture under the mouse, or null outside.
  studio.pixelOf = (event) => {
    const box = canvas.getBoundingClientRect(), [width, height] = studio.state.size;
    const x = Math.floor(((event.clientX - box.left) / box.width) * width);
    const y = Math.floor(((event.clientY - box.top) / box.height) * height);
    return x >= 0 && y >= 0 && x < width && y < height ? [x, y] : null;
  };

  function position(mark, x, y) {
    const [width, height] = studio.state.size;
    mark.style.left = (100 * x) / width + "%";
    mark.style.top = (100 * y) / height + "%";
  }

  function drawMarkers() {
    const {points, size} = studio.state;
    while (markers.childElementCount > points.length) markers.lastChild.remove();
    while (markers.childElementCount < points.length) {
      const mark = make("span", {className: "marker"});
      mark.dataset.point = markers.childElementCount;
      markers.append(mark);
    }
    points.forEach((point, k) => {
      const mark = markers.children[k], place = studio.places[k];
      const inside = place && place.x >= 0 && place.y >= 0 && place.x <= size[0] && place.y <= size[1];
      mark.hidden = !inside;
      mark.textContent = String(k + 1);
      mark.title = pointName(point, k);
      mark.classList.toggle("chosen", k === studio.selected);
      mark.classList.toggle("faint", inside && place.weight === 0);
      if (inside) position(mark, place.x, place.y);
    });
  }

  function drawPicture({width, height, step}, [buffer]) {
    const bytes = ArrayBuffer.isView(buffer)
      ? new Uint8ClampedArray(buffer.buffer, buffer.byteOffset, buffer.byteLength) : new Uint8ClampedArray(buffer);
    const [full, tall] = step === "coarse" ? studio.state.size : [width, height];
    Object.assign(small, {width, height});
    small.getContext("2d").putImageData(new ImageData(bytes, width, height), 0, 0);
    if (canvas.width !== full || canvas.height !== tall) Object.assign(canvas, {width: full, height: tall});
    const context = canvas.getContext("2d");
    context.imageSmoothingQuality = "high";
    context.drawImage(small, 0, 0, full, tall);
    stage.style.setProperty("--ratio", full / tall);
  }

  studio.onPicture.push((content, buffers) => {
    const {id, step, width, height, seconds: time} = content;
    if (buffers[0]?.byteLength !== 4 * width * height) {
      studio.complain(`picture: got ${buffers[0]?.byteLength ?? 0} bytes; allowed are ${4 * width * height}`);
      return;
    }
    drawPicture(content, buffers);
    Object.assign(node.dataset, {id, step});
    node.setAttribute("aria-busy", String(id !== studio.state.id || (step === "coarse" && !studio.state.moving)));
    if (id > faulty) alert.textContent = "";
    const words = [studio.state.method, `${width} \u00d7 ${height}`, seconds(time ?? 0)];
    if (step === "coarse") words.push(studio.state.moving ? "coarse" : "coarse, the fine one follows");
    if (step === "reference") words.push("error against a reference that still gets better");
    studio.say(words.join(" \u00b7 "));
    drawLegend(content);
    drawMarkers();
  });

  function drawLegend({overlay, legend: scale}) {
    legend.hidden = !scale;
    if (!scale) return;
    const low = make("span", {textContent: short(scale.low)});
    const high = make("span", {textContent: `${short(scale.high)} ${scale.unit ?? ""}`});
    const bar = make("span", {className: "bar"});
    if (scale.colors) bar.style.background = `linear-gradient(to right, ${scale.colors.join(", ")})`;
    else bar.textContent = "to";
    bar.classList.toggle("plain", !scale.colors);
    legend.replaceChildren(make("span", {textContent: (OVERLAYS[overlay] ?? overlay) + ":"}), low, bar, high);
  }

  studio.refreshers.push(() => {
    const [width, height] = studio.state.size;
    node.dataset.wanted = studio.state.id;
    node.setAttribute("aria-busy", String(studio.shown.id !== studio.state.id));
    stage.style.setProperty("--ratio", width / height);
    if (studio.cross) studio.placeCross([Math.min(studio.cross[0], width - 1), Math.min(studio.cross[1], height - 1)], !crosshair.hidden);
    drawMarkers();
  });
  studio.say(summary);
  return node;
}

function pointName(point, index) {
  return point.name || `Point ${index + 1}`;
}
