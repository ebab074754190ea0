// Elements: all text goes in as text, so that no name of a file can be markup.

// An element with properties, attributes where there is no such property, and children.
function make(tag, properties = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in node) node[name] = value;
    else node.setAttribute(name, value);
  }
  node.append(...children);
  return node;
}

function button(studio, text, act, properties = {}) {
  const node = make("button", {type: "button", textContent: text, ...properties});
  studio.listen(node, "click", act);
  return node;
}

// A part of the panel, with a heading.
function section(title, ...children) {
  return make("section", {"aria-label": title}, make("h3", {textContent: title}), ...children);
}

// A label and its control on one line.
function row(label, ...controls) {
  controls[0].setAttribute("aria-label", label);  // the options of a select are no part of its name
  return make("label", {className: "row"}, make("span", {className: "name", textContent: label}), ...controls);
}

// Set the options of a select anew if they changed: [[value, text], ...], or {label, options} for a group of them.
function setOptions(select, options) {
  const signature = JSON.stringify(options);
  if (select.dataset.options === signature) return;
  select.dataset.options = signature;
  const one = ([value, text]) => make("option", {value, textContent: text});
  select.replaceChildren(...options.map((entry) =>
    Array.isArray(entry) ? one(entry) : make("optgroup", {label: entry.label}, ...entry.options.map(one))));
}

function choice(studio, label, chosen, properties = {}) {
  const select = make("select", properties);
  studio.listen(select, "change", () => chosen(select.value));
  return {node: row(label, select), select};
}

function hasFocus(node) {
  return node.getRootNode().activeElement === node;
}

// A slider and a number that say the same value. `scale()` has `value(share)` and `share(value)` for shares from 0 to 1;
// `chosen(value, moving)` is called as the value changes.
function slider(studio, label, scale, chosen, properties = {}) {
  const range = make("input", {type: "range", min: "0", max: "1000", step: "1", "aria-label": label + ", slider"});
  const number = make("input", {type: "number", step: "any", "aria-label": label, ...properties});
  const note = make("small");
  const node = make("div", {className: "row slider"}, make("span", {className: "name", textContent: label}), range, number, note);
  const slid = (moving) => chosen(scale().value(Number(range.value) / 1000), moving);
  studio.listen(range, "input", () => slid(true));
  studio.listen(range, "change", () => slid(false));
  studio.listen(number, "change", () => chosen(number.value === "" ? null : Number(number.value), false));
  const set = (value, {disabled = false, words = ""} = {}) => {
    range.disabled = number.disabled = disabled;
    range.value = String(Math.round(1000 * Math.min(1, Math.max(0, scale().share(value)))));
    range.setAttribute("aria-valuetext", value === null ? number.placeholder || "none" : short(value));
    if (!hasFocus(number)) number.value = value === null ? "" : short(value);
    note.textContent = words;
  };
  return {node, range, number, set};
}

function linearScale(low, high) {
  return {value: (share) => low + share * (high - low), share: (value) => (value - low) / (high - low)};
}

function logScale(low, high) {
  const ratio = Math.log(high / low);
  return {value: (share) => low * Math.exp(share * ratio), share: (value) => (value > 0 ? Math.log(value / low) / ratio : 0)};
}

// A number in four digits, as an input takes it.
function short(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(4))) : "";
}

function seconds(value) {
  return value >= 10 ? value.toFixed(0) + " s" : value >= 0.1 ? value.toFixed(1) + " s" : Math.round(value * 1000) + " ms";
}
