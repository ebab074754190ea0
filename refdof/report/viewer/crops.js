// Crops: windows of all pictures side by side, enlarged. They follow exposure and mode, and are drawn when they are seen.

const CROP_SIDE = 200;  // px on the screen, about
const galleries = [...document.querySelectorAll("#crops .gallery")];
const seen = new Set();
const cropped = images.map((image, index) => index).filter((index) => index === STANDARD || images[index].method);

galleries.forEach((gallery, number) => {
  const box = crops[number], zoom = Math.max(1, Math.floor(CROP_SIDE / box.width));
  for (const index of cropped) {
    const button = document.createElement("button"), canvas = document.createElement("canvas"), label = document.createElement("span");
    canvas.width = box.width;
    canvas.height = box.height;
    canvas.style.width = zoom * box.width + "px";
    canvas.style.aspectRatio = `${box.width} / ${box.height}`;
    label.textContent = images[index].name;
    button.append(canvas, label);
    button.addEventListener("click", () => {
      show(index);
      zoomTo(box);
      view.scrollIntoView({block: "center"});
      view.focus({preventScroll: true});
    });
    gallery.append(button);
  }
});

const watcher = new IntersectionObserver((entries) => {
  for (const {target, isIntersecting} of entries) if (isIntersecting) seen.add(target); else seen.delete(target);
  drawCrops();
});
for (const gallery of galleries) watcher.observe(gallery);

async function drawCrops() {
  for (const gallery of [...seen]) {
    const box = crops[galleries.indexOf(gallery)], looks = `${state.mode} ${state.stops}`;
    if (gallery.dataset.looks === looks) continue;
    gallery.dataset.looks = looks;
    for (const [k, canvas] of [...gallery.querySelectorAll("canvas")].entries()) {
      const field = await fieldOf(cropped[k], state.mode), pixels = new ImageData(box.width, box.height);
      if (gallery.dataset.looks !== looks) break;
      paint(pixels, box, field, state.stops);
      canvas.getContext("2d").putImageData(pixels, 0, 0);
      canvas.dataset.drawn = looks;
    }
  }
}
