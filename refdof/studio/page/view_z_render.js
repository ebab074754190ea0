// The view: puts its parts together; what it returns takes them away.

function render({model, el}) {
  const studio = makeStudio(model);
  const root = make("div", {className: "refdof-studio"});
  root.dataset.lmSuppressShortcuts = "true";  // JupyterLab's keys are not meant here
  const title = make("h2"), facts = make("span", {className: "facts"});
  const view = pictureView(studio);
  pointing(studio);
  const panels = make("div", {className: "panels"}, viewPanel(studio), lensPanel(studio), pointsPanel(studio), filesPanel(studio, root));
  view.append(timeline(studio));
  const header = make("header", {}, title, facts, keyboard(studio, root));
  root.prepend(header, make("div", {className: "columns"}, view, panels));
  studio.refreshers.push(() => {
    title.textContent = studio.scene.name;
    facts.textContent = `lengths are ${studio.scene.unit ?? "scene units"}`;
  });
  el.append(root);
  studio.start();
  return () => {
    studio.stop();
    root.remove();
  };
}

export default {render};
